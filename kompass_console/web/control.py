"""Control of the robot, among the people of this console."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from kompass_console.control.lease import (
    AWAY,
    Lease,
    NotInControl,
    Person,
    acting,
    asked,
    given,
    is_mine,
    kept,
    looked_at,
    taken,
)
from kompass_console.schema.control_models import ControlInfo
from kompass_console.schema.roles import Role
from kompass_console.web.audit import AuditTrail
from kompass_console.web.auth import LoginSession
from kompass_console.web.errors import ConsoleError
from kompass_console.web.hands import Hands
from kompass_console.web.open_sockets import OpenSockets

_NO_DETAILS: Mapping[str, Any] = MappingProxyType({})


class Control:
    """Who may set the robot in motion. Any thread.

    Parameters
    ----------
    sockets
        Knows who has a page open.
    hands
        Who drives by hand gives the wheel up with control.
    audit
        Is told of each change.
    changed
        Called when pages have something new to show.
    """

    def __init__(
        self,
        sockets: OpenSockets,
        hands: Hands,
        audit: AuditTrail,
        changed: Callable[[], None],
        *,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._sockets, self._hands, self._audit = sockets, hands, audit
        self._changed, self._now = changed, now
        self._lease = Lease()
        self._lock = threading.Lock()

    def require(self, session: LoginSession, what: str, details: Mapping[str, Any]) -> None:
        """Whoever is about to set the robot in motion has control, or gets it when it is free.

        Parameters
        ----------
        what, details
            For the audit log, when it is refused.

        Raises
        ------
        ConsoleError
            409 when another person has it; the refusal is in the audit log.
        """

        def act(lease: Lease, person: Person, now: float) -> Lease:
            after = acting(lease, person)
            return after if now - self._sockets.last_seen(session.id) <= AWAY else lease

        try:
            before, after = self._change(session, act)
        except ConsoleError as error:
            self._audit.record(session, what, error.title, **details)
            raise
        if after.holder != before.holder:
            self._audit.record(session, "take control", "nobody had it")

    def ask(self, session: LoginSession) -> None:
        """Ask for control."""

        def ask(lease: Lease, person: Person, now: float) -> Lease:
            self._check_here(session, now)
            return asked(lease, person, now)

        self._told(session, "ask for control", ask)

    def take(self, session: LoginSession, reason: str) -> None:
        """Take control."""

        def take(lease: Lease, person: Person, now: float) -> Lease:
            self._check_here(session, now)
            return taken(lease, person, reason, now)

        self._told(session, "take control", take, {"reason": reason})

    def give(self, session: LoginSession) -> None:
        """Give control up: to who asks for it, or to nobody."""
        self._told(session, "give control", lambda lease, person, now: given(lease, person))

    def keep(self, session: LoginSession) -> None:
        """Answer that control is not given."""
        self._told(session, "keep control", lambda lease, person, now: kept(lease, person))

    def gave_wheel(self, session: LoginSession) -> None:
        """Whoever gave the wheel up gives control to who asks for it."""

        def give(lease: Lease, person: Person, now: float) -> Lease:
            asked_for = lease.ask is not None and is_mine(lease, person)
            return given(lease, person) if asked_for else lease

        before, after = self._change(session, give)
        if after.holder != before.holder:
            self._audit.record(
                session, "give control", "done", before=_holder(before), after=_holder(after)
            )

    def left(self, session: LoginSession) -> None:
        """A log-in has ended."""
        with self._lock:
            mine = is_mine(self._lease, _person(session))
        if mine:
            self.give(session)

    def info(self) -> ControlInfo:
        """What pages show."""
        with self._lock:
            now = self._now()
            lease = self._looked_at(now)
        holder, ask, lost = lease.holder, lease.ask, lease.taken_from
        return ControlInfo(
            holder="" if holder is None else holder.name,
            holder_key="" if holder is None else key_of(holder.session),
            asked_by="" if ask is None else ask.person.name,
            asked_key="" if ask is None else key_of(ask.person.session),
            asked=0.0 if ask is None else now - ask.since,
            taken_from="" if lost is None else lost.name,
            taken_key="" if lost is None else key_of(lost.session),
            reason=lease.reason,
        )

    # -- pieces -------------------------------------------------------------------------------

    def _check_here(self, session: LoginSession, now: float) -> None:
        """Control is lost by who has no page open: nobody gets it who would lose it at once."""
        if now - self._sockets.last_seen(session.id) > AWAY:
            raise NotInControl(
                "You have no page of this console open, and only who has one keeps control.",
                "Open the page, and try again there; a program needs no control to send a goal "
                "while nobody has it.",
            )

    def _told(
        self,
        session: LoginSession,
        what: str,
        change: Callable[[Lease, Person, float], Lease],
        details: Mapping[str, Any] = _NO_DETAILS,
    ) -> None:
        try:
            before, after = self._change(session, change)
        except ConsoleError as error:
            self._audit.record(session, what, error.title, **details)
            raise
        self._audit.record(
            session, what, "done", before=_holder(before), after=_holder(after), **details
        )

    def _change(
        self, session: LoginSession, change: Callable[[Lease, Person, float], Lease]
    ) -> tuple[Lease, Lease]:
        with self._lock:
            now = self._now()
            before = self._looked_at(now)
            try:
                after = self._lease = change(before, _person(session), now)
            except NotInControl as error:
                raise ConsoleError(409, error.why, error.remedy) from None
        if before.holder not in (None, after.holder):
            self._hands.lose(before.holder.session, _holder(after))
        if after != before:
            self._changed()
        return before, after

    def _looked_at(self, now: float) -> Lease:
        """The lease now; whoever has gone has it no more."""
        lease = self._lease
        if lease.holder is None and lease.ask is None:
            return lease
        holder = "" if lease.holder is None else lease.holder.session
        asker = "" if lease.ask is None else lease.ask.person.session
        seen = self._sockets.last_seen
        self._lease = looked_at(lease, seen(holder), seen(asker), now)
        return self._lease


def key_of(session: str) -> str:
    """By which a page knows that it is its own log-in that has control."""
    return session[:8]


def _person(session: LoginSession) -> Person:
    overrules = session.role.covers(Role.ENGINEER)
    return Person(session.id, session.user, session.account, overrules)


def _holder(lease: Lease) -> str:
    return "" if lease.holder is None else lease.holder.name
