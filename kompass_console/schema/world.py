"""The newest of everything the robot said: written by the ROS link, read by scene and API.

Nothing here queues. A reader that comes late finds the newest value and how old it is.
"""

from __future__ import annotations

import itertools
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Generic, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from kompass.algorithms.geometry import compose, inverse, wrap_angle
from kompass.algorithms.grid import Grid

T = TypeVar("T")

MAP_FRAME = "map"


class Stamped(NamedTuple, Generic[T]):
    """A value, when it was received (monotonic s), and how many came before it."""

    value: T
    received: float
    version: int

    def age(self, now: float | None = None) -> float:
        """Seconds since it was received."""
        return max(0.0, (time.monotonic() if now is None else now) - self.received)


class Latest(Generic[T]):
    """A slot for one value; one writer, any number of readers, no lock.

    The slot is replaced as a whole, so a reader sees either the old or the new triple.
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._stamped: Stamped[T] | None = None
        self._count = 0

    def set(self, value: T) -> None:
        self._count += 1
        self._stamped = Stamped(value, self._now(), self._count)

    def clear(self) -> None:
        """Forget the value: its source is another one now."""
        self._stamped = None

    def get(self) -> Stamped[T] | None:
        return self._stamped


class Pose(NamedTuple):
    """Planar pose (m, m, rad): what :mod:`kompass.algorithms` takes, with names."""

    x: float
    y: float
    yaw: float


@dataclass(frozen=True, slots=True)
class RobotMotion:
    """Odometry: pose in `frame`, twist in the robot's (m/s, rad/s), stamp (ROS s)."""

    pose: Pose
    v: float
    w: float
    stamp: float
    frame: str = MAP_FRAME


@dataclass(frozen=True, slots=True)
class Scan:
    """Laser scan: ranges (N,) in m (not finite: no return), first angle and step in rad, stamp
    (ROS s) and the frame it is measured in."""

    ranges: npt.NDArray[np.float32]
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    stamp: float
    frame: str


@dataclass(frozen=True, slots=True)
class GoalMark:
    """Where the robot is sent, m and rad; `yaw` None when any heading will do."""

    x: float
    y: float
    yaw: float | None
    active: bool


@dataclass(frozen=True, slots=True)
class HindranceMark:
    """What is in the way of the goal, m, and a sentence about it."""

    x: float
    y: float
    text: str


@dataclass(frozen=True, slots=True)
class ZoneMark:
    """A zone of the map of now: corners in m, and its speed in m/s; None of a keep-out zone."""

    name: str
    corners: tuple[tuple[float, float], ...]
    speed: float | None


@dataclass(frozen=True, slots=True)
class PlaceMark:
    """A place of the map of now, m and rad; `yaw` None when any heading will do."""

    name: str
    x: float
    y: float
    yaw: float | None


@dataclass(frozen=True, slots=True)
class ShapeLabel:
    """A text in the scene, at a place in m."""

    text: str
    at: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Shape:
    """What is drawn of a topic, in the frame of the scene or in its own, all in m.

    Attributes
    ----------
    points
        (N, 3).
    segments
        Of lines, (M, 2, 3).
    areas
        Corners of flat rectangles in their order round, (K, 4, 3).
    labels
        Texts.
    point_colours, segment_colours
        RGB (N, 3) and (M, 3), 0..255, of what says its own; None for the colour of the topic.
    """

    points: npt.NDArray[np.float32] = field(default_factory=lambda: np.zeros((0, 3), np.float32))
    segments: npt.NDArray[np.float32] = field(
        default_factory=lambda: np.zeros((0, 2, 3), np.float32)
    )
    areas: npt.NDArray[np.float32] = field(default_factory=lambda: np.zeros((0, 4, 3), np.float32))
    labels: tuple[ShapeLabel, ...] = ()
    point_colours: npt.NDArray[np.uint8] | None = None
    segment_colours: npt.NDArray[np.uint8] | None = None


class PoseHistory:
    """Poses of the last seconds by stamp, so that a scan is drawn from where it was taken."""

    def __init__(self, length: int = 150) -> None:
        self._samples: deque[tuple[float, Pose]] = deque(maxlen=length)

    def add(self, stamp: float, pose: Pose) -> None:
        if self._samples and stamp <= self._samples[-1][0]:
            self._samples.clear()  # the clock was set back: nothing older is comparable
        self._samples.append((stamp, pose))

    def at(self, stamp: float) -> Pose | None:
        """Pose at `stamp`, interpolated; the nearest end outside the history; None when empty."""
        samples = list(self._samples)
        if not samples:
            return None
        for (t0, before), (t1, after) in itertools.pairwise(samples):
            if t0 <= stamp <= t1:
                f = (stamp - t0) / (t1 - t0)
                return Pose(
                    before.x + f * (after.x - before.x),
                    before.y + f * (after.y - before.y),
                    wrap_angle(before.yaw + f * wrap_angle(after.yaw - before.yaw)),
                )
        return samples[0][1] if stamp < samples[0][0] else samples[-1][1]


class WorldModel:
    """One slot per thing the console reads.

    Parameters
    ----------
    now
        Monotonic seconds.
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self.motion: Latest[RobotMotion] = Latest(now)
        self.history = PoseHistory()
        self.scan: Latest[Scan] = Latest(now)
        self.scan_mount: dict[str, Pose] = {}
        self.map: Latest[Grid] = Latest(now)
        self.local_map: Latest[Grid] = Latest(now)
        self.path: Latest[npt.NDArray[np.float64]] = Latest(now)
        self.footprint: Latest[npt.NDArray[np.float64]] = Latest(now)
        self.description: Latest[str] = Latest(now)
        self.description_problem = ""  # why the robot's own description is not drawn, or not whole
        self.goal: Latest[GoalMark | None] = Latest(now)
        self.hindrance: Latest[HindranceMark | None] = Latest(now)
        self.places: Latest[tuple[PlaceMark, ...]] = Latest(now)
        self.zones: Latest[tuple[ZoneMark, ...]] = Latest(now)
        # By topic. Whoever draws says which are wanted, whoever reads says what there is; each
        # puts a whole new one in its place.
        self.extras_wanted: frozenset[str] = frozenset()
        self.extras: Mapping[str, Stamped[Shape]] = {}

    @property
    def frame(self) -> str:
        """In which frame the scene is: that of odometry."""
        motion = self.motion.get()
        return MAP_FRAME if motion is None else motion.value.frame

    def scanned_from(self, scan: Scan) -> Pose | None:
        """Where the sensor was when a scan was taken, in the map frame; None until that is known.

        A sensor of which nobody has said where it is fixed is taken to be in the robot's middle.
        """
        robot = self.history.at(scan.stamp)
        if robot is None:
            return None
        return self.sensor_at(robot, scan)

    def sensor_at(self, robot: Pose, scan: Scan) -> Pose:
        """Where the sensor of a scan is while the robot is at a pose, in the map frame."""
        return Pose(*compose(robot, self._mount(scan)).tolist())

    def robot_at(self, sensor: Pose, scan: Scan) -> Pose:
        """Where the robot is while the sensor of a scan is at a pose, in the map frame."""
        return Pose(*compose(sensor, inverse(self._mount(scan))).tolist())

    def _mount(self, scan: Scan) -> Pose:
        return self.scan_mount.get(scan.frame, Pose(0.0, 0.0, 0.0))
