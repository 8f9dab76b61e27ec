"""The goal being followed, from "sent" to how it ended. No ROS here: events in, `GoalInfo` out.

A goal sent from this console has no action id until the planner (or a rule that translates a
clicked point) starts one; the first action goal that appears after it is taken to be it. Goals
that other programs send are followed as well. Where the running recipe plans without an action,
the path and the pose tell how far the goal has come.
"""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kompass_console.schema.models import GoalInfo, GoalPhase
from kompass_console.schema.world import GoalMark, RobotMotion, WorldModel

ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(1, 7)  # action_msgs/GoalStatus

_UNANSWERED_AFTER = 4.0  # s
_ARRIVED_WITHIN = 0.15  # m, where no action says that the robot has arrived
_HEARD_WITHIN = 3.0  # s between a goal message of another program and the action goal it causes
_TOLD_WITHIN = 3.0  # s, of what is in the way: planners tell it twice a second
_CLOCKS_AGREE = 0.2  # s between this machine and the planner's
_SAME_TIME = 1.0  # s between a goal and its path, when a console attaches to a driving robot
_SLOWEST = 0.05  # m/s, for the time left
_ENDED: dict[int, GoalPhase] = {SUCCEEDED: "arrived", CANCELED: "canceled", ABORTED: "failed"}
_OVER: frozenset[GoalPhase] = frozenset({"arrived", "failed", "canceled"})
# Nobody sends it again: a robot that sets off by itself after a crash surprises who stands there.
_LOST = (
    "The planner's process died and took the goal with it; the robot drives no farther than the "
    "path that it has. Send the goal again."
)
_OTHER = "another program"
_REPORTS = 20  # of planners that are kept
_MESSAGES: dict[GoalPhase, str] = {
    "arrived": "The robot has arrived.",
    "canceled": "The goal was cancelled.",
    "failed": "The planner gave the goal up without saying why.",
}


@dataclass
class _Goal:
    id: str
    x: float
    y: float
    yaw: float | None
    sent_by: str
    started: float
    phase: GoalPhase = "sent"
    message: str = ""
    action: str = ""
    uuid: str = ""
    speed: float | None = None
    reported_left: float | None = None
    error: float | None = None
    ended: float | None = None
    path_seen: int = 0
    known_place: bool = True
    sent_stamp: float = math.inf
    accepted: float = -math.inf  # ROS time

    @property
    def over(self) -> bool:
        return self.phase in _OVER


class ActionStatus(NamedTuple):
    """Status of an action goal, and the ROS time (s) at which its server accepted it."""

    status: int
    accepted: float


@dataclass(frozen=True, slots=True)
class Ending:
    """What the action's result says about how a goal ended."""

    status: int
    message: str


@dataclass
class _Heard:
    """The last goal message of any program."""

    x: float = 0.0
    y: float = 0.0
    yaw: float | None = None
    at: float = field(default=-math.inf)


