"""What a table would have done on a recording, beside what was done."""

from typing import Literal

from kompass.rulebook.schema.status import LeafReading
from kompass.rules.schema.model import Model


class BacktestFiring(Model):
    """A firing, in the recording or in the back-test or in both.

    Attributes
    ----------
    time
        Seconds since the epoch; ``at`` seconds since the start of the recording.
    verdict
        ``same`` in both, ``new`` in the back-test only, ``gone`` in the recording only.
    assumed
        Whether it rests on an assumed length of a run (one that did not happen in the recording),
        or differs so near the beginning that what was before may account for it.
    """

    rule_id: str
    time: float
    at: float
    verdict: Literal["same", "new", "gone"]
    leaves: tuple[LeafReading, ...] = ()
    text: str = ""
    assumed: bool = False


class RuleTally(Model):
    """Numbers of a rule over the recording."""

    rule_id: str
    recorded: int
    proposed: int
    evaluated: int
    true: int
    unknown_time: float  # s for which its condition could not be judged
    text: str  # why it never fired, for one that did not


class BacktestReport(Model):
    """What a table would have done.

    Attributes
    ----------
    start, end
        Of the stretch, seconds since the epoch.
    messages
        Number that were replayed.
    seconds
        That the replay took.
    missing_topics
        Topics of the table that the recording does not hold: its rules could not be judged.
    warm_up
        Seconds at the start in which holds and cooldowns of before are not known.
    """

    start: float
    end: float
    messages: int
    seconds: float
    firings: tuple[BacktestFiring, ...]
    tallies: tuple[RuleTally, ...]
    same: int
    new: int
    gone: int
    missing_topics: tuple[str, ...] = ()
    warm_up: float = 0.0
    truncated: bool = False  # more firings than are listed
