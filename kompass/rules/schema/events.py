"""When a rule fires: a condition, and how its truth over time becomes firings."""

from typing import Annotated, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from kompass.rules.schema.conditions import (
    Absent,
    AllOf,
    AnyOf,
    CallableCondition,
    Changed,
    Condition,
    Not,
    Rate,
    Received,
    children,
    leaves,
)
from kompass.rules.schema.model import Model, PositiveSeconds, Seconds

Count = Annotated[int, Field(ge=1, le=1000)]


class Single(Model):
    """While the actions run, further triggers are dropped and counted."""

    kind: Literal["single"] = "single"


class Queued(Model):
    """While the actions run, up to ``size`` triggers wait; more are dropped and counted."""

    kind: Literal["queued"] = "queued"
    size: Count = 10


class Restart(Model):
    """A trigger cancels the run in progress and starts a new one."""

    kind: Literal["restart"] = "restart"


class Parallel(Model):
    """Up to ``size`` runs at a time; further triggers are dropped and counted."""

    kind: Literal["parallel"] = "parallel"
    size: Count = 10


Mode: TypeAlias = Annotated[Single | Queued | Restart | Parallel, Field(discriminator="kind")]


class MaxRate(Model):
    """At most ``count`` firings in any ``window`` seconds; one more latches the rule."""

    count: Count
    window: PositiveSeconds


class Event(Model):
    """A condition, and when its truth makes the rule fire.

    Attributes
    ----------
    condition
        What must be true.
    trigger
        ``level``: on each message of the condition's topics for which it is true, and when it
        becomes true by time alone (silence, a rate, the end of ``hold``). ``edge``: on becoming
        true. Only a verdict of false re-arms an edge; unknown does not, so a flickering sensor
        makes no edges. ``change``: on each message for which it is true and which changes the
        value of a signal in it.
    hold
        Seconds for which the condition must have stayed true first; unknown breaks it.
    clear
        When given, the rule fires again only after this was true while ``condition`` was not.
    cooldown
        Seconds after the actions have finished during which triggers are dropped and counted.
    once
        At most one firing in the life of the state.
    mode
        What a trigger does while the actions of the last one still run.
    max_rate
        Limit beyond which the rule latches and reports it; it stays latched until it is reset.
    first_true_is_edge
        Whether a first verdict of true counts as becoming true.
    """

    condition: Condition
    trigger: Literal["level", "edge", "change"] = "level"
    hold: Seconds = 0.0
    clear: Condition | None = None
    cooldown: Seconds = 0.0
    once: bool = False
    mode: Mode = Single()
    max_rate: MaxRate | None = None
    first_true_is_edge: bool = True

    @model_validator(mode="after")
    def _fields_fit(self) -> Self:
        for condition in (self.condition, self.clear):
            if condition is not None:
                _refuse_negated_pulses(condition, negated=False)
        if self.trigger == "change" and self.hold:
            raise ValueError(
                f"hold={self.hold!r}: a change lasts for one message; use trigger 'edge' or 'level'"
            )
        if self.trigger == "change" and all(
            isinstance(leaf, (Absent, CallableCondition, Rate))
            for _, leaf in leaves(self.condition)
        ):
            raise ValueError(
                "trigger='change': the condition has no value that could change; use trigger 'edge'"
            )
        if self.hold and not _may_last(self.condition):
            raise ValueError(
                f"hold={self.hold!r}: the condition is true for one message at a time and cannot "
                "stay true; compare a value instead, or set hold to 0"
            )
        return self


def _may_last(condition: Condition) -> bool:
    """Whether a condition can be true between two messages."""
    if isinstance(condition, AllOf):
        return all(map(_may_last, condition.conditions))
    if isinstance(condition, AnyOf):
        return any(map(_may_last, condition.conditions))
    return not isinstance(condition, (Received, Changed))


def _refuse_negated_pulses(condition: Condition, negated: bool) -> None:
    # What is true for the length of one message is false nearly always: its opposite says nothing,
    # and whoever writes it means silence.
    if negated and isinstance(condition, (Received, Changed)):
        raise ValueError(
            f"'not' around '{condition.kind}' is true nearly always; use 'absent' for silence"
        )
    for child in children(condition):
        _refuse_negated_pulses(child, negated or isinstance(condition, Not))
