"""What is told of a run: that it was begun, how each of its actions ended."""

from __future__ import annotations

from typing import Literal, NamedTuple

from kompass.rulebook.schema.status import LeafReading

EntryKind = Literal["firing", "shadow", "note", "near miss", "outranked"]


class ActionOutcome(NamedTuple):
    """How one action of a run ended.

    Attributes
    ----------
    action
        Its name in the journal.
    ok
        Whether it did what it should.
    text
        What it said.
    seconds
        How long it took.
    problem
        Why it failed, without the name of the action; empty when it did not.
    """

    action: str
    ok: bool
    text: str
    seconds: float
    problem: str = ""


class RunEntry(NamedTuple):
    """What goes into the journal of a firing, or of what came close to one.

    Attributes
    ----------
    kind
        As in :class:`kompass.rulebook.schema.journal.FiringRecord`.
    name, once
        Of the rule as it was then: the name, and whether it fires once only.
    revision
        Of the table that held it.
    run_id
        0 for what is no run.
    at
        Monotonic seconds.
    topic
        Whose message triggered it; None for no message.
    leaves
        What the leaves of its condition read then.
    """

    kind: EntryKind
    rule_id: str
    name: str
    once: bool
    revision: int
    run_id: int
    at: float
    rule_hash: str
    severity: str
    topic: str | None
    text: str
    leaves: tuple[LeafReading, ...]
