"""The wheel obeys one hand, as long as it is there, and nothing that is old or of another."""

import math
from types import SimpleNamespace
from typing import Any

import pytest

from kompass.components.drive.wheel import (
    DEAD_MAN,
    INTERRUPTED,
    LAPSE,
    LATE,
    LOOK,
    NO_NUMBER,
    NOT_AT_THE_WHEEL,
    NOT_SIGNED,
    REPEATED,
    SILENT,
    Wheel,
)

AHEAD = (0.2, 0.0, 0.5)
STILL = (0.0, 0.0, 0.0)
OFFSET = 1000.0  # s by which the sender's clock is ahead of ours


class Driver:
    """Sends commands, which take 10 ms, from a clock of its own."""

    def __init__(self, wheel: Wheel, now: float, session: str = "ava's") -> None:
        self.wheel, self.session = wheel, session
        self.sequence = 0
        wheel.take("ava", session, lambda command: getattr(command, "genuine", True), now)

    def command(self, at: float, twist: tuple[float, float, float] = AHEAD, **more: Any) -> Any:
        self.sequence += 1
        vx, vy, omega = twist
        fields = {"session": self.session, "sequence": self.sequence, "sent": at + OFFSET}
        return SimpleNamespace(**(fields | {"vx": vx, "vy": vy, "omega": omega} | more))

    def drive(self, at: float, *given: Any, under_way: float = 0.01, **more: Any) -> str:
        return self.wheel.hear(self.command(at, *given, **more), at + under_way)


@pytest.fixture
def wheel() -> Wheel:
    return Wheel()


@pytest.fixture
def ava(wheel: Wheel) -> Driver:
    """At the wheel since 9.9, with nothing in the hand."""
    driver = Driver(wheel, 9.9)
    assert driver.drive(9.9, STILL) == driver.drive(10.0, STILL) == ""
    return driver


def test_the_hand_drives_while_it_renews_its_command(wheel: Wheel, ava: Driver) -> None:
    for tick in range(1, 20):
        assert ava.drive(10.0 + 0.1 * tick) == ""
        assert wheel.wanted(10.09 + 0.1 * tick) == AHEAD
    assert wheel.driver == "ava"


def test_without_a_command_nothing_is_wanted_before_the_promised_time(
    wheel: Wheel, ava: Driver
) -> None:
    ava.drive(10.1)
    assert wheel.wanted(10.11 + SILENT - 0.001) == AHEAD
    assert wheel.wanted(10.11 + SILENT + 0.001) is None
    assert wheel.is_cut(10.11 + SILENT + 0.001)
    assert SILENT + LOOK <= DEAD_MAN


def test_silence_after_letting_go_cuts_nothing(wheel: Wheel, ava: Driver) -> None:
    ava.drive(10.1)
    ava.drive(10.2, STILL)
    assert not wheel.is_cut(11.0)


def test_who_takes_the_wheel_with_the_stick_in_the_hand_lets_go_first(wheel: Wheel) -> None:
    ava = Driver(wheel, 10.0)
    ava.drive(10.0)
    assert wheel.wanted(10.02) == STILL
    assert wheel.is_kept_back(10.02)
    ava.drive(10.1, STILL)
    ava.drive(10.2, STILL)
    ava.drive(10.3)
    assert wheel.wanted(10.32) == AHEAD
    assert not wheel.is_kept_back(10.32)


def test_what_somebody_else_says_once_for_a_hand_he_does_not_hear_is_no_letting_go(
    wheel: Wheel, ava: Driver
) -> None:
    ava.drive(10.1)
    ava.drive(10.1 + 2 * INTERRUPTED, STILL)  # the console, when it wakes up
    ava.drive(10.2 + 2 * INTERRUPTED)  # and a hand that has held the stick all the time
    assert wheel.wanted(10.22 + 2 * INTERRUPTED) == STILL


