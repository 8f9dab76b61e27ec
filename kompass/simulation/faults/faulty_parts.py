"""Parts of the robot that behave as broken ones do. Each stands in front of the sound one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kompass.simulation.physics.motion import BodyMotion
from kompass.simulation.physics.parts import (
    NoReading,
    Odometer,
    PoseSource,
    RangeFinder,
    WheelDrive,
)


class UnpluggedLidar:
    """Says nothing."""

    def scan(self) -> NDArray[np.float32]:
        raise NoReading("the lidar is unplugged")


class FrozenLidar:
    """Repeats its first scan for ever, as a driver does whose buffer is never refilled."""

    def __init__(self, sound: RangeFinder) -> None:
        self._sound = sound
        self._first: NDArray[np.float32] | None = None

    def scan(self) -> NDArray[np.float32]:
        if self._first is None:
            self._first = self._sound.scan()
        return self._first.copy()


class SlowLidar:
    """Leaves out every other scan."""

    def __init__(self, sound: RangeFinder) -> None:
        self._sound = sound
        self._turns = 0

    def scan(self) -> NDArray[np.float32]:
        self._turns += 1
        if self._turns % 2 == 0:
            raise NoReading("every other scan is left out")
        return self._sound.scan()


class FrozenLocalizer:
    """Repeats one pose. The sound one behind it goes on, so that the end of the fault is a jump."""

    def __init__(self, sound: PoseSource) -> None:
        self._sound = sound
        self._kept = sound.read()

    def update(self, truth: BodyMotion) -> None:
        self._sound.update(truth)

    def read(self) -> BodyMotion:
        return self._kept


class FrozenOdometry:
    """Repeats one pose of the wheels; see ``FrozenLocalizer``."""

    def __init__(self, sound: Odometer) -> None:
        self._sound = sound
        self._kept = sound.read()

    def update(self, left_angle: float, right_angle: float, dt: float) -> None:
        self._sound.update(left_angle, right_angle, dt)

    def read(self) -> BodyMotion:
        return self._kept


class SilentLocalizer:
    """Says nothing, and works on behind."""

    def __init__(self, sound: PoseSource) -> None:
        self._sound = sound

    def update(self, truth: BodyMotion) -> None:
        self._sound.update(truth)

    def read(self) -> BodyMotion:
        raise NoReading("the localizer is silent")


class SilentOdometry:
    """Says nothing, and works on behind."""

    def __init__(self, sound: Odometer) -> None:
        self._sound = sound

    def update(self, left_angle: float, right_angle: float, dt: float) -> None:
        self._sound.update(left_angle, right_angle, dt)

    def read(self) -> BodyMotion:
        raise NoReading("the wheels' encoders are silent")


class BlockedWheelDrive:
    """The left motor holds its wheel still."""

    def __init__(self, sound: WheelDrive) -> None:
        self._sound = sound

    def command(self, v: float, omega: float, now: float) -> None:
        self._sound.command(v, omega, now)

    def wheel_speeds(self, now: float) -> tuple[float, float]:
        return 0.0, self._sound.wheel_speeds(now)[1]
