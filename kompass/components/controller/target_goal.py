"""A goal of ``TrackVisionTarget``: what is to be followed, and how far that has come."""

import math
from typing import Any

from kompass_interfaces.action import TrackVisionTarget
from rclpy.task import Future

from kompass.algorithms.tracking.box import TargetLock
from kompass.algorithms.tracking.vision_follower import Quest
from kompass.components.controller.progress import Progress

LONGEST = 3600.0  # s that a goal may let its target be out of sight
WIDEST = 100.0  # m of a search's radius


class NoTarget(Exception):
    """There is nothing to follow; the message says why, and what to do."""


class TargetGoal:
    """One goal that is pursued.

    Parameters
    ----------
    ended
        Gets outcome and reason.
    now
        Since when [s].
    """

    def __init__(self, handle: Any, lock: TargetLock, ended: Future, now: float) -> None:
        self.handle, self.lock, self.ended = handle, lock, ended
        self.progress = Progress()
        self.tracked = 0.0  # s in which the target was in sight
        self.told = -math.inf  # when feedback was given
        self.stepped = self.located = now

    @property
    def name(self) -> str:
        """Of the target, for people."""
        return f"'{self.lock.label}'" if self.lock.label else "the target"


def read_goal(goal: TrackVisionTarget.Goal) -> tuple[TargetLock, Quest]:
    """The target of a goal, and what it asks for.

    Raises
    ------
    NoTarget
        When it names none, or a number that cannot be meant.
    """
    pixel = (goal.pose_x, goal.pose_y) if goal.pose_x or goal.pose_y else None
    label = goal.label.strip()
    if not label and pixel is None:
        raise NoTarget("label = '' and no pixel; give the target's class, or pose_x and pose_y")
    if pixel is not None and min(pixel) < 0:
        raise NoTarget(f"pose_x, pose_y = {pixel}; give a pixel of the image")
    for name, value, most in (
        ("search_timeout", goal.search_timeout, LONGEST),
        ("search_radius", goal.search_radius, WIDEST),
    ):
        if not 0.0 <= value <= most:
            raise NoTarget(f"{name} = {value}; give from 0 (as the algorithm is set) to {most:g}")
    return TargetLock(label, pixel), Quest(goal.search_timeout or None, goal.search_radius or None)
