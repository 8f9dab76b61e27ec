"""Where the controller sees obstacles: the local map, or the scan itself."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kompass.bus.node import LifecycleNode
from kompass.components.base.ports import Input

Points = NDArray[np.float64]
HANDOVER = 1.0  # s that the old source may still be used for while the new one is silent


class ObstacleSource:
    """One of several inputs is in use, and only that one is subscribed to.

    While it is being changed the old one serves until the new one has spoken, for
    ``HANDOVER`` seconds at most, so that no control step is without obstacles.

    Parameters
    ----------
    node
        That subscribes.
    find
        Gives the input of a key.
    place
        For each key in question, what makes points (N, 2) in the world's frame [m] of a message,
        as soon as it arrives: where the robot was then is known best at that moment. It raises
        ValueError or LookupError when it cannot.
    """

    def __init__(
        self,
        node: LifecycleNode,
        find: Callable[[str], Input],
        place: Mapping[str, Callable[[Any], Points]],
    ) -> None:
        self._node = node
        self._find = find
        self._points: dict[str, Points] = {}
        self.problem = ""
        self._wanted: str | None = None
        self._old: str | None = None
        self._changed = -float("inf")
        for key, placed in place.items():
            find(key).on_message = self._keeper(key, placed)

    def want(self, key: str | None) -> None:
        """Use another source from now on; None for none."""
        if key == self._wanted:
            return
        if self._old is not None and self._old != key:
            self._close(self._old)
        self._old, self._wanted = self._wanted, key
        self._changed = self._node.clock.monotonic()
        if key is not None:
            self._find(key).open(self._node)
        else:
            self._drop_old()

    @property
    def input(self) -> Input | None:
        """The input that is in use at this moment."""
        if self._wanted is None:
            return None
        new = self._find(self._wanted)
        over = self._node.clock.monotonic() - self._changed > HANDOVER
        if self._old is not None and (over or self._wanted in self._points):
            self._drop_old()
        return new if self._old is None else self._find(self._old)

    def points(self, timeout: float) -> Points | None:
        """Obstacles (N, 2) in the world's frame [m]; None when there are none of that age [s]."""
        source = self.input
        key = self._wanted if self._old is None else self._old
        if source is None or key is None or source.age() > timeout:
            return None
        return self._points.get(key)

    def _drop_old(self) -> None:
        if self._old is not None:
            self._close(self._old)
            self._old = None

    def _close(self, key: str) -> None:
        self._find(key).close(self._node)
        self._points.pop(key, None)

    def _keeper(self, key: str, place: Callable[[Any], Points]) -> Callable[[Any], None]:
        def keep(message: Any) -> None:
            try:
                self._points[key] = place(message)
            except (ValueError, LookupError) as error:
                self.problem = str(error)
                self._points.pop(key, None)
            else:
                self.problem = ""

        return keep
