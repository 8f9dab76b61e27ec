"""Does the robot know where it is? How well its scan fits the map there, and when that is bad."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from numpy.typing import ArrayLike

from kompass.algorithms.geometry import Floats, compose, inverse
from kompass.algorithms.grid import Grid
from kompass.algorithms.mapping.scan_match import ScanMatcher
from kompass.algorithms.mapping.scan_points import read_rays, scan_fault
from kompass_console.schema.models import LocalisationInfo, LocalisationProblem
from kompass_console.schema.world import Pose, Scan, WorldModel

LOST = 0.5  # less agreement than this is a robot that may be elsewhere
FOUND = 0.6  # and so much one that is well again
LOST_AFTER = 3.0  # s; a person who walks through the scan is gone by then
FOUND_AFTER = 1.0  # s
OLD = 2.0  # s; of a scan that says nothing about now

_PERIOD = 0.5  # s

_logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Fit:
    """How well a scan fits the map with the robot, and so its sensor, at a pose of the map.

    `agreement` is None where too little of what it sees is on the map.
    """

    robot: Pose
    sensor: Pose
    scan: Scan
    agreement: float | None


class Localisation:
    """Compares the newest scan with the map, twice a second, at the pose that the robot tells.

    Parameters
    ----------
    world
        What the robot said.
    now
        Monotonic seconds.
    """

    def __init__(self, world: WorldModel, now: Callable[[], float] = time.monotonic) -> None:
        self._world, self._now = world, now
        self._matcher: tuple[Grid, ScanMatcher] | None = None
        self._making = threading.Lock()
        self._compared = 0  # version of the scan that was compared last
        self._said = LocalisationInfo(problem="no_map")
        self._measured = 0.0
        self._lost = False
        self._since: float | None = None  # when it began to look otherwise
        self._ending = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Compare from now on, on a thread of its own: to read the map takes a while."""
        self._thread = threading.Thread(target=self._work, name="localisation", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End the thread."""
        self._ending.set()
        if self._thread is not None:
            self._thread.join(2.0)

    def info(self) -> LocalisationInfo:
        """What was found last, and how old that is."""
        said = self._said
        if said.agreement is None:
            return said
        return said.model_copy(update={"age": max(0.0, self._now() - self._measured)})

    def update(self) -> None:
        """Compare the newest scan, if there is one that was not compared."""
        stamped = self._world.scan.get()
        problem = self._problem()
        if problem is not None or stamped is None:
            self._said = LocalisationInfo(lost=False, problem=problem or "no_scan")
            self._since = None
            return
        if stamped.version == self._compared:
            return
        self._compared = stamped.version
        scan = stamped.value
        sensor, matcher = self._world.scanned_from(scan), self._match()
        assert sensor is not None  # otherwise there is a problem
        assert matcher is not None
        agreement = matcher.agreement(_points(scan), sensor)
        if agreement is None:
            self._said = LocalisationInfo(lost=False, problem="too_little")
            self._since = None
            return
        self._judge(agreement)
        self._measured = stamped.received
        self._said = LocalisationInfo(agreement=agreement, lost=self._lost)

    def fit(self, pose: Pose, *, search: bool) -> tuple[Fit, Fit | None] | LocalisationProblem:
        """How the newest scan fits with the robot at a pose, and the best one nearby.

        Parameters
        ----------
        pose
            Of the robot, in the map frame.
        search
            Whether to look for a better one.

        Returns
        -------
        tuple or str
            There, and where it fits best; or what is missing for that.
        """
        stamped, matcher = self._world.scan.get(), self._match()
        if matcher is None:
            return "no_map"
        if stamped is None or stamped.age(self._now()) > OLD or not _says_something(stamped.value):
            return "no_scan"
        scan, world = stamped.value, self._world
        points = _points(scan)
        sensor = world.sensor_at(pose, scan)
        here = Fit(pose, sensor, scan, matcher.agreement(points, sensor))
        if not search:
            return here, None
        body = Pose(*compose(inverse(sensor), pose).tolist())
        best = Pose(*matcher.fit(points, sensor, body))
        robot = world.robot_at(best, scan)
        return here, Fit(robot, best, scan, matcher.agreement(points, best))

    def _problem(self) -> LocalisationProblem | None:
        now = self._now()
        scan, motion = self._world.scan.get(), self._world.motion.get()
        if self._world.map.get() is None:
            return "no_map"
        if scan is None or scan.age(now) > OLD or not _says_something(scan.value):
            return "no_scan"
        if motion is None or motion.age(now) > OLD:
            return "no_pose"
        return None

    def _judge(self, agreement: float) -> None:
        """Lost and found each take their time: what looks so for a moment may pass."""
        now = self._now()
        if agreement >= FOUND if self._lost else agreement < LOST:
            self._since = now if self._since is None else self._since
            if now - self._since >= (FOUND_AFTER if self._lost else LOST_AFTER):
                self._lost, self._since = not self._lost, None
        else:
            self._since = None

    def _match(self) -> ScanMatcher | None:
        stamped = self._world.map.get()
        if stamped is None:
            return None
        with self._making:
            if self._matcher is None or self._matcher[0] is not stamped.value:
                self._matcher = stamped.value, ScanMatcher(stamped.value)
            return self._matcher[1]

    def _work(self) -> None:
        while not self._ending.wait(_PERIOD):
            try:
                self.update()
            except Exception:
                # One scan that cannot be compared must not end all comparing.
                _logger.exception("a scan could not be compared with the map")


def _points(scan: Scan) -> Floats:
    """Where rays met something, in the sensor's frame; what is too near to be measured does not
    count."""
    return read_rays(*_measured(scan), (0.0, 0.0, 0.0)).ends


def _says_something(scan: Scan) -> bool:
    return not scan_fault(*_measured(scan))


def _measured(scan: Scan) -> tuple[ArrayLike, float, float, float, float]:
    return (
        scan.ranges,
        scan.angle_min,
        scan.angle_increment,
        scan.range_min,
        scan.range_max,
    )
