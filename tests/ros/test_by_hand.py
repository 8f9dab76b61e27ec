"""A robot that is driven by hand stands when the hand is not heard, whatever hangs or dies."""

import os
import signal
import time
from collections.abc import Iterator
from contextlib import closing

import pytest

from kompass.components.drive.wheel import DEAD_MAN
from tests.support.driver import Driver
from tests.support.hand_page import HandPage
from tests.support.hosts import two_hosts
from tests.support.processes import held, wait_until
from tests.support.stack import Stack

pytestmark = pytest.mark.ros

STAYS = 1.5  # s for which it is watched
STANDING = 0.01  # m; ground truth is some of them behind


@pytest.fixture
def robot(stack: Stack) -> Iterator[Driver]:
    with closing(Driver(stack.domain)) as client:
        client.ready()
        yield client


@pytest.fixture
def page(stack: Stack, robot: Driver) -> Iterator[HandPage]:
    """A page at the wheel of a robot that turns on the spot, where there is always room."""
    with HandPage(stack.url) as opened:
        turn(opened, robot)
        yield opened


def turn(page: HandPage, robot: Driver) -> None:
    """The robot turns, by hand."""
    wait_until(lambda: is_free(robot), 15, "a free wheel")
    page.take()
    page.hold(omega=0.8)
    wait_until(lambda: turning(robot) > 0.3, 10, "motion")


def is_free(robot: Driver) -> bool:
    """Whether nobody has the wheel."""
    state = robot.newest.get("/drive_state")
    return state is not None and not state.driven_by


def turning(robot: Driver) -> float:
    """How fast it really turns [rad/s]."""
    return float(abs(robot.newest["/simulator/ground_truth"].twist.twist.angular.z))


def stands(robot: Driver, after: float = 0.0) -> None:
    """It comes to a standstill, so many seconds from now at the earliest, and stays there."""
    begun = time.monotonic()
    wait_until(lambda: time.monotonic() - begun >= after and robot.halts(), 5, "a zero twist")
    wait_until(lambda: turning(robot) < STANDING, 5, "a standstill")
    yaw = robot.truth[2]
    assert max(abs(at[2] - yaw) for at in robot.watch(STAYS)) < 0.02
    assert robot.halts()


def stands_after_the_cut(robot: Driver) -> None:
    """As `stands`, of a hand that has just been cut off: on a busy machine the robot may have stood
    before that for a word that came late, and is to obey it for as long as a hand counts."""
    stands(robot, after=DEAD_MAN)


def test_it_stands_when_the_page_says_nothing_any_more(robot: Driver, page: HandPage) -> None:
    page.fall_silent()
    stands_after_the_cut(robot)


def test_it_stands_while_a_signal_holds_the_console_and_does_not_catch_up_after_it(
    stack: Stack, robot: Driver, page: HandPage
) -> None:
    with held(stack.pid_of("console")):
        stands_after_the_cut(robot)  # and the page goes on
        page.fall_silent()
    stands(robot)


def test_it_does_not_catch_up_after_a_signal_has_held_the_drive_manager(
    stack: Stack, robot: Driver, page: HandPage
) -> None:
    with held(stack.pid_of("drive_manager")):
        stands_after_the_cut(robot)
        page.fall_silent()
    stands(robot)


def test_it_stands_when_the_console_is_killed_and_nobody_has_the_wheel_then(
    stack: Stack, robot: Driver, page: HandPage
) -> None:
    os.kill(stack.pid_of("console"), signal.SIGKILL)
    stands_after_the_cut(robot)
    wait_until(lambda: is_free(robot), 15, "a free wheel")


def test_it_stands_when_the_cable_is_pulled_out_and_does_not_catch_up_when_it_is_in_again() -> None:
    with two_hosts() as (near, far), near.inside():
        stack = Stack.simulated("--host", near.address)
        with closing(stack), closing(Driver(stack.domain)) as robot:
            robot.ready()
            with far.inside():
                opened = HandPage(stack.url)
            with opened as page:
                turn(page, robot)
                far.plug(False)
                stands_after_the_cut(robot)
                page.fall_silent()
                far.plug(True)
                stands(robot)
