"""What the engine says, as entries of the journal and of the tape."""

from typing import Literal

from pydantic import JsonValue

from kompass.backtest.event_log import Fired
from kompass.rulebook.schema.journal import FiringRecord
from kompass.rulebook.views.views import leaf_reading
from kompass.rules.engine.compiled_table import CompiledTable
from kompass.rules.engine.firing import Firing, Note

_KINDS: dict[str, Literal["near miss", "note"]] = {"near_miss": "near miss"}


def firing_record(
    firing: Firing,
    table: CompiledTable,
    *,
    number: int,
    epoch: str,
    revision: int,
    wall_offset: float,
    message: JsonValue = None,
) -> FiringRecord:
    """Return the entry of a firing at its start.

    Parameters
    ----------
    table
        The one that fired, or one that still has the rule; for its name.
    message
        The triggering message as data.
    wall_offset
        Seconds since the epoch minus monotonic seconds.
    """
    return FiringRecord(
        number=number,
        epoch=epoch,
        run_id=firing.run_id,
        rule_id=firing.rule_id,
        name=_name(table, firing.rule_id),
        kind="shadow" if firing.shadow else "firing",
        time=firing.at + wall_offset,
        revision=revision,
        rule_hash=firing.revision_hash,
        severity=firing.severity.name.lower(),
        topic=firing.topic,
        leaves=tuple(map(leaf_reading, firing.leaves)),
        ended=firing.at + wall_offset if firing.shadow else None,
        message=message,
    )


def note_record(
    note: Note,
    table: CompiledTable,
    *,
    number: int,
    epoch: str,
    revision: int,
    wall_offset: float,
) -> FiringRecord:
    """Return the entry of something that is no firing; the arguments as above."""
    return FiringRecord(
        number=number,
        epoch=epoch,
        run_id=0,
        rule_id=note.rule_id,
        name=_name(table, note.rule_id),
        kind=_KINDS.get(note.kind, "note"),
        time=note.at + wall_offset,
        revision=revision,
        rule_hash=note.revision_hash,
        severity=note.severity.name.lower(),
        text=note.text,
        leaves=tuple(map(leaf_reading, note.leaves)),
    )


def fired_event(firing: Firing, revision: int) -> Fired:
    """Return a firing as the tape keeps it."""
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


def _name(table: CompiledTable, rule_id: str) -> str:
    plan = table.by_id.get(rule_id)
    return "" if plan is None else plan.rule.name
