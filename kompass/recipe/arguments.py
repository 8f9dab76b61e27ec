"""What a recipe gives an action, as a rule holds it."""

from __future__ import annotations

import json
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


def argument(name: str, key: str, value: Any) -> Any:
    """An argument of an action as data; a field of a topic in it stands for its newest value.

    Raises
    ------
    TypeError
        When it cannot be.
    ValueError
        When a number in it is not finite.
    """
    made = as_data(value)
    try:
        json.dumps(made, allow_nan=False)
    except ValueError:
        raise ValueError(
            f"Action: argument {key} = {value!r} of {name}: a number in it cannot be stored; "
            "give finite numbers"
        ) from None
    except TypeError:
        raise TypeError(
            f"Action: argument {key} = {value!r} of {name} cannot be stored as data; "
            "give numbers, texts, lists or mappings, or make it inside the function"
        ) from None
    return made


def message_data(name: str, value: Any) -> dict[str, Any]:
    """A message, or a mapping of its fields, as arguments of an action; nothing of None.

    Raises
    ------
    TypeError, ValueError
        When it cannot be data.
    """
    if value is None:
        return {}
    # Messages of rclpy are set to plain values and never to fields of topics: a mapping may be.
    is_message = hasattr(value, "get_fields_and_field_types") and not isinstance(value, type)
    data = to_plain(checked(value)) if is_message else value
    if not isinstance(data, Mapping):
        raise TypeError(f"{name}: {value!r} is neither a message nor a mapping of its fields")
    return {key: argument(name, key, each) for key, each in data.items()}
