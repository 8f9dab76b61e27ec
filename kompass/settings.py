"""The base of every configuration model, and readable messages for what it refuses."""

import difflib
import logging
from collections.abc import Mapping
from types import UnionType
from typing import TYPE_CHECKING, Any, ClassVar, Self, Union, get_args, get_origin

from pydantic import (
    AliasChoices,
    BaseModel,
    ConfigDict,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)
from pydantic_core import InitErrorDetails, PydanticCustomError

_OUT_OF_BOUNDS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")
# What the settings of other stacks are asked, and how these are.
_ASKED_HERE = {
    "asdict": "model_dump()",
    "to_dict": "model_dump()",
    "to_json": "model_dump_json()",
    "from_dict": "model_validate(values), which makes another",
    "from_json": "model_validate_json(text), which makes another",
    "from_file": "config_file= of the component or the launcher",
    "update_value": "an assignment, which is checked",
    "has_attribute": "hasattr()",
    "get_attribute_type": "model_fields[name].annotation",
    "get_fields_info": "model_fields, or model_json_schema()",
}

_told: set[str] = set()


def notice_once(text: str) -> None:
    """Log a warning, the same one once in the life of the process."""
    if text not in _told:
        _told.add(text)
        logging.getLogger("kompass.config").warning(text)


class Settings(BaseModel):
    """Fields are validated when set and when assigned; an unknown field is an error.

    An assignment that is refused, and a copy with an update that is, change nothing.

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
        allow_inf_nan=False,
    )

    def __setattr__(self, name: str, value: Any) -> None:
        kind = type(self)
        why = ignored_of(kind).get(name)
        if why is not None:
            _tell_ignored(kind.__name__, name, why)
            return
        if name not in kind.model_fields and not hasattr(kind, name) and not name.startswith("_"):
            raise ValueError(f"'{name}' {_unknown(kind, name)}")
        # A rule between fields is asked after the value was set, and pydantic leaves it there.
        before, told = dict(self.__dict__), set(self.__pydantic_fields_set__)
        try:
            super().__setattr__(name, value)
        except ValidationError:
            object.__setattr__(self, "__dict__", before)
            object.__setattr__(self, "__pydantic_fields_set__", told)
            raise

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name in _ASKED_HERE:
                raise AttributeError(
                    f"{type(self).__name__}.{name} is not here: use {_ASKED_HERE[name]}"
                )
            return super().__getattr__(name)

    @field_validator("*", mode="before")
    @classmethod
    def _truth_is_no_number(cls, value: Any, info: ValidationInfo) -> Any:
        # Python counts True as 1: nobody who writes it means a metre.
        if isinstance(value, bool) and info.field_name is not None:
            kinds = _kinds_of(cls.model_fields[info.field_name].annotation)
            if kinds & {int, float} and not kinds & {bool, Any, object}:
                raise PydanticCustomError("truth_for_number", "that is no number; give one")
        return value

    @model_validator(mode="before")
    @classmethod
    def _drop_ignored(cls, given: Any) -> Any:
        if not isinstance(given, dict):
            return given
        kept = without_ignored(cls, given, cls.__name__)
        known = _names_of(cls)
        unknown = [name for name in kept if name not in known]
        if unknown:
            raise ValidationError.from_exception_data(
                cls.__name__,
                [
                    InitErrorDetails(
                        type=PydanticCustomError(
                            "extra_forbidden", "{text}", {"text": _unknown(cls, str(name))}
                        ),
                        loc=(name,),
                        input=kept[name],
                    )
                    for name in unknown
                ],
            )
        return kept

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy, with some fields changed.

        Raises
        ------
        ValidationError
            When a changed field is refused.
        """
        copied = super().model_copy(deep=deep)
        return copied if not update else type(self).model_validate({**dict(copied), **update})


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


def _kinds_of(annotation: Any) -> set[Any]:
    """All types that an annotation names, whatever they are wrapped in."""
    inner = get_args(annotation)
    return {annotation} if not inner else {kind for one in inner for kind in _kinds_of(one)}


def _tell_ignored(where: str, name: str, why: str) -> None:
    notice_once(f"{where}: '{name}' is ignored: {why}")


def section_of(model: type[BaseModel], name: str) -> type[BaseModel] | None:
    """The model of a nested section; None when the field is no section, or there is no such."""
    field = model.model_fields.get(name)
    kind = field.annotation if field is not None else None
    kinds = get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)
    for one in kinds:
        if isinstance(one, type) and issubclass(one, BaseModel):
            return one
    return None


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
        return f"{prefix}'{path}' {item['msg']}"
    return f"{prefix}'{path}'{value_text(item['input'])}: {item['msg']}{_range(model, item)}"


def value_text(value: Any) -> str:
    """What follows a refused name: `` = <value>``, and of a whole section that it does not fit."""
    return " does not fit" if isinstance(value, (BaseModel, dict)) else f" = {value!r}"


def _range(model: type[BaseModel], item: dict[str, Any]) -> str:
    """Both bounds of a number that is beyond one of them."""
    if item["type"] not in _OUT_OF_BOUNDS:
        return ""
    *sections, name = item["loc"]
    for part in sections:
        section = section_of(model, str(part))
        if section is None:
            return ""
        model = section
    field = model.model_fields.get(str(name))
    bounds = [
        f"{sign} {getattr(rule, kind):g}"
        for rule in (field.metadata if field is not None else ())
        for kind, sign in (("gt", ">"), ("ge", "≥"), ("lt", "<"), ("le", "≤"))
        if hasattr(rule, kind)
    ]
    return f"; allowed is {' and '.join(bounds)}" if len(bounds) > 1 else ""


def _unknown(model: type[BaseModel], name: str) -> str:
    known = sorted(model.model_fields)
    close = difflib.get_close_matches(name, known, n=1)
    remedy = f"did you mean '{close[0]}'?" if close else f"known are: {', '.join(known)}"
    return f"is not a setting of {model.__name__}; {remedy}"


def _names_of(model: type[BaseModel]) -> set[Any]:
    """The names by which the fields of a model may be given."""
    names: set[Any] = set(model.model_fields)
    for field in model.model_fields.values():
        if isinstance(field.validation_alias, AliasChoices):
            names |= {one for one in field.validation_alias.choices if isinstance(one, str)}
    return names
