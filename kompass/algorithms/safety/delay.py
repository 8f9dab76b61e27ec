"""How late messages come whose sender has a clock of its own."""

import math

DRIFT = 1e-4  # s per second by which two clocks may drift apart; quartz does a tenth of that


class Delay:
    """Compares how long messages of one sender were under way. Times are arguments [s].

    The sender's clock and ours are monotonic and began at different times, so only the differences
    tell something: the quickest message so far counts as one that took no time.
    """

    def __init__(self) -> None:
        self._least = math.inf  # ours less the sender's
        self._at = -math.inf

    def of(self, sent: float, now: float) -> float:
        """How much longer a message was under way than the quickest one.

        Parameters
        ----------
        sent
            On the sender's clock.
        now
            When it came, on ours.
        """
        if math.isfinite(self._least):
            self._least += DRIFT * (now - self._at)
        self._at = now
        self._least = min(self._least, now - sent)
        return now - sent - self._least
