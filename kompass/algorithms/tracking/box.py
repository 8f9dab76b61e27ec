"""What a detector has found in an image, and which of it is the target."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

# For so long the target is looked for where it was [s]; then anywhere in the image.
_REMEMBERED = 1.0
# How far a box's middle may have moved from one look to the next, in its larger side, and how much
# farther for each second between them.
_STRIDE, _PER_SECOND = 0.7, 3.0


@dataclass(frozen=True)
class Box:
    """Something in an image.

    Attributes
    ----------
    label
        Its class.
    x, y
        Its middle [px].
    width, height
        [px]
    track
        The same for the same thing in image after image; empty when nobody tracks.
    """

    label: str
    x: float
    y: float
    width: float
    height: float
    track: str = ""

    @property
    def is_usable(self) -> bool:
        """Whether it is finite and has an area."""
        numbers = (self.x, self.y, self.width, self.height)
        return all(map(math.isfinite, numbers)) and self.width > 0.0 and self.height > 0.0

    def holds(self, x: float, y: float) -> bool:
        """Whether a pixel lies in it."""
        return abs(x - self.x) <= self.width / 2.0 and abs(y - self.y) <= self.height / 2.0

    def offset(self, width: int) -> float:
        """How far its middle is off that of an image ``width`` [px] wide, from -1 (left) to 1."""
        return min(1.0, max(-1.0, 2.0 * self.x / width - 1.0))

    def share(self, width: int, height: int) -> float:
        """Share that it takes of an image of this size [px]."""
        return self.width * self.height / (width * height)


class TargetLock:
    """Finds one target in image after image.

    At first it is the largest box of the label, or the smallest that holds the pixel. From then on
    it is the one of the same track, or else of the same label and near where it was a moment ago.
    Once it has been out of sight for a second, the largest of its label is the target again.

    Parameters
    ----------
    label
        Class of the target; case does not matter. Empty to take that of what the pixel shows.
    pixel
        (x, y) [px] on the target, looked at once.
    """

    def __init__(self, label: str = "", pixel: tuple[int, int] | None = None) -> None:
        self.label = label
        self._pixel = pixel
        self._last: Box | None = None
        self._seen = -math.inf

    def find(self, boxes: Sequence[Box], now: float) -> Box | None:
        """The target among the boxes of an image at ``now`` [s]; None when it is not there."""
        found = self._pick([box for box in boxes if box.is_usable], now)
        if found is not None:
            self._last, self._seen, self._pixel = found, now, None
            self.label = self.label or found.label
        return found

    def _pick(self, boxes: Sequence[Box], now: float) -> Box | None:
        if self._pixel is not None:
            x, y = self._pixel
            there = [box for box in self._labelled(boxes) if box.holds(x, y)]
            return min(there, key=_area, default=None)
        alike = self._labelled(boxes)
        last, since = self._last, now - self._seen
        if last is not None and last.track:
            same = [box for box in alike if box.track == last.track]
            if same:
                return same[0]
        if last is None or since > _REMEMBERED:
            return max(alike, key=_area, default=None)
        reach = max(last.width, last.height) * (_STRIDE + _PER_SECOND * since)
        near = [box for box in alike if _apart(box, last) <= reach]
        return min(near, key=lambda box: _apart(box, last), default=None)

    def _labelled(self, boxes: Sequence[Box]) -> list[Box]:
        wanted = self.label.casefold()
        return [box for box in boxes if not wanted or box.label.casefold() == wanted]


def _area(box: Box) -> float:
    return box.width * box.height


def _apart(one: Box, other: Box) -> float:
    return math.hypot(one.x - other.x, one.y - other.y)
