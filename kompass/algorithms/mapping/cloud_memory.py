"""What a camera has seen near the robot and does not see any more, because it looks elsewhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.geometry import Floats, Pose2D, inverse, transform_points
from kompass.algorithms.mapping.cloud_view import CELL, CloudView

NEAR = 2.0  # m around the robot in which things are remembered
_LOOKS = 2  # clouds in a row that look through a thing until it is gone
_INSIDE = 0.03  # m inside of the body, where nothing can be


class CloudMemory:
    """Remembers the places of one sensor's clouds that it has not looked through since.

    A camera that looks ahead does not see what the robot drives past, or stands right before.

    Parameters
    ----------
    body
        Radius of the circle inside the robot's footprint [m].
    memory
        After so many seconds a place is forgotten that was not seen again; 0 for at once.
    """

    def __init__(self, body: float, memory: float) -> None:
        self._body, self._memory = body, memory
        # In the world: (N, 2), and of each when it was seen and how often it was looked through.
        self._places: Floats = np.empty((0, 2))
        self._bottoms: Floats = np.empty(0)
        self._tops: Floats = np.empty(0)
        self._seen: Floats = np.empty(0)
        self._missed: NDArray[np.int64] = np.empty(0, dtype=np.int64)

    def see(self, view: CloudView, pose: Pose2D, now: float) -> None:
        """Take a cloud in that was made at a pose (x, y, yaw) of the robot in the world."""
        here = transform_points(inverse(pose), self._places)
        through = view.sees_through(here, self._bottoms, self._tops)
        missed = np.where(through, self._missed + 1, 0)
        away = np.hypot(here[:, 0], here[:, 1])
        kept = (missed < _LOOKS) & (away < NEAR) & (away > self._body - _INSIDE)
        kept &= now - self._seen <= self._memory
        near = np.hypot(view.points[:, 0], view.points[:, 1]) < NEAR
        new = int(near.sum())
        places = np.concatenate(
            [transform_points(pose, view.points[near]), self._places[kept]], axis=0
        )
        # Of those in one cell of the world the first counts: what is seen now.
        cells = np.floor(places / CELL).astype(np.int64)
        _, first = np.unique(cells, axis=0, return_index=True)
        self._places = places[first]
        self._bottoms = np.concatenate([view.bottoms[near], self._bottoms[kept]])[first]
        self._tops = np.concatenate([view.tops[near], self._tops[kept]])[first]
        self._seen = np.concatenate([np.full(new, now), self._seen[kept]])[first]
        self._missed = np.concatenate([np.zeros(new, dtype=np.int64), missed[kept]])[first]

    def points(self, now: float) -> Floats:
        """What is remembered, (N, 2) in the world [m]."""
        return self._places[now - self._seen <= self._memory]
