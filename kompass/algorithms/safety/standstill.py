"""Does the robot stand still? Measured, not concluded from a command."""

LINEAR = 0.01  # m/s
ANGULAR = 0.03  # rad/s
DURATION = 0.3  # s


class Standstill:
    """True once the measured speed has been next to zero for a while. Time is an argument [s]."""

    def __init__(self) -> None:
        self._since: float | None = None
        self._last: float | None = None

    def update(self, speed: tuple[float, float, float], now: float) -> None:
        """Take in a measurement (vx, vy, omega) [m/s, m/s, rad/s]."""
        vx, vy, omega = speed
        self._last = now
        if abs(vx) < LINEAR and abs(vy) < LINEAR and abs(omega) < ANGULAR:
            self._since = now if self._since is None else self._since
        else:
            self._since = None

    def reached(self, now: float, newest_allowed: float) -> bool:
        """Whether it stands still; unknown, so False, without a measurement of that age [s]."""
        if self._since is None or self._last is None or now - self._last > newest_allowed:
            return False
        return self._last - self._since >= DURATION
