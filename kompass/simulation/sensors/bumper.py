"""Counts how often the robot's shell has touched something."""

from __future__ import annotations

SEPARATION_TIME = 0.2  # s without contact that end an episode


class Bumper:
    """Turns touching, sampled at every physics step, into episodes.

    Attributes
    ----------
    episodes
        Contacts so far. One that is lost for less than ``SEPARATION_TIME``, as when a
        robot bounces or scrapes along a wall, still counts once.
    """

    def __init__(self) -> None:
        self.episodes = 0
        self._last_touch = -SEPARATION_TIME

    def update(self, touching: bool, now: float) -> None:
        """Take in whether the shell touches anything at ``now`` (simulated seconds)."""
        if not touching:
            return
        if now - self._last_touch >= SEPARATION_TIME:
            self.episodes += 1
        self._last_touch = now
