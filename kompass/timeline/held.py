"""What is told of only once it has lasted for a moment."""

from __future__ import annotations

from kompass.timeline.happening import Began, Happening, Over


class Held:
    """Holds beginnings back until they have lasted; what is over before was never told.

    Parameters
    ----------
    hold
        For how long something must last [s].
    """

    def __init__(self, hold: float) -> None:
        self._hold = hold
        self._waiting: dict[str, Began] = {}

    def begins(self, it: Began) -> None:
        """Something is so, from its time on unless that was said before."""
        known = self._waiting.get(it.key)
        time = it.time if known is None or known.title != it.title else known.time
        self._waiting[it.key] = it._replace(time=time)

    def over(self, it: Over) -> Happening:
        """It is so no more."""
        self._waiting.pop(it.key, None)
        return it

    def due(self, now: float) -> list[Began]:
        """What has lasted long enough by now, each once."""
        found = [it for it in self._waiting.values() if now - it.time >= self._hold]
        for it in found:
            del self._waiting[it.key]
        return found
