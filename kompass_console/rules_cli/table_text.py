"""Write a table as text for a person to edit; reading it gives the same table again."""

from __future__ import annotations

from typing import Any, Literal

import yaml
from pydantic import BaseModel

from kompass.rules.table import Table

Format = Literal["json", "yaml", "python"]


def as_text(table: Table, format_: Format) -> str:
    """A table as JSON, as YAML without what is as usual, or as a fragment of a recipe."""
    if format_ == "json":
        return table.model_dump_json(indent=2) + "\n"
    if format_ == "yaml":
        text: str = yaml.safe_dump(
            {"rules": [_told(rule) for rule in table.rules]}, sort_keys=False, allow_unicode=True
        )
        return text
    from kompass.recipe.export import to_python

    return to_python(table)


def _told(model: BaseModel) -> dict[str, Any]:
    """The fields of a model that differ from their defaults, and what kind it is."""
    dumped = model.model_dump(mode="json")
    told: dict[str, Any] = {"kind": dumped["kind"]} if "kind" in dumped else {}
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        if name != "kind" and value != field.get_default(call_default_factory=True):
            told[name] = _value(value, dumped[name])
    return told


def _value(value: Any, dumped: Any) -> Any:
    if isinstance(value, BaseModel):
        return _told(value)
    if isinstance(value, tuple) and any(isinstance(item, BaseModel) for item in value):
        return [_told(item) for item in value]
    return dumped
