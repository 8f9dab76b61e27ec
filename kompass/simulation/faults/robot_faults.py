"""Faults of the robot itself: broken parts, and walls that were not there."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from kompass.simulation.faults import faulty_parts as faulty
from kompass.simulation.physics.barriers import ACROSS, BOX
from kompass.simulation.robot import SimulatedRobot

ReplaceParts = Callable[[SimulatedRobot], None]


def _lidar_unplugged(robot: SimulatedRobot) -> None:
    robot.lidar = faulty.UnpluggedLidar()


def _scan_frozen(robot: SimulatedRobot) -> None:
    robot.lidar = faulty.FrozenLidar(robot.lidar)


def _scan_rate_halved(robot: SimulatedRobot) -> None:
    robot.lidar = faulty.SlowLidar(robot.lidar)


def _odometry_frozen(robot: SimulatedRobot) -> None:
    robot.localizer = faulty.FrozenLocalizer(robot.localizer)
    robot.wheels = faulty.FrozenOdometry(robot.wheels)


def _odometry_silent(robot: SimulatedRobot) -> None:
    robot.localizer = faulty.SilentLocalizer(robot.localizer)
    robot.wheels = faulty.SilentOdometry(robot.wheels)


def _wheel_blocked(robot: SimulatedRobot) -> None:
    robot.drive = faulty.BlockedWheelDrive(robot.drive)


_PARTS: dict[str, ReplaceParts] = {
    "lidar_unplugged": _lidar_unplugged,
    "scan_frozen": _scan_frozen,
    "scan_rate_halved": _scan_rate_halved,
    "odometry_frozen": _odometry_frozen,
    "odometry_silent": _odometry_silent,
    "wheel_blocked": _wheel_blocked,
}
_WALLS = {"way_blocked": ACROSS, "boxed_in": BOX}
ROBOT_FAULTS = (*_PARTS, *_WALLS)


class RobotFaults:
    """Breaks and repairs one robot. Faults may overlap and end in any order.

    Parameters
    ----------
    robot
        As it was built; its parts are taken for sound.
    """

    def __init__(self, robot: SimulatedRobot) -> None:
        self._robot = robot
        self._sound = (robot.drive, robot.lidar, robot.localizer, robot.wheels)
        self._active: list[str] = []

    @property
    def active(self) -> tuple[str, ...]:
        """Faults that are on, in the order in which they came."""
        return tuple(self._active)

    def knows(self, name: str) -> bool:
        """Whether it is one of ``ROBOT_FAULTS``."""
        return name in ROBOT_FAULTS

    def begin(self, name: str) -> bool:
        """Switch one of ``ROBOT_FAULTS`` on; nothing happens when it is."""
        if name not in self._active:
            self._active.append(name)
            if name in _WALLS:
                self._robot.put_up(_WALLS[name])
            else:
                _PARTS[name](self._robot)
        return True

    def end(self, name: str) -> None:
        """Switch it off; the robot is then as if it had never been on."""
        if name not in self._active:
            return
        self._active.remove(name)
        if name in _WALLS:
            self._robot.take_down(_WALLS[name])
            return
        robot = self._robot
        robot.drive, robot.lidar, robot.localizer, robot.wheels = self._sound
        for other in self._active:
            if other in _PARTS:
                _PARTS[other](robot)

    def ended(self) -> Iterable[str]:
        """None of them ends by itself."""
        return ()
