"""Components of a user's own, in a whole stack where one of them breaks."""

from collections.abc import Iterator

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from std_msgs.msg import Int32
from std_srvs.srv import SetBool

from tests.support.own_stack import started
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot
from tests.support.stack import RECIPE, Stack

pytestmark = pytest.mark.ros

HEALTHY, COMPONENT = 0, 2


@pytest.fixture(scope="module")
def mending() -> Iterator[tuple[Stack, Robot]]:
    recipe = RECIPE.parents[1] / "tests" / "recipes" / "mending_components.py"
    stack = Stack.active(recipe)
    for client in started(stack):
        yield stack, client


def test_one_that_raises_says_so_is_mended_by_its_fallback_and_the_others_go_on(
    mending: tuple[Stack, Robot],
) -> None:
    stack, robot = mending
    heard: list[ComponentStatus] = []
    counts: list[int] = []
    robot.node.create_subscription(ComponentStatus, "/flaky/status", heard.append, LATCHED)
    robot.node.create_subscription(Int32, "/count", lambda told: counts.append(told.data), 10)
    wait_until(lambda: heard and counts, 10, "both components")
    pids = [stack.pid_of(name) for name in ("flaky", "steady")]
    assert robot.call(SetBool, "/flaky/set_bool", SetBool.Request(data=True)).success
    wait_until(lambda: heard[-1].status == COMPONENT, 5, "the failure")
    assert "OSError: the device is gone" in heard[-1].msg
    wait_until(lambda: heard[-1].status == HEALTHY, 15, "the fallback's mending")
    before = counts[-1]
    wait_until(lambda: counts[-1] > before + 3, 5, "the other one's work")
    assert pids == [stack.pid_of(name) for name in ("flaky", "steady")], "nothing died"
    assert counts == sorted(counts), "the other one has never begun anew"
