"""Transforms between frames: a tree of the newest ones, without ROS and without a clock.

There is no tf2 among the ROS wheels. This holds what a planar navigation stack asks for: where one
frame is in another now, and an error that names the missing link.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.geometry import Pose2D

Matrix = NDArray[np.float64]


class TransformError(LookupError):
    """Two frames are not connected."""


class _Edge(NamedTuple):
    parent: str
    static: bool
    stamp: float
    matrix: Matrix


class TransformTree:
    """The newest transform of every frame to its parent."""

    def __init__(self) -> None:
        self._edges: dict[str, _Edge] = {}

    def add(
        self, parent: str, child: str, stamp: float, matrix: Matrix, *, static: bool = False
    ) -> None:
        """Take in ``matrix`` (4, 4), which turns and moves points of ``child`` to ``parent``.

        Parameters
        ----------
        stamp
            Time of the measurement [s]; a moving frame keeps its newest, whenever it arrives.
        static
            Whether it holds for good; the last to arrive counts then.
        """
        parent, child = parent.removeprefix("/"), child.removeprefix("/")
        known = self._edges.get(child)
        same = known is not None and known.parent == parent and known.static == static
        if known is not None and same and not static and stamp < known.stamp:
            return
        self._edges[child] = _Edge(parent, static, stamp, matrix)

    def lookup(self, target: str, source: str) -> Matrix:
        """Matrix (4, 4) that takes points of ``source`` to ``target``, by the newest of each edge.

        Raises
        ------
        TransformError
            When there is no connection.
        """
        target, source = target.removeprefix("/"), source.removeprefix("/")
        if target == source:
            return np.eye(4)
        to_target = dict(self._to_root(target))
        for frame, matrix in self._to_root(source):
            if frame in to_target:
                return matrix if frame == target else _inverse(to_target[frame]) @ matrix
        raise TransformError(
            f"no transform from '{source}' to '{target}': '{source}' leads to "
            f"'{self._root(source)}', '{target}' to '{self._root(target)}'"
        )

    def moved_at(self, target: str, source: str) -> float:
        """When the oldest moving transform between two frames is from [s]; inf when none moves.

        The two must be connected, as :meth:`lookup` says.
        """
        # What both go through on their way to the root is not between them.
        between = self._way(target.removeprefix("/")) ^ self._way(source.removeprefix("/"))
        edges = [self._edges[frame] for frame in between if frame in self._edges]
        return min((edge.stamp for edge in edges if not edge.static), default=math.inf)

    def _way(self, frame: str) -> set[str]:
        """All frames from one to its root."""
        way: set[str] = set()
        while frame not in way:
            way.add(frame)
            edge = self._edges.get(frame)
            frame = frame if edge is None else edge.parent
        return way

    def planar(self, target: str, source: str) -> Pose2D:
        """As :meth:`lookup`, as a planar pose (x [m], y [m], yaw [rad])."""
        m = self.lookup(target, source)
        return float(m[0, 3]), float(m[1, 3]), float(np.arctan2(m[1, 0], m[0, 0]))

    def _to_root(self, frame: str) -> Iterator[tuple[str, Matrix]]:
        matrix = np.eye(4)
        yield frame, matrix
        for _ in range(len(self._edges)):
            edge = self._edges.get(frame)
            if edge is None:
                return
            matrix = edge.matrix @ matrix
            frame = edge.parent
            yield frame, matrix

    def _root(self, frame: str) -> str:
        return list(self._to_root(frame))[-1][0]


def matrix_of(
    translation: tuple[float, float, float], quaternion: tuple[float, float, float, float]
) -> Matrix:
    """Homogeneous matrix (4, 4) of a translation [m] and a quaternion (x, y, z, w)."""
    x, y, z, w = np.asarray(quaternion) / np.linalg.norm(quaternion)
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = translation
    return matrix


def _inverse(matrix: Matrix) -> Matrix:
    """Of a matrix that turns and moves, and nothing else."""
    inverse = np.eye(4)
    inverse[:3, :3] = turned = matrix[:3, :3].T
    inverse[:3, 3] = -(turned @ matrix[:3, 3])
    return inverse
