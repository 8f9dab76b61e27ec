"""How the rules in force are doing, as the monitor publishes it."""

from typing import Literal

from kompass.rules.schema.model import Model

RuleState = Literal[
    "ready",
    "holding",
    "running",
    "cooling",
    "used up",
    "latched",
    "waiting",  # has fired, and waits for its condition to be false (or its clear to be true)
    "unknown",
    "disabled",
    "shadow",
    "broken",
]


class LeafReading(Model):
    """One leaf of a condition now, or when a rule fired.

    Attributes
    ----------
    path
        Child indices from the root of the condition.
    text
        The leaf as a person would write it.
    value, age, verdict
        As in :class:`kompass.rules.engine.firing.LeafVerdict`; ``verdict`` None is unknown.
    """

    path: tuple[int, ...]
    text: str
    value: bool | int | float | str | None
    age: float | None
    verdict: bool | None


class RuleStatus(Model):
    """One rule now.

    Attributes
    ----------
    state
        What the table of rules shows.
    text
        The state as a sentence: "cools down for 41 s more", "scan silent for 3 s".
    left
        Seconds until the state ends by itself; None if it takes something else.
    last_fired
        Seconds since the epoch.
    last_ok
        Whether the last run that ended went well; None when none has.
    """

    rule_id: str
    state: RuleState
    text: str
    left: float | None = None
    verdict: bool | None = None
    leaves: tuple[LeafReading, ...] = ()
    evaluated: int = 0
    true: int = 0
    fired: int = 0
    dropped: int = 0
    failed: int = 0
    outranked: int = 0
    last_fired: float | None = None
    last_ok: bool | None = None
    error: str = ""
