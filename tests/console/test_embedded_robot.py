"""Which embedded robot drives is chosen by name, and only by one that there is."""

from typing import cast

import pytest

from kompass.share import recipe_path
from kompass_console.cli_error import CliError
from kompass_console.stack import ConsoleListener, run_recipe

RECIPE = recipe_path("01_point_navigation.py")


@pytest.mark.parametrize(
    ("sim", "robot", "said"),
    [
        (
            "hexagon",
            "husky",
            "--robot husky: there is no such robot; known are turtlebot3, jackal, turtlebot3-plus, "
            "ackermann, omni",
        ),
        (None, "jackal", "--robot jackal is for the embedded robot; add --sim"),
    ],
)
def test_a_robot_that_cannot_be_meant_is_refused(sim: str | None, robot: str, said: str) -> None:
    with pytest.raises(CliError) as refused:
        run_recipe(RECIPE, cast("ConsoleListener", None), sim, [], robot)
    assert (refused.value.code, str(refused.value)) == (2, said)
