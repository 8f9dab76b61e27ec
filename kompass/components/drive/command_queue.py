"""Commands waiting to be sent to the wheels, and for how long they hold."""

import math
from dataclasses import dataclass, field

from kompass_interfaces.msg import TwistArray

Twist2D = tuple[float, float, float]
STILL: Twist2D = (0.0, 0.0, 0.0)
LONGEST = 10.0  # s that a list may hold; who says no more is not obeyed for longer


@dataclass
class CommandQueue:
    """The newest list of commands; a new one replaces the old. Time is an argument [s]."""

    timeout: float
    _commands: list[Twist2D] = field(default_factory=list)
    _time_step: float = 0.0
    _began: float = -float("inf")

    def put(self, commands: list[Twist2D], time_step: float, now: float) -> None:
        """Carry out ``commands`` (vx, vy, omega) from now on, each for ``time_step`` seconds.

        Raises
        ------
        ValueError
            They are no finite numbers, or would hold for too long. What was there before is gone.
        """
        self.clear()
        if not all(math.isfinite(value) for command in commands for value in command):
            raise ValueError("its velocities are no finite numbers; send numbers")
        if not 0.0 <= time_step * len(commands) <= LONGEST:
            raise ValueError(
                f"time_step = {time_step:g} s for {len(commands)} commands; send lists that last "
                f"from 0 to {LONGEST:g} s"
            )
        self._commands, self._time_step, self._began = commands, time_step, now

    def put_array(self, message: TwistArray, now: float) -> None:
        """As :meth:`put`, from a TwistArray; lists of different lengths are filled with zeros.

        Raises
        ------
        ValueError
            As :meth:`put`.
        """
        linear, angular = message.linear_velocities, message.angular_velocities
        count = max(len(linear.x), len(linear.y), len(angular.z))
        columns = [
            [*column, *[0.0] * (count - len(column))] for column in (linear.x, linear.y, angular.z)
        ]
        self.put(list(zip(*columns, strict=True)), message.time_step, now)

    def clear(self) -> None:
        """Forget all commands."""
        self._commands = []

    def current(self, now: float) -> Twist2D | None:
        """The command for now: None when there is none; the last one holds for ``timeout``."""
        if not self._commands or self.is_stale(now):
            return None
        if self._time_step <= 0:
            return self._commands[0]
        index = int((now - self._began) / self._time_step)
        return self._commands[min(index, len(self._commands) - 1)]

    def is_stale(self, now: float) -> bool:
        """Whether a motion was commanded and nobody renewed it in time."""
        if not self._commands:
            return False
        end = self._began + len(self._commands) * self._time_step
        return now > end + self.timeout and self._commands[-1] != STILL
