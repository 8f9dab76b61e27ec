"""Active, busy or stuck: what the heartbeats of a process mean. No clock and no processes here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

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
        An executor that has not come round for so long is stuck, whatever other heartbeats come.
    killed
        A stuck process is killed so long after that, and started again; None for never.
    """

    busy: float = 0.5
    stopped: float = 0.3
    silent: float = 0.65
    stuck: float = 10.0
    killed: float | None = 3.0

    def __post_init__(self) -> None:
        for name in ("busy", "stopped", "silent", "stuck", "killed"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise ValueError(f"LivenessLimits: {name} = {value!r} s must be above 0")


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
    allowed
        How long a step of this executor may take, where that is longer than
        :attr:`LivenessLimits.stuck` [s].
    """

    silent: float
    lag: float | None = None
    stopped: float | None = None
    computing: bool = False
    allowed: float = 0.0


def assess_liveness(observed: Observation, limits: LivenessLimits) -> tuple[Condition, str]:
    """Tell the condition of an executor.

    Returns
    -------
    tuple[Condition, str]
        The condition, and for all but "active" the reason in words.
    """
    if observed.stopped is not None:
        if observed.stopped >= limits.stopped:
            return "stuck", "the process was stopped by a signal"
        return "busy", "the process was stopped by a signal just now"
    if observed.silent >= limits.silent and not observed.computing:
        return "stuck", f"no sign of life for {observed.silent:.1f} s"
    longest_step = max(limits.stuck, observed.allowed)
    if observed.lag is not None and observed.lag >= longest_step:
        return "stuck", f"its loop has not come round for {observed.lag:.0f} s"
    if observed.silent >= limits.stuck and observed.lag is None:
        return "stuck", f"no sign of life for {observed.silent:.0f} s"
    if observed.lag is not None and observed.lag >= limits.busy:
        return "busy", f"its loop has not come round for {observed.lag:.1f} s"
    if observed.silent >= limits.silent:
        return "busy", f"it computes; no sign of life for {observed.silent:.1f} s"
    return "active", ""
