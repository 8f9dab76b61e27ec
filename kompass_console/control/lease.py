"""Control of the robot: one person has it, asks are answered, and who has gone has it no more.

Whoever sets the robot in motion while nobody has control gets it by that, for as long as that
person has a page open: who drives by requests alone drives while nobody has control, and keeps
nothing. The others ask for it. Who gets no answer, or is an engineer, may take it and must say why.
STOP, and whatever ends a motion, is everybody's and is not looked at here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

AWAY = 10.0  # s without an open page after which control is free: a page may be loaded again
ANSWER = 20.0  # s in which an ask is to be answered; after that it may be taken
ASK_LASTS = 120.0  # s
LONGEST_REASON = 200  # characters


class Person(NamedTuple):
    """Somebody who may have control: one log-in.

    Attributes
    ----------
    session
        Id of the log-in.
    name
        As everybody is told it.
    account
        Which account it is a log-in of; None for one by a token, which many people may have.
    overrules
        Whether this person may take control without having asked for it.
    """

    session: str
    name: str
    account: bytes | None
    overrules: bool


class Ask(NamedTuple):
    """Somebody asks for control, since then (s)."""

    person: Person
    since: float


@dataclass(frozen=True, slots=True)
class Lease:
    """Who has control.

    Attributes
    ----------
    holder
        None for nobody.
    ask
        Who asks for it.
    taken_from, reason
        From whom it was taken, and why; None and empty when it was given, or free.
    """

    holder: Person | None = None
    ask: Ask | None = None
    taken_from: Person | None = None
    reason: str = ""


class NotInControl(Exception):
    """Another person has control, or it cannot be had like that."""

    def __init__(self, why: str, remedy: str) -> None:
        super().__init__(f"{why} {remedy}")
        self.why, self.remedy = why, remedy


def looked_at(lease: Lease, holder_seen: float, asker_seen: float, now: float) -> Lease:
    """The lease without those who have gone; who asked one of them gets what he asked for.

    Parameters
    ----------
    holder_seen, asker_seen
        When they last had a page open (s).
    """
    ask = lease.ask
    if ask is not None and (now - ask.since > ASK_LASTS or now - asker_seen > AWAY):
        lease = replace(lease, ask=None)
    if lease.holder is not None and now - holder_seen > AWAY:
        return Lease(None if lease.ask is None else lease.ask.person)
    return lease


def is_mine(lease: Lease, person: Person) -> bool:
    """Whether it is this log-in that has control."""
    return lease.holder is not None and lease.holder.session == person.session


def acting(lease: Lease, person: Person) -> Lease:
    """The lease when a person sets the robot in motion.

    Raises
    ------
    NotInControl
        When another person has control.
    """
    if lease.holder is None:
        return _held_by(lease, person)
    if not is_mine(lease, person):
        raise NotInControl(*_refusal(lease.holder, person))
    return lease


def asked(lease: Lease, person: Person, now: float) -> Lease:
    """The lease when a person asks for control; who asks while nobody has it gets it.

    Raises
    ------
    NotInControl
        When another person asks already.
    """
    if lease.holder is None:
        return _held_by(lease, person)
    if is_mine(lease, person):
        return lease
    if lease.ask is not None and lease.ask.person.session != person.session:
        raise NotInControl(
            f"{lease.ask.person.name} has asked for control already.", "Wait for the answer to it."
        )
    return lease if lease.ask is not None else replace(lease, ask=Ask(person, now))


def taken(lease: Lease, person: Person, reason: str, now: float) -> Lease:
    """The lease when a person takes control.

    Raises
    ------
    NotInControl
        When the person must ask for it first, or does not say why.
    """
    holder = lease.holder
    if holder is None:
        return _held_by(lease, person)
    if is_mine(lease, person):
        return lease
    if person.account is not None and person.account == holder.account:
        return _held_by(lease, person)  # from one device to another
    waits = may_take_in(lease, person, now)
    if waits is None:
        raise NotInControl(f"{holder.name} has control of the robot.", "Ask for it first.")
    if waits > 0.0:
        raise NotInControl(
            f"{holder.name} has been asked and may still answer.", f"Wait for {waits:.0f} s more."
        )
    if not reason.strip():
        raise NotInControl(
            f"Control is taken from {holder.name} and nobody said why.", "Give a reason."
        )
    return Lease(person, None, holder, " ".join(reason.split()))


def may_take_in(lease: Lease, person: Person, now: float) -> float | None:
    """In how many seconds a person may take control; None for not without having asked."""
    if lease.holder is None or person.overrules:
        return 0.0
    if lease.ask is None or lease.ask.person.session != person.session:
        return None
    return max(0.0, lease.ask.since + ANSWER - now)


def given(lease: Lease, person: Person) -> Lease:
    """The lease when a person gives control up: to who asks for it, or to nobody.

    Raises
    ------
    NotInControl
        When the person has none.
    """
    _check_mine(lease, person)
    if lease.ask is None:
        return Lease()
    return Lease(lease.ask.person)


def kept(lease: Lease, person: Person) -> Lease:
    """The lease when a person keeps control though another asks for it.

    Raises
    ------
    NotInControl
        When the person has none.
    """
    _check_mine(lease, person)
    return replace(lease, ask=None)


def _held_by(lease: Lease, person: Person) -> Lease:
    ask = lease.ask
    still = None if ask is not None and ask.person.session == person.session else ask
    return Lease(person, still)


def _check_mine(lease: Lease, person: Person) -> None:
    if not is_mine(lease, person):
        raise NotInControl("You have no control of the robot.", "Look at who has it.")


def _refusal(holder: Person, person: Person) -> tuple[str, str]:
    """Why a person does not set the robot in motion, and what there is to do."""
    if holder.account is not None and holder.account == person.account:
        return (
            "You have control on another device.",
            "Take it here, at the top of the page. STOP works for everybody.",
        )
    return f"{holder.name} has control of the robot.", (
        "Ask for it, or take it and say why, at the top of the page. STOP works for everybody."
        if person.overrules
        else "Ask for it, at the top of the page. STOP works for everybody."
    )
