"""The event log: all inputs of the engine, in their order, so that they can be replayed exactly.

``now`` is the engine's own time, in monotonic seconds, as it was handed to it: a replay that is fed
the same inputs at the same times gives the same firings. Ticks are not logged, because they
change no firing and no time of one.
"""

import json
from collections.abc import Mapping
from typing import Any, NamedTuple, TypeAlias

from pydantic import JsonValue

from kompass.rulebook.schema.status import LeafReading
from kompass.rulebook.views.views import leaf_reading
from kompass.rules.engine.firing import Firing
from kompass.rules.schema.interned import table_text
from kompass.rules.schema.table import Table


class Began(NamedTuple):
    """The engine began a session, with an empty state.

    Attributes
    ----------
    wall
        Seconds since the epoch at ``now``.
    epoch
        Name of this session of the monitor, as in the journal.
    used
        Ids of ``once`` rules that had fired before, since the stack was started.
    recipe
        Tells recipes apart; empty where it is not known.
    """

    now: float
    wall: float
    epoch: str
    revision: int
    table: Table
    used: tuple[str, ...] = ()
    recipe: str = ""


class Resumed(NamedTuple):
    """The engine was running when this part of the log began; fields as of :class:`Began`.

    Of its state before, the log has only the table, the rules that are used up, and what tells
    whether a rule cools down or runs.

    Attributes
    ----------
    ended
        When the last run of each rule ended, by rule id.
    running
        When runs that had not ended began, by rule id and then by run id (as text).
    """

    now: float
    wall: float
    epoch: str
    revision: int
    table: Table
    used: tuple[str, ...] = ()
    recipe: str = ""
    ended: Mapping[str, float] = {}
    running: Mapping[str, Mapping[str, float]] = {}


class Heard(NamedTuple):
    """The engine received a message, or an answer of a polled function.

    Attributes
    ----------
    topic, type
        For an answer ``callable/<name>`` and an empty text.
    again
        Whether it was received before this part of the log began, and is valid still.
    """

    now: float
    topic: str
    type: str
    message: Any
    again: bool = False


class Ended(NamedTuple):
    """The actions of a run have ended."""

    now: float
    rule_id: str
    run_id: int
    ok: bool = True
    error: str = ""


class Fired(NamedTuple):
    """A rule fired; for comparison, a replay is not fed with it.

    ``now`` is the time at which the rule fired, which may lie before the input that made the
    engine notice.
    """

    now: float
    rule_id: str
    run_id: int
    triggered_at: float
    revision: int
    rule_hash: str
    topic: str | None = None
    shadow: bool = False
    leaves: tuple[LeafReading, ...] = ()


class Swapped(NamedTuple):
    """The engine changed to another table; what was due by then was handled by the old one."""

    now: float
    revision: int
    table: Table
    reset: tuple[str, ...] = ()


class Lost(NamedTuple):
    """The recorder lost some inputs before ``now``: a replay is not exact from here."""

    now: float
    number: int
    reason: str = ""


LoggedEvent: TypeAlias = Began | Resumed | Heard | Ended | Fired | Swapped | Lost
KINDS: dict[str, type[LoggedEvent]] = {
    "began": Began,
    "resumed": Resumed,
    "heard": Heard,
    "ended": Ended,
    "fired": Fired,
    "swapped": Swapped,
    "lost": Lost,
}


def fired_event(firing: Firing, revision: int) -> Fired:
    """Return a firing as an entry of the event log."""
    return Fired(
        now=firing.at,
        rule_id=firing.rule_id,
        run_id=firing.run_id,
        triggered_at=firing.triggered_at,
        revision=revision,
        rule_hash=firing.revision_hash,
        topic=firing.topic,
        shadow=firing.shadow,
        leaves=tuple(map(leaf_reading, firing.leaves)),
    )


def to_data(event: LoggedEvent) -> tuple[str, dict[str, JsonValue]]:
    """Return the kind of an event and the rest of it as JSON data.

    The message of a :class:`Heard` must itself be JSON data (an answer of a polled function):
    messages of ROS are recorded as they came.
    """
    kind = type(event).__name__.lower()
    return kind, {name: _plain(getattr(event, name)) for name in event._fields}


def swapped_text(event: Swapped) -> str:
    """Return a :class:`Swapped` as JSON text, as :func:`to_data` has it.

    It is written between two messages: of rules that were in the table before, the text is known.
    """
    rest = event._asdict() | {"reset": list(event.reset)}
    del rest["table"]
    return f'{{"table":{table_text(event.table)},{json.dumps(rest)[1:]}'


def from_data(kind: str, data: Mapping[str, Any]) -> LoggedEvent:
    """Make an event from what :func:`to_data` returned; fields of a later version are left out.

    Raises
    ------
    ValueError
        If there is no such kind, or a field is missing or malformed.
    """
    made = KINDS.get(kind)
    if made is None:
        raise ValueError(f"{kind!r} is no event of an event log; known are: {', '.join(KINDS)}")
    fields = {name: data[name] for name in made._fields if name in data}
    missing = [n for n in made._fields if n not in fields and n not in made._field_defaults]
    if missing:
        raise ValueError(f"an event {kind!r} lacks {', '.join(missing)}")
    if "table" in fields:
        fields["table"] = Table.model_validate(fields["table"])
    if "leaves" in fields:
        fields["leaves"] = tuple(LeafReading.model_validate(leaf) for leaf in fields["leaves"])
    for name in ("used", "reset"):
        if name in fields:
            fields[name] = tuple(fields[name])
    return made(**fields)


def _plain(value: Any) -> JsonValue:
    if isinstance(value, Table):
        return value.model_dump(mode="json")
    if isinstance(value, tuple):
        return [v.model_dump(mode="json") if isinstance(v, LeafReading) else v for v in value]
    return value  # type: ignore[no-any-return]
