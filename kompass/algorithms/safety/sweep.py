"""When a body that keeps its velocity touches what stands around it: exactly, for any outline."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats

_STRAIGHT = 1e-6  # rad/s below which a motion has no curve
_STILL = 1e-9  # m/s at which a side comes no nearer


def time_to_contact(
    footprint: Footprint, points: ArrayLike, v: float, vy: float, omega: float
) -> Floats:
    """Seconds (N,) until the body touches each point, if it keeps its twist; inf for never.

    What lies within the body already counts as touched at once where the nearest side moves on to
    it, and never where that side moves away from it.

    Parameters
    ----------
    footprint
        The body.
    points
        (N, 2) in the base frame [m].
    v, vy
        Velocity ahead and to the left [m/s].
    omega
        Turning left [rad/s].
    """
    given = np.asarray(points, dtype=np.float64).reshape(-1, 2)
    corners = footprint.corners
    side = np.roll(corners, -1, axis=0) - corners
    normal = np.column_stack([side[:, 1], -side[:, 0]]) / np.hypot(*side.T)[:, None]
    # How far (N, E) each point lies outside of each side's line.
    out = given @ normal.T - (corners * normal).sum(axis=1)
    inside = (out <= 0.0).all(axis=1)
    if abs(omega) < _STRAIGHT:
        after = _along_a_line(out, normal, v, vy)
    else:
        after = _round_a_centre(given, corners, side, v, vy, omega)
    nearest = normal[np.argmax(out, axis=1)]
    towards = nearest[:, 0] * (v - omega * given[:, 1]) + nearest[:, 1] * (vy + omega * given[:, 0])
    after[inside] = np.where(towards[inside] > 0.0, 0.0, math.inf)
    return after


def _along_a_line(out: Floats, normal: Floats, v: float, vy: float) -> Floats:
    """Clips the way of each point, as seen from the body, with all of the body's sides."""
    closing = normal @ np.array([v, vy])
    enter = np.zeros(len(out))
    leave = np.full(len(out), math.inf)
    for index, speed in enumerate(closing.tolist()):
        if speed > _STILL:
            np.maximum(enter, out[:, index] / speed, out=enter)
        elif speed < -_STILL:
            np.minimum(leave, out[:, index] / speed, out=leave)
        else:
            leave[out[:, index] > 0.0] = -math.inf
    return np.where(enter <= leave, enter, math.inf)


def _round_a_centre(
    points: Floats, corners: Floats, side: Floats, v: float, vy: float, omega: float
) -> Floats:
    """As seen from the body each point goes round the centre of turning; where it meets a side."""
    centre = np.array([-vy, v]) / omega
    away = points - centre
    radius = np.hypot(away[:, 0], away[:, 1])
    begin = np.arctan2(away[:, 1], away[:, 0])
    to_corner = corners - centre
    # |to_corner + t * side| = radius, for 0 <= t <= 1.
    a = (side * side).sum(axis=1)
    b = (to_corner * side).sum(axis=1)
    c = (to_corner * to_corner).sum(axis=1)[None, :] - (radius * radius)[:, None]
    under = b * b - a * c
    meets: NDArray[np.bool_] = under >= 0.0
    root = np.sqrt(np.where(meets, under, 0.0))
    turn = np.full(len(points), math.inf)
    for sign in (-1.0, 1.0):
        t = (sign * root - b) / a
        x = to_corner[:, 0] + t * side[:, 0]
        y = to_corner[:, 1] + t * side[:, 1]
        swept = np.mod(math.copysign(1.0, omega) * (begin[:, None] - np.arctan2(y, x)), math.tau)
        hit = meets & (t >= 0.0) & (t <= 1.0)
        np.minimum(turn, np.where(hit, swept, math.inf).min(axis=1), out=turn)
    return turn / abs(omega)
