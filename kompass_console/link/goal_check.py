"""May the robot be sent there? The planner is asked; for another stack, the map is looked at."""

from __future__ import annotations

import time
from collections import OrderedDict
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from kompass.algorithms.grid import OCCUPIED_FROM, Grid
from kompass.algorithms.planning.failure import REASONS
from kompass.rclpy_ext.reply import NoAnswer
from kompass_console.link.goals.goals import GoalTopic, Listeners
from kompass_console.link.link import RosLink
from kompass_console.schema.models import GoalCheck, GoalReason, PointXY
from kompass_console.schema.world import WorldModel

POINT_ONLY = "The robot's program takes points only, so the heading is not used."
STOPPED = "The robot is stopped: release STOP before it can drive there."
MAP_ONLY = "No planner checks goals here: only the map was looked at."


MESSAGES: dict[GoalReason, str] = {
    "": "The robot can go there.",
    "no_map": "There is no map yet, so no way can be planned.",
    "outside_map": "This point is outside the map.",
    "occupied": "This point is inside an obstacle.",
    "too_close": "This point is too close to an obstacle for the robot.",
    "unreachable": "No free way leads to this point.",
    "no_pose": "The robot does not know where it is, so no way can be planned.",
    "start_blocked": "The robot stands too close to an obstacle to plan a way.",
    "no_path": "The planner found no path to this point.",
    "above_horizon": "This is above the horizon; press on the floor.",
    "no_planner": "No planner answers. Check that the robot's program is running.",
    "nobody_listens": "Nobody listens for goals. Check that the robot's program is running.",
}


@dataclass(frozen=True, slots=True)
class Checked:
    """A check, the path (N, 2) to draw for it, and the topic the goal would go to."""

    check: GoalCheck
    preview: npt.NDArray[np.float64]
    topic: GoalTopic | None


_Goal = tuple[float, float, float | None]

_MOST_OF_WAY = 200  # points
_FRESH = 5.0  # s
_REMEMBERED = 32


@dataclass(frozen=True, slots=True)
class _Passed:
    checked: Checked
    at: float
    map_version: int


class GoalChecker:
    """Checks goals, and remembers for a moment which ones passed: between the answer at the
    pointer and the press on Go nothing is asked twice, and the planner looks again on its own
    when the goal reaches it."""

    def __init__(self, link: RosLink, world: WorldModel) -> None:
        self._link = link
        self._world = world
        self._passed: OrderedDict[_Goal, _Passed] = OrderedDict()

    async def check(self, x: float, y: float, yaw: float | None) -> Checked:
        """Check a goal (m, rad, map frame)."""
        checked = await check_goal(self._link, self._world, x, y, yaw)
        if checked.check.ok:
            self._passed[x, y, yaw] = _Passed(checked, time.monotonic(), self._map_version)
            while len(self._passed) > _REMEMBERED:
                self._passed.popitem(last=False)
        return checked

    async def check_before_sending(self, x: float, y: float, yaw: float | None) -> Checked:
        """As `check`, unless the same goal has just passed on the same map."""
        passed = self._passed.pop((x, y, yaw), None)
        if (
            passed is not None
            and time.monotonic() - passed.at < _FRESH
            and passed.map_version == self._map_version
            and passed.checked.topic == self._link.goals.listeners().topic_for(yaw)
        ):
            return passed.checked
        return await self.check(x, y, yaw)

    @property
    def _map_version(self) -> int:
        stamped = self._world.map.get()
        return 0 if stamped is None else stamped.version


def above_horizon() -> GoalCheck:
    """The answer for a gesture that is not on the floor."""
    return _refusal("above_horizon", 0.0, 0.0, None)


async def check_goal(
    link: RosLink, world: WorldModel, x: float, y: float, yaw: float | None
) -> Checked:
    """Check a goal (m, rad, map frame) the way it would be sent."""
    listeners: Listeners = link.goals.listeners()
    topic = listeners.topic_for(yaw)
    heading_used = yaw is not None and topic == "/goal_pose"
    preview: npt.NDArray[np.float64] = np.zeros((0, 2))
    if link.planner_checks:
        try:
            answer = await link.check_goal(x, y, yaw if heading_used else None)
        except NoAnswer:
            return Checked(_refusal("no_planner", x, y, yaw), preview, topic)
        reason: GoalReason
        reason = REASONS[answer.reason] if answer.reason < len(REASONS) else "no_path"
        check = GoalCheck(
            ok=answer.reachable,
            x=x,
            y=y,
            yaw=yaw,
            reason="" if answer.reachable else reason or "no_path",
            message=answer.message or MESSAGES["" if answer.reachable else reason or "no_path"],
            nearest=_point(answer.nearest),
            length=answer.length if answer.reachable else None,
            duration=answer.duration if answer.reachable else None,
        )
        preview = answer.preview
        check.way = _way(preview)
    elif topic is None or link.kompass_runs:
        check = _refusal("no_planner", x, y, yaw)
    else:
        reason = look_at_map(world, x, y)
        check = GoalCheck(ok=not reason, x=x, y=y, yaw=yaw, reason=reason, message=MESSAGES[reason])
    if check.ok and topic is None:
        check = _refusal("nobody_listens", x, y, yaw)
    check.heading_used = heading_used and check.ok
    check.note = _note(link, check, yaw, topic)
    return Checked(check, preview, topic)


def look_at_map(world: WorldModel, x: float, y: float) -> GoalReason:
    """Why a point cannot be driven to, as far as the map alone tells; "" when it can."""
    stamped = world.map.get()
    if stamped is None:
        return "no_map"
    cell = cell_at(stamped.value, x, y)
    if cell is None or cell < 0:
        return "outside_map"
    return "occupied" if cell >= OCCUPIED_FROM else ""


def cell_at(grid: Grid, x: float, y: float) -> int | None:
    """Value of the cell under a point of the map frame, or None outside the grid."""
    if not grid.contains((x, y))[0]:
        return None
    column, row = grid.world_to_cell((x, y))[0]
    return int(grid.cells[row, column])


def _note(link: RosLink, check: GoalCheck, yaw: float | None, topic: GoalTopic | None) -> str:
    if not check.ok:
        return ""
    notes = []
    if yaw is not None and topic == "/clicked_point":
        notes.append(POINT_ONLY)
    if not link.planner_checks:
        notes.append(MAP_ONLY)
    return " ".join(notes)


def _refusal(reason: GoalReason, x: float, y: float, yaw: float | None) -> GoalCheck:
    return GoalCheck(ok=False, x=x, y=y, yaw=yaw, reason=reason, message=MESSAGES[reason])


def _way(points: npt.NDArray[np.float64]) -> list[float]:
    """x, y, x, y, … of a path (N, 2), in cm and no more points than can be told apart."""
    if len(points) > _MOST_OF_WAY:
        points = points[np.linspace(0, len(points) - 1, _MOST_OF_WAY).astype(int)]
    return points.round(2).ravel().tolist()


def _point(point: tuple[float, float] | None) -> PointXY | None:
    return None if point is None else PointXY(x=point[0], y=point[1])
