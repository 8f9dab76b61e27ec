"""Small shapes the layers share: vertices float32 (V, 3) in m, triangles uint32 (F, 3)."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from kompass_console.schema.world import Pose

Vertices = npt.NDArray[np.float32]
Faces = npt.NDArray[np.uint32]


def prism(outline: npt.NDArray[np.float64], low: float, high: float) -> tuple[Vertices, Faces]:
    """Solid over a convex outline (N, 2), counter-clockwise, from z `low` to `high`; no bottom."""
    n = len(outline)
    corner = np.arange(n)
    following = (corner + 1) % n
    top = np.column_stack([outline, np.full(n, high)])
    side_low = np.column_stack([outline, np.full(n, low)])
    vertices = np.concatenate([top, top, side_low])
    cap = np.column_stack([np.zeros(n - 2, int), np.arange(1, n - 1), np.arange(2, n)])
    sides_a = np.column_stack([2 * n + corner, 2 * n + following, n + following])
    sides_b = np.column_stack([2 * n + corner, n + following, n + corner])
    return vertices.astype(np.float32), np.concatenate([cap, sides_a, sides_b]).astype(np.uint32)


def circle(radius: float, segments: int = 40) -> npt.NDArray[np.float64]:
    """Points (N, 2) of a circle, counter-clockwise from +x."""
    angles = np.linspace(0.0, 2.0 * math.pi, segments, endpoint=False)
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def closed_segments(points: npt.NDArray[np.float64], z: float) -> Vertices:
    """Line segments (N, 2, 3) around a closed outline (N, 2)."""
    return open_segments(np.concatenate([points, points[:1]]), z)


def open_segments(points: npt.NDArray[np.float64], z: float) -> Vertices:
    """Line segments (N - 1, 2, 3) along a line (N, 2)."""
    lifted = np.column_stack([points, np.full(len(points), z)])
    return np.stack([lifted[:-1], lifted[1:]], axis=1).astype(np.float32)


def flat_arrow(length: float, width: float, z: float) -> tuple[Vertices, Faces]:
    """Arrow lying on the floor from the origin along +x; the head is a third of its length."""
    head = length / 3.0
    shaft = length - head
    half, thin = width / 2.0, width / 6.0
    outline = [(0, -thin), (shaft, -thin), (shaft, thin), (0, thin)]
    tip = [(shaft - head * 0.2, -half), (length, 0.0), (shaft - head * 0.2, half), (shaft, 0.0)]
    vertices = np.array([(x, y, z) for x, y in outline + tip], dtype=np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 7], [7, 5, 6]], dtype=np.uint32)
    return vertices, faces


def placed(vertices: Vertices, pose: Pose) -> Vertices:
    """Vertices (..., 3) moved from a frame into the one its pose is given in."""
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    x, y = vertices[..., 0], vertices[..., 1]
    moved = np.stack([pose.x + c * x - s * y, pose.y + s * x + c * y, vertices[..., 2]], axis=-1)
    return moved.astype(np.float32)
