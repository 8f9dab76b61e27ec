"""Transforms between frames: a buffer with a short history, without ROS and without a clock.

There is no tf2 among the ROS wheels. This holds what a planar navigation stack needs: a tree of
edges, each with its own history, interpolation between two samples, and an error that names the
missing link.
"""

import bisect
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]


class TransformError(LookupError):
    """Two frames are not connected, or not at the time asked for."""


@dataclass
class _Edge:
    parent: str
    static: bool
    stamps: list[float] = field(default_factory=list)
    matrices: list[Matrix] = field(default_factory=list)

    def add(self, stamp: float, matrix: Matrix, history: float) -> None:
        if self.static:
            self.stamps, self.matrices = [stamp], [matrix]
            return
        index = bisect.bisect(self.stamps, stamp)
        self.stamps.insert(index, stamp)
        self.matrices.insert(index, matrix)
        oldest = bisect.bisect_left(self.stamps, self.stamps[-1] - history)
        del self.stamps[:oldest], self.matrices[:oldest]

    def at(self, stamp: float | None) -> Matrix | None:
        if self.static or stamp is None:
            return self.matrices[-1]
        index = bisect.bisect_left(self.stamps, stamp)
        if index < len(self.stamps) and self.stamps[index] == stamp:
            return self.matrices[index]
        if index in (0, len(self.stamps)):
            return None  # before the first or after the last: never extrapolated
        earlier, later = self.stamps[index - 1], self.stamps[index]
        share = (stamp - earlier) / (later - earlier)
        return interpolate(self.matrices[index - 1], self.matrices[index], share)


class TransformBuffer:
    """The newest ``history`` seconds of every edge of the transform tree."""

    def __init__(self, history: float = 10.0) -> None:
        self.history = history
        self._edges: dict[str, _Edge] = {}

    def add(
        self, parent: str, child: str, stamp: float, matrix: Matrix, *, static: bool = False
    ) -> None:
        """Add one sample: ``matrix`` (4, 4) takes points of ``child`` to ``parent``."""
        parent, child = parent.removeprefix("/"), child.removeprefix("/")
        edge = self._edges.get(child)
        if edge is None or edge.parent != parent or edge.static != static:
            edge = self._edges[child] = _Edge(parent, static)
        edge.add(stamp, matrix, self.history)

    def lookup(self, target: str, source: str, stamp: float | None = None) -> Matrix:
        """Matrix (4, 4) that takes points of ``source`` to ``target``.

        Parameters
        ----------
        target, source
            Frame names.
        stamp
            Time [s]; the newest of each edge when None.

        Raises
        ------
        TransformError
            When there is no connection, or none at ``stamp``.
        """
        target, source = target.removeprefix("/"), source.removeprefix("/")
        if target == source:
            return np.eye(4)
        to_target = dict(self._to_root(target, stamp))
        for frame, matrix in self._to_root(source, stamp):
            if frame in to_target:
                return np.asarray(np.linalg.inv(to_target[frame]) @ matrix)
        raise TransformError(
            f"no transform from '{source}' to '{target}': '{source}' leads to "
            f"'{self._root(source)}', '{target}' to '{self._root(target)}'"
        )

    def planar(self, target: str, source: str, stamp: float | None = None) -> tuple[float, ...]:
        """As :meth:`lookup`, as a planar pose (x [m], y [m], yaw [rad])."""
        m = self.lookup(target, source, stamp)
        return float(m[0, 3]), float(m[1, 3]), float(np.arctan2(m[1, 0], m[0, 0]))

    def _to_root(self, frame: str, stamp: float | None) -> Iterator[tuple[str, Matrix]]:
        matrix = np.eye(4)
        yield frame, matrix
        for _ in range(len(self._edges)):
            edge = self._edges.get(frame)
            if edge is None:
                return
            step = edge.at(stamp)
            if step is None:
                raise TransformError(
                    f"the transform from '{frame}' to '{edge.parent}' is known from "
                    f"{edge.stamps[0]:.3f} s to {edge.stamps[-1]:.3f} s, not at {stamp:.3f} s"
                )
            matrix = step @ matrix
            frame = edge.parent
            yield frame, matrix

    def _root(self, frame: str) -> str:
        for _ in range(len(self._edges)):
            edge = self._edges.get(frame)
            if edge is None:
                break
            frame = edge.parent
        return frame


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


def interpolate(first: Matrix, second: Matrix, share: float) -> Matrix:
    """Between two poses: translation linearly, rotation about one axis (slerp)."""
    relative = first[:3, :3].T @ second[:3, :3]
    angle = np.arccos(np.clip((np.trace(relative) - 1) / 2, -1.0, 1.0))
    result = np.eye(4)
    result[:3, 3] = (1 - share) * first[:3, 3] + share * second[:3, 3]
    if angle < 1e-9:
        result[:3, :3] = first[:3, :3]
        return result
    values, vectors = np.linalg.eig(relative)
    axis = np.real(vectors[:, int(np.argmin(np.abs(values - 1)))])
    skew = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    # The eigenvector's sign is arbitrary; the rotation tells which way it turns.
    if np.dot(axis, _vee(relative)) < 0:
        skew = -skew
    turn = share * angle
    rotation = np.eye(3) + np.sin(turn) * skew + (1 - np.cos(turn)) * (skew @ skew)
    result[:3, :3] = first[:3, :3] @ rotation
    return result


def _vee(rotation: Matrix) -> Matrix:
    return np.array(
        [
            rotation[2, 1] - rotation[1, 2],
            rotation[0, 2] - rotation[2, 0],
            rotation[1, 0] - rotation[0, 1],
        ]
    )
