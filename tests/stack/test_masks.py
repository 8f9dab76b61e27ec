"""Masks of a recipe on a whole robot: kept out of, slower in, whoever drives, from the first on."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from kompass_interfaces.srv import CheckGoal
from std_msgs.msg import String

from kompass.zones.in_force import Outlines
from kompass.zones.mask import MasksNow
from tests.support.hand import Hand
from tests.support.tester import LATCHED, pose
from tests.support.virtual_robot import VirtualRobot
from tests.zones.masks import mask_file, masked_recipe

SUCCEEDED = 4
RADIUS = 0.105  # m, of the robot
SLACK = 0.03  # m; edges are points, and what is seen of the robot is a step old
# Across the straight way from the start to the goal, between two rows of pillars.
LOW = (-1.4, -0.8, 0.0)
ACROSS = ((-1.4, -0.8), (-0.9, -0.8), (-0.9, -0.25), (-1.4, -0.25))
CELLS = "\n".join(["#" * 10] * 11)  # of 5 cm
BEYOND = (-0.3, -0.55)

Make = Callable[..., VirtualRobot]


@pytest.fixture
def made(tmp_path: Path) -> Iterator[Make]:
    """Make a robot whose recipe has a mask."""
    with ExitStack() as ending:

        def make(
            drawn: str = CELLS, origin: tuple[float, float, float] = LOW, **fields: Any
        ) -> VirtualRobot:
            file = mask_file(tmp_path, drawn, 0.05, origin)
            return ending.enter_context(
                closing(VirtualRobot(masked_recipe(tmp_path, file, **fields)))
            )

        yield make


def clearance(robot: VirtualRobot) -> float:
    """Between the body and the mask [m]."""
    return float(Outlines([ACROSS]).distance(*robot.truth[:2])[0]) - RADIUS


def check(robot: VirtualRobot, x: float, y: float) -> CheckGoal.Response:
    request = CheckGoal.Request(goal=pose(x, y, 0.0))
    return robot.call(CheckGoal, "/planner/check_goal", request)


def hand(robot: VirtualRobot) -> Hand:
    ava = Hand(robot, "ava")
    robot.wait_until(lambda: ava.ask().success, 20, "the wheel")
    ava.take()
    robot.rest(0.5)
    return ava


def test_it_drives_round_a_mask_and_refuses_goals_in_it_by_its_name(made: Make) -> None:
    robot = made()
    robot.ready()
    answer = check(robot, -1.15, -0.5)
    assert not answer.reachable
    assert "inside the keep-out zone 'Stairs'" in answer.message
    handle = robot.send_goal(*BEYOND)
    least = math.inf

    def there() -> bool:
        nonlocal least
        least = min(least, clearance(robot))
        return robot.distance_to(*BEYOND) < 0.1

    robot.wait_until(there, 120, "the robot behind the mask")
    assert robot.result(handle, 30).status == SUCCEEDED
    assert least > 0.0
    assert robot.contacts == 0


def test_a_hand_is_held_at_its_edge_also_without_a_monitor(made: Make) -> None:
    robot = made()
    robot.ready()
    robot.stack.kill("monitor")
    ava = hand(robot)
    ava.vx = 0.2
    robot.wait_until(
        lambda: robot.newest["/drive_state"].limited_by == "keep-out zone", 20, "its edge"
    )
    robot.rest(2.0)
    assert -SLACK < clearance(robot) < 0.15


def test_a_drive_manager_that_comes_anew_keeps_to_a_mask_whose_files_are_gone(
    made: Make, tmp_path: Path
) -> None:
    robot = made()
    robot.ready()
    (tmp_path / "mask.yaml").unlink()
    (tmp_path / "mask.png").unlink()
    robot.stack.kill("drive_manager")
    ava = hand(robot)
    ava.vx = 0.2
    robot.wait_until(
        lambda: robot.newest["/drive_state"].limited_by == "keep-out zone", 20, "its edge"
    )
    assert robot.stop().success


@pytest.mark.parametrize(
    "fields",
    [{"kind": "speed", "multiplier": 0.001}, {"kind": 1, "multiplier": 0.5, "base": -4.5455}],
    ids=["metres per second", "percent"],
)
def test_no_one_is_faster_in_a_mask_of_speeds_than_it_says(
    made: Make, fields: dict[str, Any]
) -> None:
    """0.1 m/s, which is 45 % of the 0.22 m/s that the recipe allows."""
    robot = made(**fields)
    robot.ready()
    robot.send_goal(*BEYOND)
    robot.wait_until(lambda: robot.speed > 0.18, 20, "a robot that is quick")
    robot.wait_until(lambda: clearance(robot) == -RADIUS, 60, "its middle in the mask")
    robot.wait_until(
        lambda: robot.newest["/drive_state"].limited_by == "speed zone", 5, "the limit"
    )
    inside = []

    def out() -> bool:
        if clearance(robot) < -SLACK:
            inside.append(robot.speed)
        return clearance(robot) > 0.05

    robot.wait_until(out, 60, "the way out")
    assert 0.08 < max(inside) < 0.115


def test_a_mask_beside_the_map_is_told_and_no_goal_is_taken(made: Make) -> None:
    robot = made(origin=(50.0, 0.0, 0.0))
    robot.subscribe(ComponentStatus, "/planner/status", LATCHED)
    robot.wait_until(
        lambda: robot.newest.get("/planner/status", ComponentStatus()).status == 3, 20, "a failure"
    )
    told = "The mask 'Stairs' does not lie on the map: its origin is (50, 0) m"
    assert told in robot.newest["/planner/status"].msg
    assert told in check(robot, *BEYOND).message


def test_a_recipe_whose_mask_cannot_be_read_does_not_come_up(made: Make) -> None:
    with pytest.raises(ValueError, match=r"file = 'none\.yaml' cannot be read"):
        made(file="none.yaml")


def test_who_draws_them_is_told_where_they_are(made: Make) -> None:
    robot = made()
    robot.subscribe(String, "/masks", LATCHED)
    robot.wait_until(lambda: "/masks" in robot.newest, 20, "the masks")
    (mark,) = MasksNow.model_validate_json(robot.newest["/masks"].data).masks
    assert (mark.name, mark.speed) == ("Stairs", None)
    assert sorted(mark.corners) == sorted(ACROSS)
