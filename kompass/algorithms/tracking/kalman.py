"""Where something is that moves on the floor, by places that are measured now and then.

R. E. Kalman, "A New Approach to Linear Filtering and Prediction Problems", Journal of Basic
Engineering, 1960; with the discrete model of white noise in the acceleration.
"""

from __future__ import annotations

import numpy as np

from kompass.algorithms.geometry import Floats

# Of the speed before anything is known of it [m/s].
_FIRST_SPEED = 1.0


class MovingPoint:
    """Place and velocity in the plane, the same uncertainty along both axes.

    Parameters
    ----------
    place
        (x, y) as first measured [m].
    now
        [s]
    deviation
        Standard deviation of a measured place, along each axis [m].
    acceleration
        … of its acceleration [m/s²].
    """

    def __init__(
        self, place: tuple[float, float], now: float, *, deviation: float, acceleration: float
    ) -> None:
        self._state: Floats = np.array([place, (0.0, 0.0)], dtype=np.float64)
        self._noise, self._acceleration = deviation**2, acceleration**2
        self._spread: Floats = np.diag([self._noise, _FIRST_SPEED**2])
        self._now = now

    def at(self, now: float) -> tuple[tuple[float, float], tuple[float, float]]:
        """Place [m] and velocity [m/s] at ``now`` [s], as predicted."""
        place, velocity = _step(max(0.0, now - self._now)) @ self._state
        return (float(place[0]), float(place[1])), (float(velocity[0]), float(velocity[1]))

    def measure(self, place: tuple[float, float], now: float) -> None:
        """Take in a place that was measured at ``now`` [s]."""
        dt = max(0.0, now - self._now)
        move = _step(dt)
        half = np.array([dt * dt / 2.0, dt])
        state = move @ self._state
        spread = move @ self._spread @ move.T + self._acceleration * np.outer(half, half)
        gain = spread[:, 0] / (spread[0, 0] + self._noise)
        self._state = state + np.outer(gain, np.array(place) - state[0])
        self._spread = spread - np.outer(gain, spread[0])
        self._now = max(self._now, now)


def _step(dt: float) -> Floats:
    return np.array([[1.0, dt], [0.0, 1.0]])
