"""How often, and after what delay, a process that died is started again."""

from __future__ import annotations

DELAYS = (0.1, 0.5, 1.0, 2.0, 5.0)  # s; the last one for all further deaths
HEALTHY = 30.0  # s; the deaths before a life longer than this no longer count
RETRIES = 5


class Restarts:
    """Counts the deaths of each process.

    Parameters
    ----------
    retries
        How often in a row a process is started again before it is given up.
    """

    def __init__(self, retries: int = RETRIES) -> None:
        self._retries = retries
        self._deaths: dict[str, int] = {}

    def ever_died(self, name: str) -> bool:
        """Whether a process has died before."""
        return name in self._deaths

    def in_a_row(self, name: str) -> int:
        """Deaths of a process without a healthy life between them."""
        return self._deaths.get(name, 0)

    def after_death(self, name: str, lived: float) -> float | None:
        """Count a death.

        Parameters
        ----------
        name
            Of the process.
        lived
            How long it lived [s].

        Returns
        -------
        float or None
            Delay before it is to be started again [s]; None when it is given up.
        """
        before = 0 if lived > HEALTHY else self._deaths.get(name, 0)
        self._deaths[name] = before + 1
        return None if before >= self._retries else DELAYS[min(before, len(DELAYS) - 1)]
