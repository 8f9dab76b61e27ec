"""What planners tell of goals, as happenings."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal

from kompass.rules.schema.model import Model
from kompass.timeline.entry import Level
from kompass.timeline.happening import Began, Happening, Over

Outcome = Literal[
    "", "arrived", "refused", "blocked", "stopped", "preempted", "canceled", "stuck", "error"
]
_LEVELS: dict[str, Level] = {
    "refused": "warning",
    "blocked": "warning",
    "stuck": "warning",
    "error": "error",
}


class GoalReport(Model):
    """A goal that a planner pursues, or pursued.

    Attributes
    ----------
    planner, id
        Who pursues it, and what tells it from all other goals.
    x, y, yaw
        Where [m], [rad]; yaw is None where any heading will do.
    time
        At which it began, or ended (s since the epoch).
    outcome
        How it ended; empty while it is pursued.
    """

    planner: str
    id: str
    x: float
    y: float
    yaw: float | None = None
    time: float
    outcome: Outcome = ""
    message: str = ""


class GoalObserver:
    """Tells which goals the robot had, and what became of them."""

    def __init__(self) -> None:
        self._open: dict[str, str] = {}  # key by planner

    def told(self, report: GoalReport) -> list[Happening]:
        """A planner tells of a goal."""
        key = f"goal {report.id}"
        if report.outcome:
            if self._open.get(report.planner) == key:
                del self._open[report.planner]
            level = _LEVELS.get(report.outcome, "info")
            return [Over(report.time, key, report.message, level)]
        found: list[Happening] = []
        before = self._open.get(report.planner)
        if before not in (None, key):
            found.append(Over(report.time, before or ""))
        self._open[report.planner] = key
        title = f"Goal {report.x:z.2f}, {report.y:z.2f}"
        found.append(Began(report.time, "goal", key, title, source=report.planner))
        return found

    def lost(self, nodes: Collection[str], now: float) -> list[Happening]:
        """The process of these nodes is lost; ``now`` in seconds since the epoch."""
        gone = [name for name in self._open if name in nodes]
        text = "Whoever pursued it was lost, and the goal with it."
        return [Over(now, self._open.pop(name), text, "error") for name in gone]
