"""Follow a target by its box in the image: it is to stay in the middle, and as large as it was."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from kompass.algorithms.geometry import Pose2D
from kompass.algorithms.tracking.vision_follower import Quest, VisionFollower, VisionParams


@dataclass(frozen=True, kw_only=True)
class VisionRGBParams(VisionParams):
    """The law's own parameters.

    Attributes
    ----------
    rotation_gain
        Share of the top turning rate for a target at the edge of the image.
    speed_gain
        Share of the top speed for a target whose box has vanished to nothing.
    tolerance
        Relative error of area and middle that is none.
    """

    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {
        **VisionParams.bounds,
        "tolerance": (0.0, 1.0),
    }

    rotation_gain: float = 1.0
    speed_gain: float = 0.7
    tolerance: float = 0.1


class VisionRGBFollower(VisionFollower[VisionRGBParams]):
    """Keeps the distance at which it first saw the target, without knowing it.

    The errors of its steps have no unit: of distance, the share that the box has lost of the area
    that it had at first; of orientation, the offset from the middle of the image, 1 at its left
    edge.
    """

    params_class = VisionRGBParams

    def begin(self, quest: Quest, now: float) -> None:
        super().begin(quest, now)
        self._first: float | None = None
        self._share = self._offset = 0.0

    def see(self, offset: float, share: float, now: float) -> None:
        """The target is in the image.

        Parameters
        ----------
        offset
            Of its middle, -1 at the left edge of the image, 1 at the right one.
        share
            Of the image's area that its box takes, above 0.
        now
            When the image was taken [s].

        Raises
        ------
        ValueError
            The share is not above 0.
        """
        if not share > 0.0:
            raise ValueError(f"share: {share}; give the share of the image, above 0")
        if self._first is None:
            self._first = share
        self._offset, self._share = offset, share
        self._is_seen(now)

    def _follow(self, pose: Pose2D, now: float, dt: float) -> tuple[float, float, float, float]:
        params = self.params
        assert self._first is not None
        # Towards it, an error is 1 at most; away from it, no more is needed to back off.
        away = max(-1.0, (self._first - self._share) / self._first)
        side = -self._offset
        v = params.speed_gain * self._linear.max_vel * away if abs(away) > params.tolerance else 0.0
        omega = params.rotation_gain * self._angular.max_vel * side
        if abs(side) <= params.tolerance:
            omega = 0.0
        return v, omega, away, side
