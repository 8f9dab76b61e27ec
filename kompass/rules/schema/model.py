"""The base of all rule data, and the scalar types it is made of."""

import math
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, JsonValue


class Model(BaseModel):
    """Immutable, refuses unknown fields and non-finite numbers, survives a JSON round-trip."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def topic_key(name: str) -> str:
    """Return the topic name without its leading slash: both spellings are one topic."""
    return name.removeprefix("/")


def _is_plain(key: str) -> bool:
    return key.isprintable() and " " not in key


def _topic(name: str) -> str:
    key = topic_key(name)
    if not key or any(part == "" for part in key.split("/")) or not _is_plain(key):
        raise ValueError(
            f"topic name {name!r} is not valid; give a name such as 'scan' or '/ns/scan'"
        )
    return key


def _finite(value: JsonValue) -> JsonValue:
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{value!r} cannot be written as JSON; give a finite number")
    if isinstance(value, dict):
        for item in value.values():
            _finite(item)
    elif isinstance(value, list):
        for item in value:
            _finite(item)
    return value


TopicName = Annotated[str, AfterValidator(_topic)]
TypeName = Annotated[
    str, Field(pattern=r"^\w+/(msg|srv|action)/\w+$", examples=["std_msgs/msg/Bool"])
]
Name = Annotated[str, Field(min_length=1, max_length=500)]
Seconds = Annotated[float, Field(ge=0.0)]
PositiveSeconds = Annotated[float, Field(gt=0.0)]
Scalar = bool | int | float | str
JsonObject = Annotated[dict[str, JsonValue], AfterValidator(_finite)]
