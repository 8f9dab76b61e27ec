"""One of the sensors that the drive manager sees with, and whether it can be relied on."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2

from kompass.algorithms.geometry import inverse, transform_points
from kompass.algorithms.mapping.cloud_memory import CloudMemory
from kompass.algorithms.mapping.cloud_view import CloudView
from kompass.algorithms.mapping.scan_points import PlacedScan
from kompass.algorithms.safety.frozen_scan import FrozenScan
from kompass.algorithms.safety.rhythm import Rhythm
from kompass.algorithms.transforms import TransformError
from kompass.components.base.location_source import LocationSource
from kompass.components.base.ports import Input
from kompass.components.base.seen import cloud_memory, read_seen, stamp_of
from kompass.components.drive.config import DriveManagerConfig
from kompass.components.drive.manoeuvre import looked_at
from kompass.printable import printable

Points = NDArray[np.float64]


class SensorWatch:
    """Keeps what one sensor has shown last, scan or cloud, with its own rhythm and its own faults.

    Parameters
    ----------
    source
        Gives the input as it is now.
    location
        Gives where the robot is, and where its sensors are, once it is active.
    config
        Gives the settings as they are now.
    """

    def __init__(
        self,
        source: Callable[[], Input],
        location: Callable[[], LocationSource],
        config: Callable[[], DriveManagerConfig],
    ) -> None:
        self._source, self._location, self._config = source, location, config
        self.rhythm = Rhythm()
        self.has_served = False  # since the activation
        self._repeats = FrozenScan()
        self._memory: CloudMemory | None = None
        self._points: Points = np.empty((0, 2))
        self._points_of: object = None
        self._scan: PlacedScan | None = None  # that was read last
        self._fault = ""  # of the newest message

    @property
    def source(self) -> Input:
        """The input."""
        return self._source()

    def forget_settings(self) -> None:
        """Read the next message by other settings."""
        self._memory, self._points_of = None, None

    def hear(self, message: Any, now: float) -> None:
        """Note that a message has come."""
        self.rhythm.heard(now)
        if not isinstance(message, PointCloud2):
            self._repeats.heard(np.asarray(message.ranges), self._location().pose())

    def points(self, now: float, warn: Callable[[str], None]) -> Points | None:
        """What is in the way, (N, 2) in the robot's frame [m]; None when unknown."""
        source, message = self.source, self.source.message
        if message is None or source.age() > self._config().scan_timeout:
            return None
        if message is not self._points_of:
            try:
                self._read(message, now)
            except TransformError as error:
                warn(f"the {self._what(message)} cannot be placed on the robot: {error}")
                self._fault = printable(str(error))
                return None
            except ValueError as error:
                self._fault = str(error)
                return None
            self._fault = ""
            self._points_of, self.has_served = message, True
        if self._repeats.is_frozen:
            return None
        # It has moved on since: at 1 m/s by the braking distance of half a period of the scanner.
        moved = self._location().moved_since(stamp_of(message))
        points = transform_points(inverse(moved), self._points)
        return points if self._memory is None else self._with_remembered(points, now)

    def looked_at(self, direction: float, width: float) -> bool:
        """Whether the scan that was read last has measured all of a sector; a cloud never has.

        Parameters
        ----------
        direction, width
            Middle of the sector, and how far it reaches to either side [rad].
        """
        scan = self._scan
        if scan is None:
            return False
        rays = np.arange(len(scan.ranges), dtype=np.float64)
        bearings = scan.sensor[2] + scan.angle_min + scan.angle_increment * rays
        return looked_at(scan.ranges, bearings, direction, width)

    def missing(self, name: str) -> str:
        """Why it is of no use, for people.

        Parameters
        ----------
        name
            Of the topic, where it is one of several; else empty.
        """
        source, what = self.source, self._what(self.source.message)
        on = f" on {name}" if name else ""
        if source.age() > self._config().scan_timeout:
            if not source.comes_late:
                return f"no {what}{on} {told_for(source.silence())}"
            return f"the {what}{on} is too old: {source.lateness.told}"
        if self._fault:
            return f"the {what}{on} cannot be used: {self._fault}"
        if self._repeats.is_frozen:
            text = "stays the same to the last bit while the robot moves: it is frozen"
            return f"the {what}{on} {text}"
        return f"no {what}{on} that can be used"

    def _read(self, message: Any, now: float) -> None:
        location, config = self._location(), self._config()
        seen = read_seen(message, location, config)
        self._points = seen.points
        self._scan = None if isinstance(seen, CloudView) else seen
        if not isinstance(seen, CloudView):
            self._memory = None
            return
        pose = location.pose_at(stamp_of(message))
        # One that sees nothing in its way is not told from one that is frozen, and does no harm.
        self._repeats.heard(seen.points, pose)
        if self._memory is None:
            self._memory = cloud_memory(config)
        if pose is not None:
            self._memory.see(seen, pose, now)

    def _with_remembered(self, points: Points, now: float) -> Points:
        """With what the cloud has shown near the robot, and its sensor does not see any more."""
        pose = self._location().pose()
        if self._memory is None or pose is None:
            return points
        remembered = transform_points(inverse(pose), self._memory.points(now))
        return np.concatenate([points, remembered])

    @staticmethod
    def _what(message: Any) -> str:
        return "point cloud" if isinstance(message, PointCloud2) else "scan"


def told_for(age: float) -> str:
    """How long nothing has come [s], for people."""
    # Coarse on purpose: a sentence that changes ten times a second cannot be read.
    return "yet" if age == float("inf") else f"for {age:.0f} s" if age >= 1 else "any more"
