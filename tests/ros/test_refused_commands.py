"""A command that cannot run says why, in a line."""

import socket
from pathlib import Path

import pytest

from tests.support.stack import RECIPE, Stack

pytestmark = pytest.mark.ros


def one_line(stack: Stack) -> str:
    """The only thing that a command which could not run may say, after its addresses."""
    said = [line for line in stack.output.splitlines() if line and not line.startswith("  ")]
    assert len(said) == 1, stack.output
    return said[0]


def test_a_port_in_use_is_told_in_one_line() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        refused = Stack("demo", "--no-browser", "--port", port)
        assert refused.wait() == 2
    assert f"port {port}" in one_line(refused)
    assert "--port" in one_line(refused)


def test_a_missing_recipe_is_told_in_one_line() -> None:
    refused = Stack("run", "nowhere.py", "--no-browser", "--port", "0")
    assert refused.wait() == 2
    assert "nowhere.py" in one_line(refused)


def test_an_error_in_a_recipe_names_file_and_line(tmp_path: Path) -> None:
    recipe = tmp_path / "mine.py"
    recipe.write_text("import numpy\n\nraise ValueError('two\\nlines')\n")
    refused = Stack("run", str(recipe), "--no-browser", "--port", "0")
    assert refused.wait() == 3
    assert "mine.py:3: ValueError: two lines" in one_line(refused)


def test_another_middleware_is_told_in_one_line() -> None:
    refused = Stack(
        "run", str(RECIPE), "--no-browser", "--port", "0", RMW_IMPLEMENTATION="rmw_other_cpp"
    )
    assert refused.wait() == 1
    assert "RMW_IMPLEMENTATION=rmw_other_cpp" in one_line(refused)


def test_an_unknown_world_lists_the_known_ones() -> None:
    refused = Stack("run", str(RECIPE), "--sim", "atlantis", "--no-browser", "--port", "0")
    assert refused.wait() == 2
    assert "hexagon" in one_line(refused)


def test_a_fault_that_only_a_camera_sees_is_refused_where_the_recipe_has_none() -> None:
    command = ("--sim", "--fault", "low_box:9", "--no-browser", "--port", "0")
    refused = Stack("run", str(RECIPE), *command)
    assert refused.wait() == 2
    assert "--fault: fault 'low_box': the robot turtlebot3 has no camera" in one_line(refused)
    # The robot is the one that has the recipe's sensors.
    several = Stack("run", str(RECIPE.with_name("09_several_sensors.py")), *command)
    try:
        several.wait_for_line("all components active", 30)
    finally:
        assert several.close() == 0, several.output


def test_a_short_token_is_refused() -> None:
    refused = Stack("demo", "--no-browser", "--port", "0", "--token", "short")
    assert refused.wait() == 2
    assert "--token" in one_line(refused)
