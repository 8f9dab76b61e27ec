"""Arguments of actions, taken from messages.

``"$msg"`` is the triggering message, ``"$msg.point.x"`` and ``"$msg.poses[0].position"`` parts of
it; ``"$topic[/odom].pose.pose"`` is a part of the newest message of another topic. ``"$$"`` at the
start of a text stands for one dollar sign.
"""

import re
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import JsonValue

from kompass.rules.schema.model import topic_key

_REFERENCE = re.compile(
    r"\$(?:msg|topic\[(?P<topic>[^\]\s]+)\])(?P<path>(?:\.[A-Za-z_]\w*|\[\d+\])*)\Z"
)
_STEP = re.compile(r"\.(?P<name>[A-Za-z_]\w*)|\[(?P<index>\d+)\]")


class ArgumentError(ValueError):
    """An argument could not be taken from a message."""


def resolve(
    arguments: Mapping[str, JsonValue],
    message: Any,
    messages: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Return the arguments with every reference replaced by the value it refers to.

    Parameters
    ----------
    arguments
        As written in the rule; not changed.
    message
        The triggering message; None when time alone made the rule fire.
    messages
        Newest message by topic, without leading slash (:attr:`Firing.messages`).

    Raises
    ------
    ArgumentError
        If there is no such message or it has no such field; says which and what there is.
    """
    return {key: _resolve(value, message, messages or {}, key) for key, value in arguments.items()}


def expand(arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Return keys with dots as nested mappings: ``{"point.x": 1}`` is ``{"point": {"x": 1}}``.

    The mappings in lists are looked through, too.

    Raises
    ------
    ArgumentError
        If one key is set both as a whole and in parts.
    """
    nested: dict[str, Any] = {}
    for key, value in arguments.items():
        *parents, last = key.split(".")
        at = nested
        for part in parents:
            at = at.setdefault(part, {})
            if not isinstance(at, dict):
                raise ArgumentError(f"argument '{key}': '{part}' is already set; give it once")
        value = _expanded(value)
        if last in at:
            if not isinstance(at[last], dict) or not isinstance(value, dict):
                raise ArgumentError(f"argument '{key}' is already set; give it once")
            value = {**at[last], **value}
        at[last] = value
    return nested


def _expanded(value: Any) -> Any:
    if isinstance(value, dict):
        return expand(value)
    return [_expanded(item) for item in value] if isinstance(value, list) else value


def is_reference(value: JsonValue) -> bool:
    """Whether an argument as a whole is taken from a message."""
    return isinstance(value, str) and value.startswith("$") and not value.startswith("$$")


def is_exactly_reference(text: str) -> bool:
    """Whether a text is a reference that can be read; one that only starts like one is a text."""
    return _REFERENCE.match(text) is not None


def meant(value: JsonValue) -> JsonValue:
    """What an argument stands for that is no reference: of ``"$$5"`` the text ``"$5"``."""
    return value[1:] if isinstance(value, str) and value.startswith("$$") else value


def references(value: JsonValue) -> Iterator[tuple[str | None, tuple[str | int, ...]]]:
    """Walk the references in an argument: topic (None for the triggering message) and path.

    Raises
    ------
    ArgumentError
        If a text starts like a reference and is not one.
    """
    if isinstance(value, str) and value.startswith("$"):
        parsed = _parse(value)
        if parsed is not None:
            yield parsed
    elif isinstance(value, dict):
        for item in value.values():
            yield from references(item)
    elif isinstance(value, list):
        for item in value:
            yield from references(item)


def _parse(text: str) -> tuple[str | None, tuple[str | int, ...]] | None:
    if text.startswith("$$"):
        return None
    match = _REFERENCE.match(text)
    if match is None:
        raise ArgumentError(
            f"{text!r} is not a reference; write '$msg.field', '$topic[/name].field', "
            f"or '$${text[1:]}' for the text itself"
        )
    topic = match["topic"]
    path = tuple(step["name"] or int(step["index"]) for step in _STEP.finditer(match["path"]))
    return (None if topic is None else topic_key(topic)), path


def _resolve(value: JsonValue, message: Any, messages: Mapping[str, Any], where: str) -> Any:
    if isinstance(value, dict):
        return {k: _resolve(v, message, messages, f"{where}.{k}") for k, v in value.items()}
    if isinstance(value, list):
        return [_resolve(v, message, messages, f"{where}[{i}]") for i, v in enumerate(value)]
    if not isinstance(value, str):
        return value
    parsed = _parse(value) if value.startswith("$") else None
    if parsed is None:
        return meant(value)
    topic, path = parsed
    source = message if topic is None else messages.get(topic)
    if source is None:
        missing = "the firing has no message" if topic is None else f"/{topic} was never received"
        raise ArgumentError(f"argument '{where}' = {value!r}: {missing}")
    return _take(source, path, value, where)


def _take(source: Any, path: tuple[str | int, ...], text: str, where: str) -> Any:
    for step in path:
        try:
            source = source[step] if isinstance(step, int) else getattr(source, step)
        except (AttributeError, IndexError, KeyError, TypeError):
            raise ArgumentError(
                f"argument '{where}' = {text!r}: {_absence(source, step)}"
            ) from None
    return source


def _absence(source: Any, step: str | int) -> str:
    kind = type(source).__name__
    if isinstance(step, int):
        length = f" has {len(source)} items" if hasattr(source, "__len__") else " is no sequence"
        return f"no item [{step}]; {kind}{length}"
    getter = getattr(source, "get_fields_and_field_types", None)
    names = sorted(getter() if getter else getattr(source, "__dict__", ()))
    return f"{kind} has no field '{step}'; it has: {', '.join(names) or 'none'}"
