"""What components say of themselves, as happenings."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from typing import NamedTuple

from kompass.timeline.entry import Level
from kompass.timeline.happening import Began, Happening, Over
from kompass.timeline.held import Held

HOLD = 1.0  # s for which it must fail before it is told of
HEALTHY, ALGORITHM, SYSTEM = 0, 1, 3  # ComponentStatus; what else there is has failed
_PREFIX = re.compile(r"^Failure: [A-Za-z]+(?: Level)?(?: - )?")


class Said(NamedTuple):
    """What a component says: ComponentStatus, as data."""

    status: int
    message: str = ""
    topics: tuple[str, ...] = ()
    components: tuple[str, ...] = ()
    algorithms: tuple[str, ...] = ()


class HealthObserver:
    """Tells when components fail, and when they are well again."""

    def __init__(self) -> None:
        self._held = Held(HOLD)

    def says(
        self, component: str, said: Said, now: float, lost: Collection[str] = ()
    ) -> list[Happening]:
        """A component says how it is.

        Parameters
        ----------
        now
            Seconds since the epoch.
        lost
            Components whose process is lost: of them it is told already, and somebody else speaks
            for them.
        """
        key = f"health {component}"
        if said.status == HEALTHY or component in lost:
            return [self._held.over(Over(now, key))]
        title, level = _words(component, said)
        text = _PREFIX.sub("", said.message)
        self._held.begins(Began(now, "fault", key, title, text, level, component))
        return []

    def due(self, now: float) -> Sequence[Happening]:
        """What has lasted long enough by now."""
        return self._held.due(now)


def _words(component: str, said: Said) -> tuple[str, Level]:
    others = [name for name in said.components if name != component]
    if said.status == ALGORITHM:
        return "Finds no solution", "warning"
    if said.status == SYSTEM and (said.topics or others):
        return f"Waits for {', '.join((*said.topics, *others))}", "error"
    return "Failed", "error"
