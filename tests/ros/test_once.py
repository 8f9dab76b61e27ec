"""A rule that fires once is not used up by a hiccup, and fires when it is meant."""

import os
import signal
import time
from collections.abc import Iterator
from contextlib import closing, suppress

import pytest
from automatika_ros_sugar.msg import ComponentStatus

from tests.support.journal import Journal
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.rules import Rules
from tests.support.stack import RECIPE, Stack

pytestmark = pytest.mark.ros
HEALING = RECIPE.with_name("04_cross_component_healing.py")
LATE = 0.2  # s, as was seen of a mapper under load


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    with closing(Stack.simulated(recipe=HEALING)) as running:
        yield running


def test_a_late_mapper_does_not_use_up_the_rule_that_its_death_fires(
    stack: Stack, robot: Robot
) -> None:
    journal, rules = Journal(robot), Rules(robot)
    statuses: list[int] = []
    robot.node.create_subscription(
        ComponentStatus, "/mapper/status", lambda message: statuses.append(message.status), 10
    )
    wait_until(lambda: 0 in statuses, 10, "a healthy mapper")
    mapper = stack.pid_of("mapper")
    os.kill(mapper, signal.SIGSTOP)
    try:
        wait_until(lambda: any(statuses), 10, "the failure of the mapper")
        time.sleep(LATE)
    finally:
        os.kill(mapper, signal.SIGCONT)
    wait_until(lambda: statuses[-1] == 0, 10, "the mapper's health")
    assert journal.of("mapper-lost", "fired") == []
    assert rules.status("mapper-lost").state != "used up"

    # One that is back within the hold of half a second has not been lost; this one stays away.
    def is_done() -> bool:
        with suppress(ProcessLookupError):
            os.kill(stack.pid_of("mapper"), signal.SIGKILL)
        return bool(journal.of("mapper-lost", "done"))

    wait_until(is_done, 10, "the end of a run of the rule")
    assert journal.done("mapper-lost").ok
    assert rules.status("mapper-lost").state == "used up"
