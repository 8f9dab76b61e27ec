"""Active, busy or stuck: what the heartbeats of a process mean. No clock and no processes here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

Condition = Literal["active", "busy", "stuck"]


@dataclass(frozen=True)
class LivenessLimits:
    """How long a process may be silent, and what happens then [s].

    Attributes
    ----------
    busy
        An executor that has not come round for so long is shown as busy; nothing else happens.
    stopped
        A process that was stopped (SIGSTOP) is stuck from then on; a debugger's glance is shorter.
    silent
        With no heartbeat at all, and no use of the processor, it is stuck from then on.
    stuck
        An executor that has not come round for so long is stuck, whatever other heartbeats come:
        others speak for it, and a rule may have it started anew. Time for which its process waited
        for a processor does not count.
    hung
        One that has not come round for so long, whyever, is not expected to.
    killed
        A process that shows no life, or is not expected to come round, is killed so long after
        that, and started again; None for never.
    """

    busy: float = 0.5
    stopped: float = 0.3
    silent: float = 0.65
    stuck: float = 2.5
    hung: float = 10.0
    killed: float | None = 3.0

    def __post_init__(self) -> None:
        for name in ("busy", "stopped", "silent", "stuck", "hung", "killed"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise ValueError(f"LivenessLimits: {name} = {value!r} s must be above 0")
        if self.hung < self.stuck:
            raise ValueError(
                f"LivenessLimits: hung = {self.hung!r} s must not be below stuck = {self.stuck!r} s"
            )


@dataclass(frozen=True)
class Observation:
    """What is known of one executor of a process at a moment.

    Attributes
    ----------
    silent
        Since the last heartbeat of the process as such [s].
    lag
        Since the executor last came round; None when it has never, or is not meant to [s].
    stopped
        Since it was stopped by a signal; None when it was not [s].
    computing
        Whether it has used, or waited for, a processor while it was silent.
    waited
        For how long the thread of it that waited longest for a processor did so meanwhile [s].
    allowed
        How long a step of this executor may take, where that is longer than
        :attr:`LivenessLimits.stuck` [s].
    """

    silent: float
    lag: float | None = None
    stopped: float | None = None
    computing: bool = False
    waited: float = 0.0
    allowed: float = 0.0


class Judgement(NamedTuple):
    """What an observation means.

    Attributes
    ----------
    condition
        Of the executor.
    reason
        In words; empty for "active".
    is_lost
        Whether nobody expects it to come back by itself.
    """

    condition: Condition
    reason: str = ""
    is_lost: bool = False


def assess_liveness(observed: Observation, limits: LivenessLimits) -> Judgement:
    """Tell the condition of an executor."""
    if observed.stopped is not None:
        if observed.stopped >= limits.stopped:
            return Judgement("stuck", "the process was stopped by a signal", is_lost=True)
        return Judgement("busy", "the process was stopped by a signal just now")
    if observed.silent >= limits.silent and not observed.computing:
        return Judgement("stuck", f"no sign of life for {observed.silent:.1f} s", is_lost=True)
    if observed.lag is not None:
        text = f"its loop has not come round for {observed.lag:.1f} s"
        if observed.lag >= max(limits.hung, observed.allowed):
            return Judgement("stuck", text, is_lost=True)
        if observed.lag - observed.waited >= max(limits.stuck, observed.allowed):
            return Judgement("stuck", text)
        if observed.lag >= limits.busy:
            return Judgement("busy", text)
    elif observed.silent >= limits.hung:
        return Judgement("stuck", f"no sign of life for {observed.silent:.0f} s", is_lost=True)
    if observed.silent >= limits.silent:
        return Judgement("busy", f"it computes; no sign of life for {observed.silent:.1f} s")
    return Judgement("active")
