"""A test of the base in real processes, over DDS: begun by a message, told to whoever asks."""

import json
import re
from contextlib import closing
from pathlib import Path

import pytest
from std_msgs.msg import Bool, String

from tests.support.motion_recipe import motion_recipe
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot
from tests.support.stack import Stack

pytestmark = pytest.mark.ros

WARNING = re.compile(r"\[WARN\].*\[motion_server\]: .*")  # also why no test was driven


def test_a_test_of_the_base_is_driven_and_its_fit_is_told(tmp_path: Path) -> None:
    recipe = motion_recipe(tmp_path, 1.5, "run_step_test=True, run_circle_test=False")
    with (
        closing(Stack.simulated(recipe=recipe, ROS_DISTRO="jazzy")) as stack,
        closing(Robot(stack.domain)) as robot,
    ):
        robot.subscribe(String, "/motion_server/fit", LATCHED)
        robot.ready()
        robot.can_be_tested()
        began = robot.truth
        asks = robot.node.create_publisher(Bool, "/run_tests", 10)
        robot.wait_for_listeners("/run_tests", "motion_server")
        asks.publish(Bool(data=True))
        wait_until(
            lambda: "/motion_server/fit" in robot.newest or WARNING.search(stack.output),
            40,
            f"the fit, or why there is none:\n{stack.output}",
        )
        assert not WARNING.search(stack.output), stack.output
        told = json.loads(robot.newest["/motion_server/fit"].data)
        assert told["axes"]["vx"]["gain"] == pytest.approx(1.0, abs=0.1)
        assert told["axes"]["omega"]["explained"] > 0.9
        assert stack.data_dir in Path(told["file"]).parents
        assert robot.distance_to(*began[:2]) < 0.15
        assert robot.contacts == 0