def test_what_was_held_through_a_stop_is_let_go_first(wheel: Wheel, ava: Driver) -> None:
    ava.drive(10.1)
    wheel.let_go()
    for tick in range(2, 8):
        ava.drive(10.0 + 0.1 * tick)
        assert wheel.wanted(10.02 + 0.1 * tick) == STILL
    ava.drive(10.8, STILL)
    ava.drive(10.9, STILL)
    ava.drive(11.0)
    assert wheel.wanted(11.02) == AHEAD


def test_a_short_interruption_is_driven_through_and_after_a_long_one_is_let_go_first(
    wheel: Wheel, ava: Driver
) -> None:
    ava.drive(10.1)
    ava.drive(10.1 + INTERRUPTED - 0.1)
    assert wheel.wanted(10.1 + INTERRUPTED) == AHEAD
    ava.drive(10.1 + 2 * INTERRUPTED)
    assert wheel.wanted(10.2 + 2 * INTERRUPTED) == STILL


@pytest.mark.parametrize(
    ("more", "why"),
    [
        ({"session": "ben's"}, NOT_AT_THE_WHEEL),
        ({"genuine": False}, NOT_SIGNED),
        ({"sequence": 1}, REPEATED),
        ({"vx": math.nan}, NO_NUMBER),
        ({"omega": math.inf}, NO_NUMBER),
        ({"sent": math.nan}, NO_NUMBER),
    ],
)
def test_what_is_not_of_this_hand_or_no_command_moves_nothing(
    wheel: Wheel, ava: Driver, more: dict[str, Any], why: str
) -> None:
    assert ava.drive(10.1, **more) == why
    assert wheel.wanted(10.12) == STILL


def test_a_forged_sequence_number_does_not_shut_the_true_hand_out(
    wheel: Wheel, ava: Driver
) -> None:
    ava.drive(10.1, sequence=10**9, genuine=False)
    assert ava.drive(10.2) == ""
    assert wheel.wanted(10.22) == AHEAD


def test_what_lay_in_a_socket_does_not_drive_though_it_comes_now(wheel: Wheel, ava: Driver) -> None:
    ava.drive(10.1)
    queued = [ava.command(10.2 + 0.1 * number) for number in range(10)]
    assert [wheel.hear(one, 12.0) for one in queued] == [LATE] * 10
    assert wheel.wanted(12.0) is None


def test_a_command_that_was_under_way_for_long_holds_for_what_is_left(
    wheel: Wheel, ava: Driver
) -> None:
    ava.drive(10.1)
    assert ava.drive(10.2, under_way=0.15) == ""
    assert wheel.wanted(10.36) == AHEAD
    assert wheel.wanted(10.45) is None


def test_clocks_that_drift_apart_make_no_command_late(wheel: Wheel, ava: Driver) -> None:
    for tick in range(36_000):  # an hour in which the sender's clock loses 0.18 s
        now = 10.0 + 0.1 * tick
        assert wheel.hear(ava.command(now - 5e-5 * (now - 10.0)), now + 0.01) == ""


def test_another_who_takes_over_ends_the_hold_of_the_first(wheel: Wheel, ava: Driver) -> None:
    ava.drive(10.1)
    wheel.take("ben", "ben's", lambda _: True, 10.2)
    assert wheel.driver == "ben"
    assert wheel.wanted(10.21) == STILL
    assert ava.drive(10.3) == NOT_AT_THE_WHEEL


def test_a_wheel_that_was_given_up_moves_nothing(wheel: Wheel, ava: Driver) -> None:
    ava.drive(10.1)
    wheel.give()
    assert ava.drive(10.2) == NOT_AT_THE_WHEEL
    assert (wheel.driver, wheel.wanted(10.2)) == ("", None)
    assert not wheel.has_lapsed(100.0)


def test_a_wheel_of_which_nothing_is_heard_lapses(wheel: Wheel, ava: Driver) -> None:
    ava.drive(10.1)
    assert not wheel.has_lapsed(10.1 + LAPSE - 0.1)
    assert wheel.has_lapsed(10.2 + LAPSE)
