"""What the planner plans on: the map, if there is one, and what the sensor has seen."""

import math
from collections import deque
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.geometry import Pose2D, compose
from kompass.algorithms.grid import Grid
from kompass.algorithms.mapping.cloud_view import CloudView
from kompass.algorithms.mapping.moving import MovingObstacles
from kompass.algorithms.mapping.world_model import TooFar, WorldModel, pose_at
from kompass.components.base.seen import Seen, stamp_of

# Without a map: how far beside robot and goal a way is looked for; further when there is none [m].
MARGINS = (2.5, 5.0, 10.0)
AT_LEAST = 0.2  # s between two plans
TRACES = 200  # places of what moves that are kept
RENEW = 5.0  # s after which what was forgotten is found out
# On a model of more cells than that, a way is mended in the robot's neighbourhood …
LARGE = 500_000
# … which reaches so much further than what is seen [m], …
BEYOND = 4.0
# … and looked for on all of it so seldom that it takes some fifth of a core.
CELLS_PER_SECOND = 200_000


class LiveMap:
    """Takes scans and clouds in at the pose that they were made at, and knows when a new plan is
    worth it.

    Parameters
    ----------
    memory
        Seconds after which what nobody looks at is forgotten.

    Attributes
    ----------
    moved
        Where something that moves was seen last, (x, y) [m] and when [s]; the oldest first.
    """

    def __init__(self, memory: float) -> None:
        self.model = WorldModel(memory=memory)
        self.moved: deque[tuple[float, float, float]] = deque(maxlen=TRACES)
        self._moving: dict[str, MovingObstacles] = {}  # by topic
        self._waiting: dict[str, Any] = {}  # by topic
        self._before: tuple[float, Pose2D] | None = None
        self._after: tuple[float, Pose2D] | None = None
        self._margin = 0
        self._changed = True  # since the last grid
        self._made = self._tried = -np.inf
        self._freed = self._threatened = False  # since the last plan
        self._looked_whole = -np.inf  # when a plan on all of it was made, or tried
        self._marked: NDArray[np.float64] = np.empty((0, 2))

    def set_map(self, grid: Grid) -> None:
        """Take a map; what was seen stays."""
        self.model.set_map(grid)
        self._changed = self._freed = True
        self._looked_whole = -np.inf

    def wait_with(self, topic: str, message: Any) -> None:
        """Keep a scan or cloud until it is known where the robot was."""
        self._waiting[topic] = message

    def locate(self, pose: Pose2D, header: Any) -> Iterator[tuple[str, Any]]:
        """Take a location; yields what waits, by topic, if it was made before.

        Parameters
        ----------
        header
            Of the location; None when it has none, and then it is as new as can be.
        """
        self._marked = np.empty((0, 2))
        newest = max((stamp_of(message) for message in self._waiting.values()), default=-math.inf)
        stamp = newest if header is None else float(header.stamp.sec + 1e-9 * header.stamp.nanosec)
        self._before = self._after
        if math.isfinite(stamp):
            self._after = (stamp, pose)
        for topic, message in list(self._waiting.items()):
            if stamp_of(message) <= stamp:
                yield topic, self._waiting.pop(topic)

    def see(self, topic: str, message: Any, read: Callable[[Any], Seen], now: float) -> None:
        """Take in what :meth:`locate` has given.

        Raises
        ------
        TransformError
            It is not known where its sensor is on the robot.
        ValueError
            It says nothing of what is around, or is too far from where the model began.
        """
        assert self._after is not None
        made, before = stamp_of(message), self._before
        there = self._after[1] if before is None else pose_at(made, before, self._after)
        seen = read(message)
        if isinstance(seen, CloudView):
            change = self.model.look(seen, there, now, topic)
        else:
            x, y, yaw = (float(value) for value in compose(there, seen.sensor))
            # Those that look around in one plane see the same things.
            change = self.model.see(*seen.rays, (x, y, yaw), now, round(seen.height, 2))
            moving = self._moving.setdefault(topic, MovingObstacles())
            moving.see(*seen.rays, (x, y, yaw), now)
            self.moved.extend((float(row[0]), float(row[1]), now) for row in moving.at(now))
        self._marked = np.concatenate([self._marked, change.marked])
        self._freed |= change.cleared > 0
        self._changed |= change.cleared > 0 or len(change.marked) > 0

    def forget(self, unseen_for: float, now: float) -> int:
        """Forget what no ray has come to for so long [s]; how many cells that were."""
        cells = self.model.forget(unseen_for, now)
        self._freed |= cells > 0
        self._changed |= cells > 0
        return cells

    def threatens(self, path: NDArray[np.float64], near: float) -> bool:
        """Whether what the last scan has marked is nearer to a path (N, 3) than ``near`` [m]."""
        if not len(self._marked) or not len(path):
            return False
        # The nearest edge of a cell is up to half a cell from its middle.
        away = np.hypot(*(self._marked[:, None] - path[None, :, :2]).transpose(2, 0, 1)).min()
        if away < near + self.model.resolution / 2:
            self._threatened = True
            return True
        return False

    def is_worth_a_plan(self, now: float) -> bool:
        """Whether the path may have lost its clearance, or something has gone out of the way."""
        return (self._threatened or self._freed) and now - self._tried >= AT_LEAST

    def planned(self, now: float) -> None:
        """A plan on all of it was made, or tried."""
        self._tried = self._looked_whole = now
        self._threatened = self._freed = False

    def mended(self, now: float) -> None:
        """The way was found to be good, or was mended, in the neighbourhood of the robot."""
        self._tried = now
        self._threatened = False

    @property
    def neighbourhood(self) -> float:
        """How far from the robot a way is mended [m]; 0 where it is always planned on all of it."""
        large = math.prod(self.model.shape) > LARGE
        return self.model.reach + BEYOND if large else 0.0

    def is_worth_all(self, now: float) -> bool:
        """Whether a way that is good nearby may be bettered by one that leads elsewhere, and so
        much time has passed that it may be looked for."""
        pause = math.prod(self.model.shape) / CELLS_PER_SECOND
        return self._freed and now - self._looked_whole >= pause

    def widen(self) -> bool:
        """Look further beside robot and goal from now on; False where there is no further."""
        if self.model.has_map or self._margin + 1 >= len(MARGINS):
            return False
        self._margin += 1
        return True

    def grid(self, pose: Pose2D, goal: Pose2D | None, now: float) -> Grid | None:
        """The grid to plan on; None when it is as it was."""
        places = [pose[:2]] if goal is None else [pose[:2], goal[:2]]
        before = self.model.shape
        try:
            self.model.include(places, MARGINS[self._margin])
        except TooFar:
            # The planner says that the goal is outside of what it can look at.
            self.model.include(places[:1], MARGINS[0])
        same = before == self.model.shape and not self._changed
        if same and now - self._made < RENEW:
            return None
        self._changed, self._made = False, now
        return self.model.grid(now)
