"""The base of every configuration model, and readable messages for what it refuses."""

import difflib
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError


class Settings(BaseModel):
    """Fields are validated when set and when assigned; an unknown field is an error."""

    model_config = ConfigDict(
        extra="forbid",
        validate_assignment=True,
        validate_default=False,
        arbitrary_types_allowed=True,
        populate_by_name=True,
    )


def explain(error: ValidationError, model: type[BaseModel], where: str = "") -> str:
    """One line per refused field: where it is, its value, what is wrong, and the remedy.

    Parameters
    ----------
    error
        What pydantic raised.
    model
        The model that refused; its fields are offered for a mistyped key.
    where
        Prefix of each line, e.g. a file and a section.
    """
    return "\n".join(_explain_one(dict(item), model, where) for item in error.errors())


def _explain_one(item: dict[str, Any], model: type[BaseModel], where: str) -> str:
    path = ".".join(str(part) for part in item["loc"]) or model.__name__
    prefix = f"{where}: " if where else ""
    if item["type"] == "extra_forbidden":
        known = sorted(_fields_at(model, item["loc"][:-1]))
        close = difflib.get_close_matches(str(item["loc"][-1]), known, n=1)
        remedy = f"did you mean '{close[0]}'?" if close else f"known are: {', '.join(known)}"
        return f"{prefix}'{path}' is not a setting of {model.__name__}; {remedy}"
    return f"{prefix}'{path}' = {item['input']!r}: {item['msg']}"


def _fields_at(model: type[BaseModel], path: tuple[Any, ...]) -> list[str]:
    for part in path:
        field = model.model_fields.get(str(part))
        if field is None or not isinstance(field.annotation, type):
            return []
        if not issubclass(field.annotation, BaseModel):
            return []
        model = field.annotation
    return list(model.model_fields)
