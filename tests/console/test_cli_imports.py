"""The command line brings only what a command needs: heavy modules are a wait."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

# Of the server, the scene, the physics and the planner, and what numbers are crunched with.
HEAVY = {
    "PIL",
    "fastapi",
    "httpx",
    "mujoco",
    "ompl",
    "scipy",
    "starlette",
    "trimesh",
    "uvicorn",
    "viser",
    "kompass.components",
    "kompass.drills",
    "kompass.launch.launcher",
    "kompass.monitor.monitor",
    "kompass.recorder",
    "kompass.simulation.physics",
    "kompass.simulation.worlds",
    "kompass_console.server",
}
OF_ROS = {"rclpy", "rosidl_generator_py"}
OF_RULES = {"kompass.monitor.client", "kompass.rules", "kompass.rulebook"}
OF_OTHERS = {"yaml"}


def loaded(code: str) -> set[str]:
    """Names of the modules that an interpreter has after some code."""
    told = f"{code}\nimport json, sys\nprint(json.dumps(list(sys.modules)))"
    run = subprocess.run([sys.executable, "-c", told], capture_output=True, text=True, check=True)
    return set(json.loads(run.stdout.splitlines()[-1]))


def run(*words: str) -> str:
    """Code that runs a command up to where it would look for a robot."""
    return f"""
import sys
from kompass_console import cli
from kompass_console.rules_cli.options import RobotOptions
class Looking(Exception): pass
def look(robot): raise Looking
RobotOptions.connect = RobotOptions.look = look
sys.argv = {["kompass-console", *words]!r}
try:
    cli.main()
except Looking:
    pass
"""


def test_showing_rules_brings_neither_server_nor_scene_nor_physics() -> None:
    everything = f"{run('rules', 'show')}\nimport kompass_console.rules_cli.connection"
    modules = loaded(f"{everything}\nimport kompass.monitor.client")
    assert modules & HEAVY == set()
    assert OF_ROS & modules, "it is ROS that it asks"


@pytest.mark.parametrize("unneeded", [OF_ROS, OF_OTHERS], ids=["ROS", "what other commands need"])
def test_a_command_is_understood_without_what_it_does_not_need(unneeded: set[str]) -> None:
    assert loaded(run("rules", "firings")) & unneeded == set()


def test_rules_of_this_machine_are_shown_without_ros_and_numbers() -> None:
    shown = f"{run('rules', 'show')}\nimport kompass_console.rules_cli.looking"
    everything = f"{shown}\nimport kompass_console.rules_cli.printing"
    assert loaded(everything) & (HEAVY | OF_ROS | {"numpy"}) == set()


def test_the_search_for_the_robot_begins_before_rules_are_known() -> None:
    assert loaded("import kompass_console.rules_cli.connection") & OF_RULES == set()


def test_a_robot_starts_without_what_it_needs_only_to_fit_a_response() -> None:
    robot = "import kompass.ros, kompass.launch.launcher, kompass.monitor.process"
    assert loaded(robot) & {"scipy.optimize", "scipy.signal", "scipy.stats"} == set()


def test_ctrl_c_during_the_imports_ends_the_command_without_a_traceback(tmp_path: Path) -> None:
    (tmp_path / "typer.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n")
    ended = subprocess.run(
        [sys.executable, "-m", "kompass_console", "--help"],
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "")
