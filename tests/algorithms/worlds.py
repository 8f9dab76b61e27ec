"""Maps, paths and a kinematic robot for the tests of the algorithms."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.geometry import Floats, wrap_angle
from kompass.algorithms.grid import Grid


def empty(size: float = 10.0, resolution: float = 0.05, border: bool = True) -> Grid:
    n = round(size / resolution)
    cells = np.zeros((n, n), dtype=np.int8)
    if border:
        cells[[0, -1], :] = 100
        cells[:, [0, -1]] = 100
    return Grid(cells, resolution)


def hexagon(resolution: float = 0.05) -> Grid:
    """A hexagonal room around (0, 0) with nine pillars in three rows of three."""
    n = round(6.0 / resolution)
    centre = (np.arange(n) + 0.5) * resolution - 3.0
    x, y = np.meshgrid(centre, centre)
    cells = np.full((n, n), 100, dtype=np.int8)
    inside = np.ones((n, n), dtype=bool)
    for k in range(6):
        angle = math.radians(30 + 60 * k)
        inside &= x * math.cos(angle) + y * math.sin(angle) < 2.4
    cells[inside] = 0
    for px in (-1.1, 0.0, 1.1):
        for py in (-1.1, 0.0, 1.1):
            cells[np.hypot(x - px, y - py) <= 0.15] = 100
    return Grid(cells, resolution, (-3.0, -3.0, 0.0))


def walls() -> Grid:
    """200 × 200 cells of 5 cm with three walls that must be passed in turn."""
    cells = np.zeros((200, 200), dtype=np.int8)
    cells[50:52, :150] = 100
    cells[100:102, 50:] = 100
    cells[150:152, :150] = 100
    return Grid(cells, 0.05)


def brute_force_distance(occupied: NDArray[np.bool_], resolution: float, points: Floats) -> Floats:
    """Distance from points (N, 2) to the nearest occupied square, one square after another."""
    rows, cols = np.nonzero(occupied)
    best = np.full(len(points), np.inf)
    for row, col in zip(rows.tolist(), cols.tolist(), strict=True):
        low = np.array([col, row]) * resolution
        gap = np.maximum(np.maximum(low - points, points - low - resolution), 0.0)
        best = np.minimum(best, np.hypot(gap[:, 0], gap[:, 1]))
    return best


def polyline(*corners: tuple[float, float], spacing: float = 0.1) -> Floats:
    """Poses (N, 3) along straight legs; the last yaw is that of the last leg."""
    points = [np.array(corners[0], dtype=np.float64)[None]]
    for a, b in pairwise(corners):
        n = max(1, round(math.dist(a, b) / spacing))
        points.append(
            np.array(a) + (np.array(b) - np.array(a)) * (np.arange(1, n + 1) / n)[:, None]
        )
    return with_yaw(np.concatenate(points))


def curve(f: Callable[[Floats], tuple[Floats, Floats]], n: int = 400) -> Floats:
    """Poses (n, 3) along ``f(t) -> (x, y)``, t from 0 to 1."""
    x, y = f(np.linspace(0.0, 1.0, n))
    return with_yaw(np.column_stack([x, y]))


def with_yaw(points: Floats) -> Floats:
    delta = np.diff(points, axis=0)
    yaw = np.arctan2(delta[:, 1], delta[:, 0])
    return np.column_stack([points, np.append(yaw, yaw[-1])])


U = polyline((0, 0), (3, 0), (3, 1), (0, 1))
L = polyline((0, 0), (2, 0), (2, 2))
STRAIGHT = polyline((0, 0), (5, 0))
SINE = curve(lambda t: (6 * t, 0.5 * np.sin(6 * t * 1.2)))
CIRCLE = curve(lambda t: (np.sin(2 * np.pi * t), 1 - np.cos(2 * np.pi * t)))
EIGHT = curve(lambda t: (1.5 * np.sin(2 * np.pi * t), np.sin(4 * np.pi * t)))
HAIRPIN = polyline((0, 0), (2, 0), (0, 0))
PATHS = {
    "straight": STRAIGHT,
    "sine": SINE,
    "L": L,
    "U": U,
    "circle": CIRCLE,
    "figure 8": EIGHT,
    "hairpin": HAIRPIN,
}


def distance_to_polyline(points: Floats, path: Floats) -> Floats:
    """Distance (N,) of points (N, 2) from the polyline through path (M, ≥ 2)."""
    a, b = path[:-1, :2], path[1:, :2]
    d = b - a
    length2 = np.maximum((d**2).sum(axis=1), 1e-18)
    t = np.clip(((points[:, None] - a) * d).sum(axis=2) / length2, 0.0, 1.0)
    to_legs = points[:, None] - (a + t[..., None] * d)
    nearest: Floats = np.linalg.norm(to_legs, axis=2).min(axis=1)
    return nearest


@dataclass
class Run:
    """What happened in a closed loop."""

    arrived: bool
    duration: float
    poses: Floats
    commands: Floats
    steps: list[Any] = field(repr=False)

    def error_to(self, pose: Floats) -> tuple[float, float]:
        last = self.poses[-1]
        return math.dist(last[:2], pose[:2]), abs(wrap_angle(float(last[2] - pose[2])))


def drive(
    follower: Any,
    pose: tuple[float, float, float],
    *,
    dt: float = 0.1,
    limit: float = 200.0,
    lag: float = 0.05,
    points: Callable[[Floats], Floats] | None = None,
    at_step: Callable[[int, Floats], None] | None = None,
) -> Run:
    """A unicycle that takes up commands with a first-order lag, integrated at 100 Hz."""
    x, y, yaw = pose
    v = omega = 0.0
    poses, commands, steps = [(x, y, yaw)], [], []
    arrived = False
    n = 0
    while not arrived and n * dt < limit:
        here = np.array([x, y, yaw])
        if at_step is not None:
            at_step(n, here)
        extra = () if points is None else (points(here),)
        step = follower.step((x, y, yaw), v, omega, dt, *extra)
        steps.append(step)
        commands.append((step.command.vx, step.command.omega))
        h = 0.01
        for _ in range(round(dt / h)):
            v += (step.command.vx - v) * min(1.0, h / lag)
            omega += (step.command.omega - omega) * min(1.0, h / lag)
            x += v * math.cos(yaw + omega * h / 2) * h
            y += v * math.sin(yaw + omega * h / 2) * h
            yaw = wrap_angle(yaw + omega * h)
        poses.append((x, y, yaw))
        arrived = step.phase == "arrived"
        n += 1
    return Run(arrived, n * dt, np.array(poses), np.array(commands), steps)