class GoalFollower:
    """Follows one goal at a time, the newest; told of events by the link's thread and the web's.

    Parameters
    ----------
    changed
        Called after each event that matters.
    sender
        Who sends the robot to a place (m), where that is known; else empty.
    now
        The time in s.
    """

    def __init__(
        self,
        world: WorldModel,
        changed: Callable[[], None],
        *,
        sender: Callable[[float, float], str] = lambda x, y: "",
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._sender = sender
        self._world = world
        self._changed = changed
        self._now = now
        self._lock = threading.RLock()
        self._goal: _Goal | None = None
        self._heard = _Heard()
        self._reported: deque[_Heard] = deque(
            maxlen=_REPORTS
        )  # goals of planners; `at` in ROS time
        self._seen: dict[str, set[str]] = {}

    def sent(
        self,
        goal_id: str,
        x: float,
        y: float,
        yaw: float | None,
        *,
        by: str,
        speed: float | None,
        stamp: float,
    ) -> None:
        """A goal of this console is about to be published at ROS time `stamp` (s); `speed` (m/s)
        is what its check expected on average.

        The pages are not told at once: who sent it knows, and the planner's answer, which they all
        wait for, would come behind this one.
        """
        with self._lock:
            path = self._world.path.get()
            self._goal = _Goal(
                id=goal_id,
                x=x,
                y=y,
                yaw=yaw,
                sent_by=by,
                started=self._now(),
                message="Sent; waiting for the planner.",
                speed=speed,
                path_seen=0 if path is None else path.version,
                sent_stamp=stamp,
            )
            self._mark()

    def heard(self, x: float, y: float, yaw: float | None) -> None:
        """Somebody (perhaps this console) published a goal message."""
        with self._lock:
            self._heard = _Heard(x, y, yaw, self._now())

    def reported(self, x: float, y: float, yaw: float | None, began: float) -> None:
        """A planner tells of the goal that it pursues since ROS time `began` (s)."""
        with self._lock:
            self._reported.append(_Heard(x, y, yaw, began))
            if self._goal is not None:
                self._place_by_reports(self._goal)
        self._changed()

    def statuses(self, action: str, goals: Mapping[str, ActionStatus]) -> list[str]:
        """The action server's list of goals, by uuid (hex). Returns the uuids to ask the result
        of."""
        ask = []
        with self._lock:
            seen, self._seen[action] = self._seen.get(action, set()), set(goals)
            for uuid, (status, accepted) in goals.items():
                if uuid not in seen and (status not in _ENDED or self._is_ours(accepted)):
                    self._adopt(action, uuid)
                    self._was_taken(accepted)
                    ask.append(uuid)
                if self._goal is not None and self._goal.uuid == uuid:
                    self._advance(self._goal, status)
        self._changed()
        return ask

    def feedback(self, uuid: str, distance_left: float | None) -> None:
        """Feedback of an action goal."""
        with self._lock:
            goal = self._goal
            if goal is None or goal.uuid != uuid or goal.over:
                return
            goal.reported_left = distance_left
            if goal.phase != "driving":
                self._drive(goal)

    def result(self, uuid: str, ending: Ending) -> None:
        """How an action goal ended, in the planner's own words."""
        with self._lock:
            goal = self._goal
            if goal is None or goal.uuid != uuid:
                return
            self._advance(goal, ending.status)
            if goal.over and ending.message:
                goal.message = ending.message
        self._changed()

    def lost(self, uuid: str) -> None:
        """Whoever had taken an action goal is gone, and nobody will say how it ended."""
        with self._lock:
            goal = self._goal
            if goal is None or goal.uuid != uuid or goal.over:
                return
            self._end(goal, "failed", _LOST)
        self._changed()

    def tick(self, *, action_there: bool) -> None:
        """Let time pass: goals nobody takes, and those that no action speaks for."""
        with self._lock:
            goal = self._goal
            if goal is None or goal.over:
                return
            motion = self._world.motion.get()
            self._learn_place(goal)
            planned = self._path_of(goal) is not None and (goal.uuid or not action_there)
            if planned and goal.phase in ("sent", "accepted"):
                self._drive(goal)
            waited = self._now() - goal.started
            if not goal.uuid and goal.phase == "sent" and waited > _UNANSWERED_AFTER:
                self._end(goal, "failed", "No planner took the goal. Check that it is running.")
            elif not goal.uuid and goal.phase == "driving" and motion is not None:
                miss = _distance(motion.value, goal)
                standing = abs(motion.value.v) < 0.01
                if standing and miss < _ARRIVED_WITHIN:
                    self._end(goal, "arrived", _MESSAGES["arrived"])
                elif standing and self._path_of(goal) is None:
                    self._end(goal, "failed", "The planner took the path back.")

    def target(self) -> tuple[str, str] | None:
        """Action name and uuid of the goal that runs; empty strings while it has none yet; None
        when no goal runs."""
        with self._lock:
            goal = self._goal
            return None if goal is None or goal.over else (goal.action, goal.uuid)

    def withdraw(self) -> None:
        """The operator cancels a goal that no action has taken."""
        with self._lock:
            if self._goal is not None and not self._goal.over:
                self._end(self._goal, "canceled", _MESSAGES["canceled"])
        self._changed()

    def info(self) -> GoalInfo | None:
        """The goal as the page shows it."""
        with self._lock:
            goal = self._goal
            if goal is None:
                return None
            left = None if goal.over else self._left(goal)
            motion = self._world.motion.get()
            speed = goal.speed
            if speed is None and motion is not None and motion.value.v > _SLOWEST:
                speed = motion.value.v
            return GoalInfo(
                id=goal.id,
                phase=goal.phase,
                x=goal.x,
                y=goal.y,
                yaw=goal.yaw,
                sent_by=goal.sent_by,
                message=goal.message,
                distance_left=left,
                eta=None if left is None or speed is None else left / max(speed, _SLOWEST),
                error=goal.error,
                elapsed=(goal.ended or self._now()) - goal.started,
                ended=None if goal.ended is None else self._now() - goal.ended,
                hindrance="" if goal.over else self._hindrance(),
            )

    def _hindrance(self) -> str:
        told = self._world.hindrance.get()
        if told is None or told.value is None or told.age(self._now()) > _TOLD_WITHIN:
            return ""
        return told.value.text

    def _adopt(self, action: str, uuid: str) -> None:
        """An action goal has appeared: ours, or another program's."""
        goal = self._goal
        if goal is None or goal.over or goal.uuid:
            goal = self._foreign(uuid)
            self._goal = goal
        goal.action, goal.uuid = action, uuid
        goal.phase = "accepted"
        goal.message = "The planner has accepted the goal."
        self._mark()

    def _is_ours(self, accepted: float) -> bool:
        """Whether an ended goal is the one we wait for: it may have been over before the console
        had found the action that took it."""
        goal = self._goal
        waiting = goal is not None and not goal.over and not goal.uuid
        return waiting and goal is not None and accepted > goal.sent_stamp - _CLOCKS_AGREE

    def _foreign(self, uuid: str) -> _Goal:
        path = self._world.path.get()
        # A path that came just before belongs to this goal: both are latched, and a console that
        # attaches to a driving robot gets them in any order.
        path_seen = 0 if path is None else path.version - (path.age() < _SAME_TIME)
        recent = self._now() - self._heard.at < _HEARD_WITHIN
        heard = self._heard if recent else _Heard()
        return _Goal(
            id=uuid,
            x=heard.x,
            y=heard.y,
            yaw=heard.yaw,
            sent_by=_OTHER,
            started=self._now(),
            path_seen=path_seen,
            known_place=recent,
        )

    def _was_taken(self, accepted: float) -> None:
        """The goal that is followed was accepted at that ROS time (s)."""
        if self._goal is not None:
            self._goal.accepted = accepted
            self._place_by_reports(self._goal)

    def _place_by_reports(self, goal: _Goal) -> None:
        """A goal sent straight to the action carries no place; its planner tells it, on the clock
        by which it has accepted it."""
        near = [each for each in self._reported if abs(each.at - goal.accepted) < _SAME_TIME]
        if goal.sent_by != _OTHER or not near:
            return
        told = near[-1]
        goal.x, goal.y, goal.yaw, goal.known_place = told.x, told.y, told.yaw, True
        goal.sent_by = self._sender(told.x, told.y) or _OTHER
        self._mark()

    def _learn_place(self, goal: _Goal) -> None:
        """Where no planner tells the place, the end of the path does."""
        path = self._path_of(goal)
        if goal.known_place or path is None:
            return
        goal.x, goal.y = (float(c) for c in path[-1])
        goal.known_place = True
        self._mark()

    def _advance(self, goal: _Goal, status: int) -> None:
        if goal.over:
            return
        if status in _ENDED:
            self._end(goal, _ENDED[status], _MESSAGES[_ENDED[status]])
        elif status == CANCELING:
            goal.message = "Canceling."

    def _drive(self, goal: _Goal) -> None:
        goal.phase, goal.message = "driving", "On the way."
        self._changed()

    def _end(self, goal: _Goal, phase: GoalPhase, message: str) -> None:
        goal.phase, goal.message, goal.ended = phase, message, self._now()
        motion = self._world.motion.get()
        if phase == "arrived" and motion is not None and goal.known_place:
            goal.error = _distance(motion.value, goal)
        self._mark()
        self._changed()

    def _mark(self) -> None:
        """Tell the scene where the goal is."""
        goal = self._goal
        shown = goal is not None and not goal.over and goal.known_place
        self._world.goal.set(
            GoalMark(goal.x, goal.y, goal.yaw, active=True) if goal and shown else None
        )

    def _path_of(self, goal: _Goal) -> npt.NDArray[np.float64] | None:
        """The path planned for this goal, or None while there is none (a cleared one included)."""
        path = self._world.path.get()
        if path is None or path.version <= goal.path_seen or len(path.value) < 2:
            return None
        return path.value

    def _left(self, goal: _Goal) -> float | None:
        path, motion = self._path_of(goal), self._world.motion.get()
        if goal.phase != "driving" or path is None or motion is None:
            return goal.reported_left
        return length_left(path, (motion.value.pose.x, motion.value.pose.y))


def length_left(path: npt.NDArray[np.float64], position: tuple[float, float]) -> float:
    """Metres along `path` (N, 2) from the point of it nearest to `position` to its end."""
    starts, steps = path[:-1], np.diff(path, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    to_robot = np.array(position) - starts
    share = np.clip(
        np.einsum("ij,ij->i", to_robot, steps) / np.maximum(lengths**2, 1e-12), 0.0, 1.0
    )
    off = np.linalg.norm(to_robot - share[:, None] * steps, axis=1)
    nearest = int(np.argmin(off))
    return float(lengths[nearest:].sum() - share[nearest] * lengths[nearest])


def _distance(motion: RobotMotion, goal: _Goal) -> float:
    return math.hypot(motion.pose.x - goal.x, motion.pose.y - goal.y)
