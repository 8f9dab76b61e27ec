"""What messages are written under, and how events of the engine are written."""

from __future__ import annotations

import json
from typing import NamedTuple

from kompass.backtest.event_log import LoggedEvent, from_data, to_data
from kompass.recorder.mcap.definitions import definition

ENGINE_TOPIC = "/monitor/engine"
REPEAT = " repeat"
LATCHED = "latched"


class Stream(NamedTuple):
    """A channel, before a file has given it a number.

    Attributes
    ----------
    schema
        Name, encoding and text of the definition.
    source
        ``engine``: as the rules heard it · ``tap``: as the recorder heard it · either with
        `` repeat``: said before the file began, and valid still · ``events``: what the engine did.
    """

    topic: str
    encoding: str
    schema: tuple[str, str, bytes]
    source: str
    metadata: tuple[tuple[str, str], ...] = ()


_SCHEMA = {
    "title": "kompass.EngineEvent",
    "type": "object",
    "properties": {
        "kind": {"type": "string"},
        "now_ns": {"type": "integer"},
        "data": {"type": "object", "additionalProperties": True},
    },
    "required": ["kind", "now_ns", "data"],
}
EVENTS = Stream(
    ENGINE_TOPIC,
    "json",
    (_SCHEMA["title"], "jsonschema", json.dumps(_SCHEMA).encode()),  # type: ignore[arg-type]
    "events",
)


def message_stream(
    name: str, kind: str, source: str, rule_topic: str, *, latched: bool = False
) -> Stream:
    """The stream of a topic of ROS, with the definition of its messages.

    Parameters
    ----------
    name, rule_topic
        As it is called on the graph, and in the rules.
    latched
        Whether its last message stays valid until the next, however old.
    """
    text = definition(kind)
    schema = (kind, "ros2msg" if text else "", text.encode())
    metadata: tuple[tuple[str, str], ...] = (
        ("rule_topic", rule_topic),
        ("offered_qos_profiles", ""),
    )
    if latched:
        metadata += ((LATCHED, "1"),)
    return Stream(name, "cdr", schema, source, metadata)


class EngineEvent(NamedTuple):
    """An event, and the exact monotonic nanoseconds at which it was put down."""

    event: LoggedEvent
    now_ns: int


def event_json(event: LoggedEvent, now_ns: int) -> bytes:
    """An event as it stands in a recording."""
    kind, data = to_data(event)
    return json.dumps(
        {"kind": kind, "now_ns": now_ns, "data": data}, separators=(",", ":")
    ).encode()


def read_event(data: bytes) -> EngineEvent:
    """What :func:`event_json` has written.

    Raises
    ------
    ValueError
        When it is malformed, or of a kind that is not known.
    """
    found = json.loads(data)
    try:
        return EngineEvent(from_data(found["kind"], found["data"]), int(found["now_ns"]))
    except (KeyError, TypeError) as error:
        raise ValueError(f"a malformed event of the engine: {error!r}") from error
