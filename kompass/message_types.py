"""Names of the types of ROS messages, services and actions, and the classes that bear them."""

from __future__ import annotations

import importlib
from functools import lru_cache
from typing import Any

_PARTS = {
    f"_{part}": part for part in ("Request", "Response", "Goal", "Result", "Feedback", "Event")
}


def type_name(message: type[Any]) -> str:
    """``package/msg/Name`` of a message class (or srv, action)."""
    package, kind = message.__module__.split(".")[:2]
    return f"{package}/{kind}/{message.__name__}"


def ros_class(name: str) -> type[Any]:
    """The class of ``package/msg/Name`` (or srv, action).

    Raises
    ------
    ValueError
        When the package is not installed or has no such type.
    """
    package, kind, bare = name.split("/")
    try:
        return getattr(importlib.import_module(f"{package}.{kind}"), bare)  # type: ignore[no-any-return]
    except (ImportError, AttributeError):
        raise ValueError(f"there is no {name} here; install the package '{package}'") from None


@lru_cache(maxsize=2000)
def message_class(name: str) -> type[Any] | None:
    """The class of a message, request or goal (``…_Request``); None if it is not installed."""
    part = next((suffix for suffix in _PARTS if name.endswith(suffix)), "")
    try:
        found = ros_class(name.removesuffix(part))
    except ValueError:
        return None
    if part:
        found = getattr(found, _PARTS[part], type(None))
    return found if hasattr(found, "get_fields_and_field_types") else None
