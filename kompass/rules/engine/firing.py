"""What goes into the engine and what comes out of it."""

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple, TypeAlias

from kompass.rules.schema.actions import Action
from kompass.rules.schema.conditions import TreePath
from kompass.rules.schema.table import Lane, Rule, Severity
from kompass.rules.schema.values import Verdict

NO_RUN = 0  # in the place of a run's number, for what no run of a rule does; they begin at 1


class Sample(NamedTuple):
    """A message was received."""

    topic: str
    message: Any


class Tick(NamedTuple):
    """Time has passed; nothing else happened."""


class RunEnded(NamedTuple):
    """The actions of a run have finished, well or not, or were cancelled."""

    rule_id: str
    run_id: int
    ok: bool = True
    error: str = ""


Input: TypeAlias = Sample | Tick | RunEnded


class LeafVerdict(NamedTuple):
    """One leaf of a condition at one moment.

    Attributes
    ----------
    path
        Child indices from the root of the condition to the leaf.
    text
        The leaf as a person would write it.
    value
        The value that was compared: a scalar, or a text that sums up anything larger; None if
        there is none. For ``absent`` the seconds of silence, for ``rate`` the rate in Hz.
    age
        Seconds since the topic's newest message; None if there was none.
    verdict
        True, False, or None for unknown.
    """

    path: TreePath
    text: str
    value: bool | int | float | str | None
    age: float | None
    verdict: Verdict


class Firing(NamedTuple):
    """A rule fires: the shell is to run its actions and to report ``RunEnded`` for ``run_id``.

    Attributes
    ----------
    at
        Monotonic seconds at which it fires.
    triggered_at
        When it was triggered; earlier than ``at`` if the run had to wait in the queue.
    revision_hash
        Hash of the rule that fired (:func:`kompass.rules.schema.table.rule_hash`).
    topic, message
        The message that triggered it, or the newest one when time alone did; None if none.
    messages
        Newest message of each topic in the condition and in the arguments, for ``resolve``.
    leaves
        Each leaf of the condition as it was when triggered.
    cancels
        Runs of the same rule to cancel first (mode ``restart``). One of them may have ended in the
        meantime: what was due before its ``RunEnded`` is handled before it.
    shadow
        Whether the rule is in shadow: nothing is to be done but to record it. The run has ended
        already, and no ``RunEnded`` is expected.
    rule
        With whose rights it acts; None for one that nobody knows.
    """

    rule_id: str
    run_id: int
    at: float
    triggered_at: float
    revision_hash: str
    topic: str | None
    message: Any
    messages: Mapping[str, Any]
    leaves: tuple[LeafVerdict, ...]
    actions: tuple[Action, ...]
    lane: Lane
    severity: Severity
    cancels: tuple[int, ...] = ()
    shadow: bool = False
    rule: Rule | None = None


class Note(NamedTuple):
    """Something that is no firing.

    Attributes
    ----------
    kind
        ``rate_latched``: the rule fired too often and stays off; an operator must hear of it.
        ``near_miss``: it came close to firing and did not; to be looked up when somebody asks why.
        At most one of a sort in :data:`kompass.rules.engine.near_miss.QUIET` seconds.
    leaves
        Each leaf of the condition at that moment, for a near miss.
    """

    kind: Literal["rate_latched", "near_miss"]
    rule_id: str
    at: float
    revision_hash: str
    severity: Severity
    text: str
    leaves: tuple[LeafVerdict, ...] = ()


Output: TypeAlias = Firing | Note
