"""What was observed of one drive, and nothing concluded from it.

Every fact has the time ``at`` at which it was observed: seconds since the drive's start. Whoever
lets a drive happen writes them down; how it is judged depends on these alone, and not on the order
in which facts of the same time were written.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import astuple, dataclass
from itertools import groupby
from typing import Literal, TypeAlias, TypeVar, get_args

# The names of kompass.components.planner.goal_progress.GoalOutcome, in the order of their numbers.
GOAL_OUTCOMES = (
    "arrived",
    "refused",
    "blocked",
    "stopped",
    "preempted",
    "canceled",
    "stuck",
    "error",
)
GoalEnd: TypeAlias = Literal[
    "arrived", "refused", "blocked", "stopped", "preempted", "canceled", "stuck", "error"
]
HEALTHY = 0  # ComponentStatus.STATUS_HEALTHY


@dataclass(frozen=True, slots=True)
class Motion:
    """Where the robot was in truth (not by its odometry), and how it moved.

    Attributes
    ----------
    x, y, yaw
        Pose in the map [m, m, rad].
    speed, turning
        Linear [m/s] and angular [rad/s] velocity of the body.
    """

    at: float
    x: float
    y: float
    yaw: float
    speed: float
    turning: float


@dataclass(frozen=True, slots=True)
class GoalSent:
    """A goal was given to the planner.

    Attributes
    ----------
    goal
        Number that no other goal of the drive has.
    x, y
        Where it is [m].
    tolerance
        How near is there [m].
    given
        Whether the scenario gave it; False for a goal that a rule or a component sent.
    """

    at: float
    goal: int
    x: float
    y: float
    tolerance: float
    given: bool = True


@dataclass(frozen=True, slots=True)
class GoalEnded:
    """The planner answered a goal; ``message`` is its reason."""

    at: float
    goal: int
    outcome: GoalEnd
    message: str = ""


@dataclass(frozen=True, slots=True)
class Contact:
    """The robot's body began to touch something, by the name of that in the physics."""

    at: float
    what: str


@dataclass(frozen=True, slots=True)
class StopPressed:
    """STOP was pressed, by a person, a rule or a component."""

    at: float
    by: str
    reason: str = ""


@dataclass(frozen=True, slots=True)
class StopReleased:
    """STOP was released; ``person`` tells whether by a person."""

    at: float
    by: str
    person: bool = True


@dataclass(frozen=True, slots=True)
class Status:
    """A status of a component was published.

    Attributes
    ----------
    level
        Of ``ComponentStatus``; 0 for healthy.
    own
        Whether the component said it; False when the monitor spoke for it.
    """

    at: float
    component: str
    level: int
    message: str = ""
    own: bool = True


@dataclass(frozen=True, slots=True)
class ProcessEnded:
    """A process of the stack died, or was found hanging and counts as dead."""

    at: float
    process: str
    components: tuple[str, ...] = ()
    reason: str = ""
    hangs: bool = False  # it lives, and may go on


@dataclass(frozen=True, slots=True)
class ProcessStarted:
    """A process of the stack runs (again)."""

    at: float
    process: str


@dataclass(frozen=True, slots=True)
class RuleFired:
    """A rule fired.

    Attributes
    ----------
    epoch, run
        Life of the monitor, and number of the run within it.
    text
        The condition's values at that moment, in words.
    shadow
        Whether it is in shadow: nothing is done.
    """

    at: float
    rule_id: str
    run: int
    text: str = ""
    shadow: bool = False
    epoch: str = ""


@dataclass(frozen=True, slots=True)
class ActionDone:
    """One action of a run ended."""

    at: float
    rule_id: str
    run: int
    action: str
    ok: bool
    text: str = ""
    epoch: str = ""


@dataclass(frozen=True, slots=True)
class RunDone:
    """All actions of a run ended, or it was cancelled."""

    at: float
    rule_id: str
    run: int
    ok: bool
    error: str = ""
    epoch: str = ""


@dataclass(frozen=True, slots=True)
class FaultBegan:
    """A fault was switched on."""

    at: float
    name: str


@dataclass(frozen=True, slots=True)
class FaultEnded:
    """A fault was switched off, or came to its end."""

    at: float
    name: str


@dataclass(frozen=True, slots=True)
class FaultFailed:
    """A fault could not be switched on, for this reason; nothing has broken."""

    at: float
    name: str
    reason: str


@dataclass(frozen=True, slots=True)
class AlarmRaised:
    """An alarm was raised to the operators."""

    at: float
    name: str
    text: str = ""


@dataclass(frozen=True, slots=True)
class AlarmCleared:
    """An alarm was cleared."""

    at: float
    name: str


@dataclass(frozen=True, slots=True)
class WentBlind:
    """The last message came of a sensor that driving safely needs, as ``scan`` or ``odometry``.

    Attributes
    ----------
    period
        The longest of the pauses between its last messages [s]; 0 where there were none.
    """

    at: float
    sense: str
    period: float = 0.0


@dataclass(frozen=True, slots=True)
class SeesAgain:
    """Messages of that sensor come again."""

    at: float
    sense: str


@dataclass(frozen=True, slots=True)
class DriveEnded:
    """The drive was over: all its goals had ended, or its time had."""

    at: float


# In the order in which facts of one time are taken: of a pair that undo each other the one that is
# worse for the robot comes last, and counts.
Fact: TypeAlias = (
    FaultEnded
    | FaultBegan
    | FaultFailed
    | SeesAgain
    | WentBlind
    | ProcessStarted
    | ProcessEnded
    | Status
    | AlarmCleared
    | AlarmRaised
    | RuleFired
    | ActionDone
    | RunDone
    | StopReleased
    | StopPressed
    | Contact
    | GoalEnded
    | GoalSent
    | Motion
    | DriveEnded
)
_ORDER: dict[type, int] = {kind: place for place, kind in enumerate(get_args(Fact))}


_F = TypeVar("_F", bound=Fact)


def in_order(facts: Iterable[_F]) -> tuple[_F, ...]:
    """Facts by their time; those of one time in an order that depends on themselves alone."""
    ordered: list[_F] = []
    # Few facts share time and kind with another: only these are worth a look at all their fields.
    for _, group in groupby(sorted(facts, key=_place), key=_place):
        same = list(group)
        ordered += same if len(same) == 1 else sorted(same, key=lambda fact: repr(astuple(fact)))
    return tuple(ordered)


def _place(fact: Fact) -> tuple[float, int]:
    return fact.at, _ORDER[type(fact)]
