"""What the drive manager says, as happenings: STOP, a hand at the wheel, what holds it back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from kompass.timeline.entry import Kind, Level
from kompass.timeline.happening import Began, Happening, Over
from kompass.timeline.held import Held

HOLD = 0.5  # s for which something must hold it back before it is told of
BLOCKED = 5.0  # s before something that is in the way
STOP, HAND, BACK = "stop", "hand", "held back"  # keys

_FAULTS: dict[str, str] = {
    "scan stale": "Held: a scanner or camera is silent",
    "odometry stale": "Held: no fresh odometry arrives",
    "steered wheels": "Held: told to turn on the spot, which steered wheels cannot",
    "place unknown": "Held: its place is not known",
    "second publisher": "Held: somebody else commands the base",
}
_OBSTACLES: dict[str, str] = {
    "obstacle": "Held: an obstacle",
    "keep-out zone": "Held: a keep-out zone",
}


class DriveSaid(NamedTuple):
    """DriveState, as data."""

    stopped: bool = False
    stopped_by: str = ""
    reason: str = ""
    speed_factor: float = 1.0
    limited_by: str = ""
    driven_by: str = ""


class DriveObserver:
    """Tells of STOP and of hands at once, and of what holds the robot back when it lasts."""

    def __init__(self) -> None:
        self._faults, self._blocked = Held(HOLD), Held(BLOCKED)

    def says(self, said: DriveSaid, now: float) -> list[Happening]:
        """The drive manager says how it is; ``now`` in seconds since the epoch."""
        found: list[Happening] = []
        if said.stopped:
            found.append(
                Began(now, "stop", STOP, "STOP", said.reason, "warning", who=said.stopped_by)
            )
        else:
            found.append(Over(now, STOP))
        if said.driven_by:
            found.append(Began(now, "hand", HAND, "Driven by hand", who=said.driven_by))
        else:
            found.append(Over(now, HAND))
        back = self._held_back(said, now)
        if back is None:
            self._blocked.over(Over(now, BACK))
            found.append(self._faults.over(Over(now, BACK)))
        return found

    def due(self, now: float) -> Sequence[Happening]:
        """What has lasted long enough by now."""
        return [*self._faults.due(now), *self._blocked.due(now)]

    def _held_back(self, said: DriveSaid, now: float) -> Began | None:
        """What holds it back, if anything that is worth telling."""
        if said.stopped or said.speed_factor > 0.0:
            return None
        kind: Kind = "fault"
        level: Level = "error"
        if (title := _FAULTS.get(said.limited_by)) is not None:
            held, other = self._faults, self._blocked
        elif (title := _OBSTACLES.get(said.limited_by)) is not None:
            held, other, level = self._blocked, self._faults, "warning"
        else:
            return None
        other.over(Over(now, BACK))
        it = Began(now, kind, BACK, title, level=level)
        held.begins(it)
        return it
