"""The base of every configuration model, and readable messages for what it refuses."""

import difflib
import logging
from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator

_told: set[str] = set()


def notice_once(text: str) -> None:
    """Log a warning, the same one once in the life of the process."""
    if text not in _told:
        _told.add(text)
        logging.getLogger("kompass.config").warning(text)


class Settings(BaseModel):
    """Fields are validated when set and when assigned; an unknown field is an error.

    What ``ignored_settings`` names is no field: older recipes and files may still give it a value,
    which is told once and has no effect. Rules are neither offered such a name nor may they set it.
    """

    # Names and why they have no effect here; those of the bases count too.
    ignored_settings: ClassVar[Mapping[str, str]] = {}

    model_config = ConfigDict(
        extra="forbid",
        validate_assignment=True,
        validate_default=False,
        arbitrary_types_allowed=True,
        populate_by_name=True,
    )

    def __setattr__(self, name: str, value: Any) -> None:
        why = ignored_of(type(self)).get(name)
        if why is None:
            super().__setattr__(name, value)
        else:
            _tell_ignored(type(self).__name__, name, why)

    @model_validator(mode="before")
    @classmethod
    def _drop_ignored(cls, given: Any) -> Any:
        return without_ignored(cls, given, cls.__name__) if isinstance(given, dict) else given


def ignored_of(model: type[BaseModel]) -> dict[str, str]:
    """The names that a model of settings ignores, with the reasons; those of its bases too.

    A subclass may make a field of a name that its base ignores.
    """
    ignored: dict[str, str] = {}
    for base in reversed(model.__mro__):
        ignored |= vars(base).get("ignored_settings", {})
    return {name: why for name, why in ignored.items() if name not in model.model_fields}


def without_ignored(model: type[BaseModel], given: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Values by name without those that have no effect; each of these is told once.

    Parameters
    ----------
    model
        The model that they are for.
    given
        By name; a nested section is a mapping.
    where
        Prefix of the messages, e.g. a file and a section.
    """
    ignored = ignored_of(model)
    kept = {}
    for name, value in given.items():
        section = section_of(model, name)
        if name in ignored:
            _tell_ignored(where, name, ignored[name])
        elif section is not None and isinstance(value, dict):
            kept[name] = without_ignored(section, value, f"{where}, {name}")
        else:
            kept[name] = value
    return kept


def _tell_ignored(where: str, name: str, why: str) -> None:
    notice_once(f"{where}: '{name}' is ignored: {why}")


def section_of(model: type[BaseModel], name: str) -> type[BaseModel] | None:
    """The model of a nested section; None when the field is no section, or there is no such."""
    field = model.model_fields.get(name)
    kind = field.annotation if field is not None else None
    return kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None


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
        section = section_of(model, str(part))
        if section is None:
            return []
        model = section
    return list(model.model_fields)
