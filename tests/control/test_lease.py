"""One person has control of the robot; the others ask, and nobody is locked out."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import strategies as st

from kompass_console.control.lease import (
    ANSWER,
    ASK_LASTS,
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
from tests.support.properties import property_test

AVA = Person("a", "ava", None, overrules=False)
BEN = Person("b", "ben", None, overrules=False)
EVE = Person("e", "eve", None, overrules=True)


def refused(change: Callable[[], Lease]) -> str:
    with pytest.raises(NotInControl) as caught:
        change()
    return str(caught.value)


def test_who_drives_first_has_control_and_another_is_told_whom_to_ask() -> None:
    lease = acting(Lease(), AVA)
    assert is_mine(lease, AVA)
    assert acting(lease, AVA) == lease
    told = refused(lambda: acting(lease, BEN))
    assert told.startswith("ava has control of the robot. Ask for it")
    assert "STOP works for everybody" in told


def test_an_ask_is_answered_by_who_has_control() -> None:
    lease = asked(acting(Lease(), AVA), BEN, 1.0)
    assert "ben has asked for control already" in refused(lambda: asked(lease, EVE, 2.0))
    assert is_mine(given(lease, AVA), BEN)
    assert kept(lease, AVA) == acting(Lease(), AVA)
    assert "You have no control" in refused(lambda: given(lease, BEN))
    assert "You have no control" in refused(lambda: kept(lease, BEN))
    assert given(acting(Lease(), AVA), AVA) == Lease()
    assert is_mine(asked(Lease(), BEN, 0.0), BEN)


def test_it_is_taken_after_an_ask_that_nobody_answered_and_with_a_reason() -> None:
    lease = acting(Lease(), AVA)
    assert "Ask for it first" in refused(lambda: taken(lease, BEN, "why", 0.0))
    asks = asked(lease, BEN, 0.0)
    assert asked(asks, BEN, 9.0) == asks  # to ask again wins no time, and loses none
    assert "Wait for 5 s more" in refused(lambda: taken(asks, BEN, "why", ANSWER - 5.0))
    assert "Give a reason" in refused(lambda: taken(asks, BEN, " ", ANSWER))
    got = taken(asks, BEN, " nobody\nthere ", ANSWER)
    assert (got.holder, got.taken_from, got.reason) == (BEN, AVA, "nobody there")
    assert "Ask for it first" in refused(lambda: taken(kept(asks, AVA), BEN, "why", ANSWER))


def test_an_engineer_takes_it_at_once_and_says_why() -> None:
    lease = acting(Lease(), AVA)
    assert "Ask for it, or take it and say why" in refused(lambda: acting(lease, EVE))
    assert "Give a reason" in refused(lambda: taken(lease, EVE, "", 0.0))
    assert is_mine(taken(lease, EVE, "it drives wrong", 0.0), EVE)


def test_an_account_takes_it_from_itself_and_a_name_without_a_password_does_not() -> None:
    desk, phone = AVA._replace(account=b"k"), AVA._replace(account=b"k", session="phone")
    lease = acting(Lease(), desk)
    told = refused(lambda: acting(lease, phone))
    assert told.startswith("You have control on another device. Take it here")
    assert is_mine(taken(lease, phone, "", 0.0), phone)
    same_name = AVA._replace(session="other")
    refused(lambda: taken(acting(Lease(), AVA), same_name, "", 0.0))


def test_who_has_gone_has_it_no_more_and_an_ask_lapses() -> None:
    lease = asked(acting(Lease(), AVA), BEN, 0.0)
    assert looked_at(lease, 0.0, 0.0, AWAY) == lease
    assert looked_at(lease, 0.0, AWAY, AWAY + 0.1) == Lease(BEN)
    gone = looked_at(acting(Lease(), AVA), 0.0, 0.0, AWAY + 0.1)
    assert is_mine(acting(gone, BEN), BEN)
    now = ASK_LASTS + 1.0
    assert looked_at(lease, now, now, now) == acting(Lease(), AVA)
    assert looked_at(lease, AWAY + 0.1, 0.0, AWAY + 0.1).ask is None


PEOPLE = st.sampled_from([AVA, BEN, EVE])
DEEDS = st.lists(
    st.tuples(st.sampled_from(["act", "ask", "take", "give", "keep"]), PEOPLE, st.floats(0, 30)),
    max_size=30,
)


@property_test(DEEDS)
def test_control_moves_by_a_gift_an_unanswered_ask_or_an_engineer_only(deeds) -> None:  # type: ignore[no-untyped-def]
    lease, now = Lease(), 0.0
    for what, person, later in deeds:
        now += later
        before = lease
        try:
            if what == "act":
                lease = acting(before, person)
            elif what == "ask":
                lease = asked(before, person, now)
            elif what == "take":
                lease = taken(before, person, "because", now)
            else:
                lease = given(before, person) if what == "give" else kept(before, person)
        except NotInControl:
            assert lease == before
            continue
        if before.holder not in (None, lease.holder):
            asks = before.ask
            waited = asks is not None and asks.person == person and now - asks.since >= ANSWER
            assert (
                (what == "give" and before.holder == person)
                or (what == "take" and (person.overrules or waited))
            )  # fmt: skip
        assert lease.ask is None or lease.ask.person != lease.holder
