"""One drive, judged: what became of it, and all that is worth telling of it."""

from __future__ import annotations

from typing import Literal, TypeAlias

from kompass.drills.scenario import Scenario
from kompass.rules.schema.model import Model

Outcome: TypeAlias = Literal[
    "arrived",
    "recovered",
    "stood",
    "gave_up",
    "stopped",
    "out_of_time",
    "stood_silent",
    "contact",
]
MomentKind: TypeAlias = Literal[
    "goal",
    "goal end",
    "fault",
    "fault end",
    "firing",
    "contact",
    "stop",
    "release",
    "death",
    "hang",
    "restart",
    "status",
    "alarm",
    "blind",
    "sees",
]
# In words, the best first.
OUTCOMES: dict[Outcome, str] = {
    "arrived": "arrived, undisturbed",
    "recovered": "recovered and arrived",
    "stood": "stood and said why",
    "gave_up": "gave up and said why",
    "stopped": "STOP",
    "out_of_time": "out of time, still moving",
    "stood_silent": "stood or gave up without a word",
    "contact": "touched something",
}
CAME_THROUGH: tuple[Outcome, ...] = ("arrived", "recovered")
# How bad it is, in steps: through; safe, and people know why; nobody knows; touched something.
GRADES: dict[Outcome, int] = {
    "arrived": 0,
    "recovered": 0,
    "stood": 1,
    "gave_up": 1,
    "stopped": 1,
    "out_of_time": 2,
    "stood_silent": 2,
    "contact": 3,
}


class GoalResult(Model):
    """What became of a goal of the scenario.

    Attributes
    ----------
    sent
        When it was first sent.
    ended
        When it was reached, or else its last answer came; None for none.
    outcome
        ``arrived`` when any attempt arrived; else of the last answer; empty for none.
    attempts
        How often it was sent, by whomever.
    superseded
        Whether the scenario itself sent the next goal before this one had ended.
    """

    x: float
    y: float
    tolerance: float
    sent: float
    ended: float | None = None
    outcome: str = ""
    message: str = ""
    attempts: int = 1
    superseded: bool = False

    @property
    def reached(self) -> bool:
        """Whether the robot arrived there."""
        return self.outcome == "arrived"


class FaultResult(Model):
    """What a fault did.

    Attributes
    ----------
    ended
        None when it was on to the end.
    disturbed
        Whether the robot was unwell after it (:meth:`kompass.drills.course.Course.unwell`).
    causes
        In what way.
    recovered_after
        Seconds from its beginning to the end of the last stretch that is its doing; None when that
        did not end, or when there was none.
    """

    name: str
    began: float
    ended: float | None = None
    disturbed: bool = False
    causes: tuple[str, ...] = ()
    recovered_after: float | None = None


class RefusedFault(Model):
    """A fault of the scenario that could not be switched on: the drive went on without it.

    Attributes
    ----------
    reason
        In words of who refused it.
    """

    name: str
    at: float
    reason: str


class ActionResult(Model):
    """How one action of a firing ended."""

    action: str
    ok: bool
    text: str = ""


class FiringResult(Model):
    """A rule fired, and what it did.

    Attributes
    ----------
    text
        The values that made it.
    ok
        Whether all went well; None while it ran at the drive's end.
    """

    rule_id: str
    at: float
    text: str = ""
    shadow: bool = False
    actions: tuple[ActionResult, ...] = ()
    ended: float | None = None
    ok: bool | None = None
    error: str = ""
    x: float | None = None
    y: float | None = None


class ContactResult(Model):
    """The robot touched something."""

    at: float
    what: str
    x: float | None = None
    y: float | None = None


class BrokenInvariant(Model):
    """Something happened that must never happen."""

    invariant: str
    at: float
    text: str


class DriveMoment(Model):
    """Something that a person who looks at the drive wants to see on its time line."""

    at: float
    kind: MomentKind
    text: str
    x: float | None = None
    y: float | None = None


class DriveSpell(Model):
    """A stretch in which the robot was unwell."""

    begin: float
    end: float
    causes: tuple[str, ...]


class DriveResult(Model):
    """One drive, judged.

    Attributes
    ----------
    why
        The outcome in a sentence.
    duration
        Seconds.
    recovery
        The longest of the faults' recoveries [s]; None when nothing was disturbed, or not all of
        it recovered.
    refused
        Faults that did not come about.
    left_stopped
        Whether STOP was in force at its end, arrived or not.
    track
        The way that was driven: (time, x, y), thinned.
    """

    scenario: Scenario
    outcome: Outcome
    why: str
    duration: float
    recovery: float | None = None
    goals: tuple[GoalResult, ...] = ()
    faults: tuple[FaultResult, ...] = ()
    refused: tuple[RefusedFault, ...] = ()
    firings: tuple[FiringResult, ...] = ()
    contacts: tuple[ContactResult, ...] = ()
    broken: tuple[BrokenInvariant, ...] = ()
    unwell: tuple[DriveSpell, ...] = ()
    moments: tuple[DriveMoment, ...] = ()
    left_stopped: bool = False
    track: tuple[tuple[float, float, float], ...] = ()

    @property
    def disturbed(self) -> bool:
        """Whether a fault made the robot unwell."""
        return any(fault.disturbed for fault in self.faults)

    @property
    def spared(self) -> bool:
        """Whether all that broke did so when the robot had arrived already."""
        arrivals = [goal.ended for goal in self.goals if goal.ended is not None]
        return (
            self.came_through
            and bool(self.faults and arrivals)
            and min(fault.began for fault in self.faults) > max(arrivals)
        )

    @property
    def came_through(self) -> bool:
        """Whether it reached its goals, and touched nothing."""
        return self.outcome in CAME_THROUGH

    @property
    def grade(self) -> int:
        """How bad it was: 0 for through, 3 for a contact."""
        return GRADES[self.outcome]

    @property
    def time_to_goal(self) -> float | None:
        """Seconds from sending to arriving, over all goals; None when not all were reached."""
        times = [
            goal.ended - goal.sent for goal in self.goals if goal.reached and goal.ended is not None
        ]
        return sum(times) if self.came_through else None
