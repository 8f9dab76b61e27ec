"""Where the controller sees obstacles: the local map, or the sensors themselves."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kompass.bus.node import LifecycleNode
from kompass.components.base.ports import Input

Points = NDArray[np.float64]
HANDOVER = 1.0  # s that the old source may still be used for while the new one is silent


class ObstacleSource:
    """The inputs of one of several keys are in use, and only those are subscribed to.

    While the key is being changed the old one serves until all of the new one have spoken, for
    ``HANDOVER`` seconds at most, so that no control step is without obstacles.

    Parameters
    ----------
    node
        That subscribes.
    find
        Gives the inputs of a key.
    place
        For each key in question, what makes points (N, 2) in the world's frame [m] of the index of
        an input and its message, as soon as it arrives: where the robot was then is known best at
        that moment. It raises ValueError or LookupError when it cannot.
    """

    def __init__(
        self,
        node: LifecycleNode,
        find: Callable[[str], list[Input]],
        place: Mapping[str, Callable[[int, Any], Points]],
    ) -> None:
        self._node = node
        self._find = find
        self._points: dict[tuple[str, int], Points] = {}
        self._problems: dict[tuple[str, int], str] = {}
        self._wanted: str | None = None
        self._old: str | None = None
        self._changed = -float("inf")
        for key, placed in place.items():
            for index, source in enumerate(find(key)):
                source.on_message = self._keeper((key, index), placed)

    def want(self, key: str | None) -> None:
        """Use another source from now on; None for none."""
        if key == self._wanted:
            return
        if self._old is not None and self._old != key:
            self._close(self._old)
        self._old, self._wanted = self._wanted, key
        self._changed = self._node.clock.monotonic()
        if key is not None:
            for source in self._find(key):
                source.open(self._node)
        else:
            self._drop_old()

    @property
    def inputs(self) -> list[Input]:
        """The inputs that are in use at this moment; none when none are wanted."""
        key = self._used()
        return [] if key is None else self._find(key)

    def points(self, timeout: float) -> Points | None:
        """Obstacles (N, 2) in the world's frame [m]; None when an input has none so new [s]."""
        key = self._used()
        if key is None or self.silent(timeout):
            return None
        found = [self._points[(key, index)] for index in range(len(self._find(key)))]
        return found[0] if len(found) == 1 else np.concatenate(found)

    def silent(self, timeout: float) -> dict[Input, str]:
        """Which of the inputs in use show no obstacles of that age [s], each with what is wrong.

        The text is empty where nothing is wrong but the age.
        """
        key = self._used()
        if key is None:
            return {}
        return {
            source: self._problems.get((key, index), "")
            for index, source in enumerate(self._find(key))
            if source.age() > timeout or (key, index) not in self._points
        }

    def _used(self) -> str | None:
        if self._wanted is None:
            return None
        new = [
            (self._wanted, index) in self._points for index in range(len(self._find(self._wanted)))
        ]
        over = self._node.clock.monotonic() - self._changed > HANDOVER
        if self._old is not None and (over or all(new)):
            self._drop_old()
        return self._wanted if self._old is None else self._old

    def _drop_old(self) -> None:
        if self._old is not None:
            self._close(self._old)
            self._old = None

    def _close(self, key: str) -> None:
        for index, source in enumerate(self._find(key)):
            source.close(self._node)
            self._points.pop((key, index), None)
            self._problems.pop((key, index), None)

    def _keeper(
        self, place: tuple[str, int], placed: Callable[[int, Any], Points]
    ) -> Callable[[Any], None]:
        def keep(message: Any) -> None:
            try:
                self._points[place] = placed(place[1], message)
            except (ValueError, LookupError) as error:
                self._problems[place] = str(error)
                self._points.pop(place, None)
            else:
                self._problems.pop(place, None)

        return keep
