"""STOP is remembered, and standstill is measured."""

import os

from kompass.algorithms.safety.standstill import Standstill
from kompass.components.drive.stop_latch import StopLatch


def test_a_latched_stop_says_who_and_why() -> None:
    latch = StopLatch()
    assert not latch.is_set
    latch.set("ava", "somebody in the way")
    assert (latch.is_set, latch.operator, latch.reason) == (True, "ava", "somebody in the way")


def test_the_first_to_press_is_remembered() -> None:
    latch = StopLatch()
    latch.set("ava", "one")
    latch.set("ben", "two")
    assert latch.operator == "ava"


def test_stop_survives_the_death_of_the_process_that_set_it() -> None:
    latch = StopLatch()
    pid = os.fork()
    if pid == 0:
        latch.set("ava", "")
        os.kill(os.getpid(), 9)
    os.waitpid(pid, 0)
    assert latch.is_set


def test_a_name_of_any_length_fits() -> None:
    latch = StopLatch()
    latch.set("é" * 1000, "")
    assert latch.operator.startswith("éé")


def test_standstill_needs_a_while_at_zero() -> None:
    standstill = Standstill()
    standstill.update((0.2, 0.0, 0.0), now=0.0)
    standstill.update((0.0, 0.0, 0.0), now=0.1)
    assert not standstill.reached(0.2, newest_allowed=0.5)
    standstill.update((0.0, 0.0, 0.0), now=0.45)
    assert standstill.reached(0.5, newest_allowed=0.5)


def test_standstill_is_unknown_without_fresh_odometry() -> None:
    standstill = Standstill()
    for step in range(10):
        standstill.update((0.0, 0.0, 0.0), now=0.1 * step)
    assert not standstill.reached(5.0, newest_allowed=0.5)


def test_turning_on_the_spot_is_no_standstill() -> None:
    standstill = Standstill()
    for step in range(10):
        standstill.update((0.0, 0.0, 0.3), now=0.1 * step)
    assert not standstill.reached(0.95, newest_allowed=0.5)
