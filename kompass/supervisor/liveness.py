"""Busy, stuck or well: what the beats of a process mean. No clock and no processes here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Condition = Literal["active", "busy", "stuck"]


@dataclass(frozen=True)
class Patience:
    """How long a process may be silent [s].

    Attributes
    ----------
    busy
        An executor that has not come round for so long is shown as busy; nothing else happens.
    stopped
        A process that was stopped (SIGSTOP) is stuck from then on; a debugger's glance is shorter.
    silent
        With no beat at all, and no use of the processor, it is stuck from then on.
    stuck
        An executor that has not come round for so long is stuck, whatever else beats.
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
                raise ValueError(f"Patience: {name} = {value!r} s must be above 0")


@dataclass(frozen=True)
class Signs:
    """What is known of one executor of a process at a moment.

    Attributes
    ----------
    silent
        Since the last beat of the process as such [s].
    lag
        Since the executor last came round; None when it has never, or is not meant to [s].
    stopped
        Since it was stopped by a signal; None when it was not [s].
    computing
        Whether it has used, or waited for, a processor while it was silent.
    allowed
        How long a step of this executor may take, beyond the general patience [s].
    """

    silent: float
    lag: float | None = None
    stopped: float | None = None
    computing: bool = False
    allowed: float = 0.0


def judge(signs: Signs, patience: Patience) -> tuple[Condition, str]:
    """The condition, and for all but ``active`` the reason in words."""
    if signs.stopped is not None:
        if signs.stopped >= patience.stopped:
            return "stuck", "the process was stopped by a signal"
        return "busy", "the process was stopped by a signal just now"
    if signs.silent >= patience.silent and not signs.computing:
        return "stuck", f"no sign of life for {signs.silent:.1f} s"
    limit = max(patience.stuck, signs.allowed)
    if signs.lag is not None and signs.lag >= limit:
        return "stuck", f"its loop has not come round for {signs.lag:.0f} s"
    if signs.silent >= patience.stuck and signs.lag is None:
        return "stuck", f"no sign of life for {signs.silent:.0f} s"
    if signs.lag is not None and signs.lag >= patience.busy:
        return "busy", f"its loop has not come round for {signs.lag:.1f} s"
    if signs.silent >= patience.silent:
        return "busy", f"it computes; no sign of life for {signs.silent:.1f} s"
    return "active", ""
