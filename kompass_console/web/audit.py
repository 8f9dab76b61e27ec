"""Who did what through the console, from where, and how it ended: one line each."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable
from contextvars import ContextVar
from dataclasses import dataclass

from kompass_console.audit.line import AuditEntry
from kompass_console.audit.log import CONSOLE, ITSELF, AuditLog
from kompass_console.web.auth import LoginSession
from kompass_console.web.noted import note_of

OPEN_STOP = "stop without log-in"

_MINUTE = 60.0  # s
_FROM_ONE = 20  # lines a minute about one address that is not logged in
_FROM_ALL = 60  # and about all of them
_ADDRESSES = 1000
_LONGEST_NAME = 40
_SHOWN_OF_ID = 8  # characters of a session's id; enough to tell sessions apart


@dataclass
class Asking:
    """The request that is being answered: from where, and whether it has left a line."""

    address: str
    written: bool = False


# A route need not hand it on: what it calls runs in its context, in a thread of the pool too.
asking: ContextVar[Asking | None] = ContextVar("asking", default=None)


class AuditTrail:
    """Makes a line of what a request did. Never waits, and never fails: STOP comes first.

    What those who are not logged in cause is bounded, or they could push everything else out of
    the log; what is over the bound is counted, and the count is a line. STOP has a bound of its
    own: who fails to log in, however often, does not keep it out of the log.

    Parameters
    ----------
    note
        Has it noted on the robot's timeline what somebody did: words, name and role. Never waits.
    """

    def __init__(
        self,
        log: AuditLog,
        note: Callable[[str, str, str], None] = lambda *_: None,
        *,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.log = log
        self._note = note
        self._now = now
        self._strangers = StrangersBudget(now)
        self._open_stops = StrangersBudget(now)

    def record(
        self,
        session: LoginSession | None,
        what: str,
        outcome: str,
        *,
        who: str = "",
        **details: object,
    ) -> None:
        """Write one line.

        Parameters
        ----------
        session
            Of whoever did it; None when they are not logged in.
        who
            The name that somebody gave who is not logged in.
        details
            JSON; `before` and `after` where the deed changed something.
        """
        request = asking.get()
        address = "" if request is None else request.address
        if request is not None:
            request.written = True
        untold = self._strangers.untold() + self._open_stops.untold()
        if untold:
            said = f"{untold} more lines about strangers are left out"
            self.log.append(AuditEntry(time.time(), CONSOLE, "", "", "", ITSELF, said))
        if session is None:
            budget = self._open_stops if what == OPEN_STOP else self._strangers
            if not budget.allows(address):
                return
            name, role, of_log_in = clean_name(who) or "?", "none", ""
        else:
            name, role, of_log_in = session.user, str(session.role), session.id[:_SHOWN_OF_ID]
        deed = AuditEntry(time.time(), name, role, of_log_in, address, what, outcome, details)
        self.log.append(deed)
        if session is not None and (words := note_of(deed)):
            self._note(words, name, role)


class StrangersBudget:
    """How many lines there may be about those who are not logged in."""

    def __init__(self, now: Callable[[], float]) -> None:
        self._now = now
        self._begun = now()
        self._all = 0
        self._by_address: OrderedDict[str, int] = OrderedDict()
        self._over = 0

    def allows(self, address: str) -> bool:
        """Count one; whether it may be written."""
        self._turn()
        count = self._by_address.get(address, 0)
        if count >= _FROM_ONE or self._all >= _FROM_ALL:
            self._over += 1
            return False
        self._by_address[address] = count + 1
        if len(self._by_address) > _ADDRESSES:
            self._by_address.popitem(last=False)
        self._all += 1
        return True

    def untold(self) -> int:
        """How many were left out of a minute that is over; told once."""
        if not self._over or self._now() - self._begun < _MINUTE:
            return 0
        over, self._over = self._over, 0
        self._turn()
        return over

    def _turn(self) -> None:
        if self._now() - self._begun >= _MINUTE:
            self._begun = self._now()
            self._all = 0
            self._by_address.clear()


def clean_name(name: str) -> str:
    """A name that somebody gave, on one line and of bounded length."""
    printable = "".join(c if c.isprintable() else " " for c in name[: 4 * _LONGEST_NAME])
    return " ".join(printable.split())[:_LONGEST_NAME]
