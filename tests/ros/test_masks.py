"""A mask of a recipe is in force in real processes, which read its file themselves."""

from contextlib import closing
from pathlib import Path

import pytest
from kompass_interfaces.srv import CheckGoal

from tests.support.robot import Robot
from tests.support.stack import Stack
from tests.support.tester import pose
from tests.zones.masks import mask_file, masked_recipe

pytestmark = pytest.mark.ros


def test_a_goal_in_a_mask_is_refused_by_its_name(tmp_path: Path) -> None:
    mask = mask_file(tmp_path, "\n".join(["#" * 10] * 11), 0.05, (-1.4, -0.8, 0.0))
    with (
        closing(Stack.simulated(recipe=masked_recipe(tmp_path, mask))) as stack,
        closing(Robot(stack.domain)) as robot,
    ):
        robot.ready()
        request = CheckGoal.Request(goal=pose(-1.15, -0.5, 0.0))
        answer = robot.call(CheckGoal, "/planner/check_goal", request)
        assert not answer.reachable
        assert "inside the keep-out zone 'Stairs'" in answer.message
