"""What a recipe gives an action, as a rule holds it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from kompass.expressions import MessageField, reference_of
from kompass.rclpy_ext.messages import checked, to_plain


def as_data(value: Any) -> Any:
    """A value as JSON-ready data, to its innermost items.

    Fields of topics become references, and a text that only looks like a reference stays a text.

    Raises
    ------
    ValueError
        When a message has a value that its field cannot hold.
    """
    if isinstance(value, MessageField):
        return reference_of(value)
    if hasattr(value, "get_fields_and_field_types") and not isinstance(value, type):
        return as_data(to_plain(checked(value)))
    if isinstance(value, Mapping):
        return {key: as_data(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [as_data(item) for item in value]
    made = to_plain(value)
    return f"${made}" if isinstance(made, str) and made.startswith("$") else made


def refers(value: Any) -> bool:
    """Whether a field of a topic is among a value's items."""
    if isinstance(value, Mapping):
        return any(map(refers, value.values()))
    if isinstance(value, list | tuple):
        return any(map(refers, value))
    return isinstance(value, MessageField)
