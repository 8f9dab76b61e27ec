"""Every recipe that comes with the project runs, and a click drives the robot there."""

from collections.abc import Iterator

import pytest

from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import RECIPE, Stack

pytestmark = pytest.mark.ros

# Stacks of these run for tests that click too: test_navigation.py, test_own_components.py,
# test_patrol.py.
ELSEWHERE = ("01_point_navigation", "07_own_components", "08_patrol", "09_several_sensors")
BY_RULE = (
    "03_events_and_actions"  # a rule makes a goal of a click, where the planner does elsewhere
)
RECIPES = sorted(path for path in RECIPE.parent.glob("0*.py") if path.stem not in ELSEWHERE)


@pytest.fixture(params=RECIPES, ids=lambda path: path.stem)
def robot(request: pytest.FixtureRequest) -> Iterator[Robot]:
    stack = Stack.simulated(recipe=request.param)
    try:
        client = Robot(stack.domain)
        try:
            client.ready()
            yield client
        finally:
            client.close()
    finally:
        assert stack.close() == 0, stack.output


def drives_to_a_click(robot: Robot, taker: str = "planner") -> None:
    robot.click(-1.6, 0.0, taker)
    wait_until(lambda: robot.distance_to(-1.6, 0.0) < 0.10, 45, "arrival at the clicked point")
    assert robot.contacts == 0


def test_a_click_drives_the_robot_there(robot: Robot, request: pytest.FixtureRequest) -> None:
    by_rule = request.node.callspec.params["robot"].stem == BY_RULE
    drives_to_a_click(robot, "monitor" if by_rule else "planner")
