"""Parts of the robot that behave as broken ones do. Each stands in front of a sound one.

``sound`` is the part behind, which may itself be a broken one; it is exchanged when another fault
ends, and what this one remembers stays.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kompass.simulation.physics.motion import BodyMotion
from kompass.simulation.physics.parts import (
    NoReading,
    Odometer,
    PoseSource,
    PowerSource,
    RangeFinder,
    WheelDrive,
)
from kompass.simulation.physics.robot_model import LidarModel

LOW_CHARGE = 0.12
_ROUNDING = 1e-6  # s; times of readings are sums of many periods


class UnpluggedLidar:
    """Says nothing."""

    age = 0.0

    def __init__(self, sound: RangeFinder) -> None:
        self.sound = sound

    def scan(self) -> NDArray[np.float32]:
        raise NoReading("the lidar is unplugged")


class FrozenLidar:
    """Repeats its first scan for ever, as a driver does whose buffer is never refilled."""

    age = 0.0

    def __init__(self, sound: RangeFinder) -> None:
        self.sound = sound
        self._first: NDArray[np.float32] | None = None

    def scan(self) -> NDArray[np.float32]:
        if self._first is None:
            self._first = self.sound.scan()
        return self._first.copy()


class SlowLidar:
    """Leaves out every other scan."""

    def __init__(self, sound: RangeFinder) -> None:
        self.sound = sound
        self._turns = 0

    @property
    def age(self) -> float:
        return self.sound.age

    def scan(self) -> NDArray[np.float32]:
        self._turns += 1
        if self._turns % 2 == 0:
            raise NoReading("every other scan is left out")
        return self.sound.scan()


class NoisyLidar:
    """Scatters the ranges of what is within reach.

    Parameters
    ----------
    sound
        The lidar behind.
    deviation
        Standard deviation, metres.
    random
        Source of the noise.
    kind
        Of the lidar behind.
    """

    def __init__(
        self,
        sound: RangeFinder,
        deviation: float,
        random: np.random.Generator,
        kind: LidarModel,
    ) -> None:
        self.sound = sound
        self._kind = kind
        self._deviation = deviation
        self._random = random

    @property
    def age(self) -> float:
        return self.sound.age

    def scan(self) -> NDArray[np.float32]:
        sound = self.sound.scan()
        ranges = np.maximum(
            sound + self._random.normal(0.0, self._deviation, len(sound)), self._kind.saturated
        )
        ranges[ranges > self._kind.range_max] = np.inf
        return ranges.astype(np.float32)


class LateLidar:
    """Hands out each scan some time after it was measured, and nothing until the first is due.

    Parameters
    ----------
    sound
        The lidar behind.
    delay
        Seconds.
    time
        Tells the simulated seconds.
    """

    def __init__(self, sound: RangeFinder, delay: float, time: Callable[[], float]) -> None:
        self.sound = sound
        self.age = 0.0
        self._delay = delay
        self._time = time
        self._waiting = deque[tuple[float, float, NDArray[np.float32]]]()

    def scan(self) -> NDArray[np.float32]:
        now = self._time()
        with suppress(NoReading):  # a gap then is a gap later
            ranges = self.sound.scan()
            self._waiting.append((now, self.sound.age, ranges))
        due = None
        while self._waiting and self._waiting[0][0] + self._delay <= now + _ROUNDING:
            due = self._waiting.popleft()
        if due is None:
            raise NoReading("the next scan is still on its way")
        measured, age, ranges = due
        self.age = age + now - measured
        return ranges


class FrozenLocalizer:
    """Repeats one pose. The sound one behind it goes on, so that the end of the fault is a jump."""

    def __init__(self, sound: PoseSource) -> None:
        self.sound = sound
        self._kept = _reading(sound)

    def update(self, truth: BodyMotion) -> None:
        self.sound.update(truth)

    def relocate(self, pose: tuple[float, float, float]) -> None:
        self.sound.relocate(pose)

    def read(self) -> BodyMotion:
        if self._kept is None:
            self._kept = self.sound.read()
        return self._kept


class FrozenOdometry:
    """Repeats one pose of the wheels; see ``FrozenLocalizer``."""

    def __init__(self, sound: Odometer) -> None:
        self.sound = sound
        self._kept = _reading(sound)

    def update(
        self, left_angle: float, right_angle: float, dt: float, rear_angle: float = 0.0
    ) -> None:
        self.sound.update(left_angle, right_angle, dt, rear_angle)

    def read(self) -> BodyMotion:
        if self._kept is None:
            self._kept = self.sound.read()
        return self._kept


class SilentLocalizer:
    """Says nothing, and works on behind."""

    def __init__(self, sound: PoseSource) -> None:
        self.sound = sound

    def update(self, truth: BodyMotion) -> None:
        self.sound.update(truth)

    def relocate(self, pose: tuple[float, float, float]) -> None:
        self.sound.relocate(pose)

    def read(self) -> BodyMotion:
        raise NoReading("the localizer is silent")


class SilentOdometry:
    """Says nothing, and works on behind."""

    def __init__(self, sound: Odometer) -> None:
        self.sound = sound

    def update(
        self, left_angle: float, right_angle: float, dt: float, rear_angle: float = 0.0
    ) -> None:
        self.sound.update(left_angle, right_angle, dt, rear_angle)

    def read(self) -> BodyMotion:
        raise NoReading("the wheels' encoders are silent")


class LateLocalizer:
    """Hands out each reading some time after it was taken; see ``LateLidar``."""

    def __init__(self, sound: PoseSource, delay: float, time: Callable[[], float]) -> None:
        self.sound = sound
        self._line = _DelayLine(delay, time)

    def update(self, truth: BodyMotion) -> None:
        self.sound.update(truth)
        self._line.take(self.sound)

    def relocate(self, pose: tuple[float, float, float]) -> None:
        self.sound.relocate(pose)

    def read(self) -> BodyMotion:
        return self._line.read()


class LateOdometry:
    """Hands out each reading some time after it was taken; see ``LateLidar``."""

    def __init__(self, sound: Odometer, delay: float, time: Callable[[], float]) -> None:
        self.sound = sound
        self._line = _DelayLine(delay, time)

    def update(
        self, left_angle: float, right_angle: float, dt: float, rear_angle: float = 0.0
    ) -> None:
        self.sound.update(left_angle, right_angle, dt, rear_angle)
        self._line.take(self.sound)

    def read(self) -> BodyMotion:
        return self._line.read()


class JumpedLocalizer:
    """Has lost its place once: its pose is off by the same in ``map`` until it is told where it is.

    Parameters
    ----------
    sound
        The localizer behind.
    offset
        (x, y, yaw) in metres and radians.
    """

    def __init__(self, sound: PoseSource, offset: tuple[float, float, float]) -> None:
        self.sound = sound
        self._offset = offset

    def update(self, truth: BodyMotion) -> None:
        self.sound.update(truth)

    def relocate(self, pose: tuple[float, float, float]) -> None:
        self._offset = _from(self.sound.read(), pose)

    def read(self) -> BodyMotion:
        return _shifted(self.sound.read(), self._offset)


class DriftingLocalizer:
    """Is off by more with every metre that the robot moves, always in one direction of ``map``.

    Who tells it where it is corrects what has come together, and not what is to come.

    Parameters
    ----------
    sound
        The localizer behind.
    rate
        Metres per metre moved.
    direction
        In ``map``, radians.
    """

    def __init__(self, sound: PoseSource, rate: float, direction: float) -> None:
        self.sound = sound
        self._drift = (rate * math.cos(direction), rate * math.sin(direction))
        self._last: tuple[float, float] | None = None
        self._moved = 0.0
        self._offset = (0.0, 0.0, 0.0)

    def update(self, truth: BodyMotion) -> None:
        place = truth.pose[:2]
        if self._last is not None:
            self._moved += math.dist(self._last, place)
        self._last = place
        self.sound.update(truth)

    def relocate(self, pose: tuple[float, float, float]) -> None:
        self._offset = _from(self._drifted(), pose)

    def read(self) -> BodyMotion:
        return _shifted(self._drifted(), self._offset)

    def _drifted(self) -> BodyMotion:
        x, y = self._drift
        return _shifted(self.sound.read(), (x * self._moved, y * self._moved, 0.0))


class BlockedWheelDrive:
    """The left motor holds its wheel still."""

    def __init__(self, sound: WheelDrive) -> None:
        self.sound = sound

    def command(self, v: float, omega: float, now: float, vy: float = 0.0) -> None:
        self.sound.command(v, omega, now, vy)

    def wheel_speeds(self, now: float) -> tuple[float, ...]:
        return 0.0, *self.sound.wheel_speeds(now)[1:]


class SlippingDrive:
    """Its wheels move the robot by less than they turn; the encoders are the robot's matter.

    Parameters
    ----------
    sound
        The drive behind.
    grip
        Which share of the turning of (left, right) is left.
    """

    def __init__(self, sound: WheelDrive, grip: tuple[float, float]) -> None:
        self.sound = sound
        self._grip = grip

    def command(self, v: float, omega: float, now: float, vy: float = 0.0) -> None:
        self.sound.command(v, omega, now, vy)

    def wheel_speeds(self, now: float) -> tuple[float, ...]:
        left, right, *others = self.sound.wheel_speeds(now)
        return self._grip[0] * left, self._grip[1] * right, *others


class LowBattery:
    """Has little left and cannot be charged, as one whose charger fails."""

    charging = False

    def __init__(self, sound: PowerSource) -> None:
        self.sound = sound

    @property
    def charge(self) -> float:
        return min(LOW_CHARGE, self.sound.charge)

    def step(self, at: tuple[float, float], seconds: float) -> None:
        self.sound.step(at, seconds)


class _DelayLine:
    """Readings that are on their way."""

    def __init__(self, delay: float, time: Callable[[], float]) -> None:
        self._delay = delay
        self._time = time
        self._waiting = deque[tuple[float, BodyMotion | None]]()
        self._newest: tuple[float, BodyMotion | None] = (0.0, None)

    def take(self, source: PoseSource | Odometer) -> None:
        self._waiting.append((self._time(), _reading(source)))

    def read(self) -> BodyMotion:
        now = self._time()
        while self._waiting and self._waiting[0][0] + self._delay <= now + _ROUNDING:
            self._newest = self._waiting.popleft()
        measured, motion = self._newest
        if motion is None:
            raise NoReading("the next reading is still on its way, or there was none then")
        return replace(motion, age=motion.age + now - measured)


def _reading(source: PoseSource | Odometer) -> BodyMotion | None:
    """The reading that there is now; None from a source that is silent."""
    try:
        return source.read()
    except NoReading:
        return None


def _shifted(motion: BodyMotion, offset: tuple[float, float, float]) -> BodyMotion:
    x, y, yaw = motion.pose
    dx, dy, turn = offset
    return replace(motion, pose=(x + dx, y + dy, math.remainder(yaw + turn, math.tau)))


def _from(motion: BodyMotion, pose: tuple[float, float, float]) -> tuple[float, float, float]:
    """What shifts a motion to a pose."""
    x, y, yaw = motion.pose
    return pose[0] - x, pose[1] - y, pose[2] - yaw
