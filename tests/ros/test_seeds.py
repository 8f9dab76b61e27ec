"""The recipes of the two published documents run unchanged, byte for byte."""

import os
import re
import signal
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from kompass_interfaces.msg import RuleFiring

from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot
from tests.support.rules import Rules
from tests.support.stack import Stack

pytestmark = pytest.mark.ros

# The documents are not ours to ship; they lie beside the checkout where there are any.
DOCUMENTS = Path(__file__).parents[3] / "shared" / "seeds"
SEEDS = {"S1": "events_actions_tutorial.txt", "S2": "cross_component_healing.txt"}


def recipe_of(document: str) -> str:
    """The complete recipe of a document: the listing whose lines are numbered from 1."""
    lines: list[str] = []
    for line in document.splitlines():
        found = re.match(rf"^ *{len(lines) + 1}(?!\d)(.*)$", line)
        if found and (lines or line.startswith("  1import")):
            lines.append(found[1])
    return "\n".join(lines) + "\n"


class Run(NamedTuple):
    """Which recipe, and whether all of it is put into one process, though it asks for several."""

    name: str
    single: bool = False


GOAL = (-1.6, 0.0)
RUNS = [Run("S1"), Run("S2"), Run("S1", single=True), Run("S2", single=True)]
IDS = ["S1", "S2", "S1-threads", "S2-threads"]


@pytest.fixture(scope="module", params=RUNS, ids=IDS)
def run(request: pytest.FixtureRequest) -> Run:
    return request.param  # type: ignore[no-any-return]


@pytest.fixture(scope="module")
def recipe(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    if not DOCUMENTS.is_dir():
        pytest.skip(f"the two documents are not in {DOCUMENTS}")
    path = tmp_path_factory.mktemp("seeds") / f"{run.name}.py"
    path.write_text(recipe_of((DOCUMENTS / SEEDS[run.name]).read_text()))
    return path


@pytest.fixture(scope="module")
def stack(run: Run, recipe: Path) -> Iterator[Stack]:
    with closing(Stack.simulated(*["--single-process"] * run.single, recipe=recipe)) as running:
        yield running


def test_a_clicked_point_drives_the_robot_there_and_the_goal_succeeds(
    stack: Stack, robot: Robot, run: Run
) -> None:
    assert ("components is process" in stack.output) == run.single
    firings: list[RuleFiring] = []
    robot.node.create_subscription(RuleFiring, "/monitor/firings", firings.append, 100)
    robot.click(*GOAL, taker="monitor")
    wait_until(lambda: robot.distance_to(*GOAL) < 0.10, 40, "arrival at the clicked point")
    wait_until(
        lambda: any(f.phase == "done" and "rviz" in f.rule_id for f in firings),
        20,
        "the end of the rule's run",
    )
    ended = next(f for f in firings if f.phase == "done" and "rviz" in f.rule_id)
    assert ended.ok, ended.text
    assert "Got new goal point" in stack.output
    assert robot.contacts == 0


def test_a_killed_mapper_switches_the_controller_to_the_sensor_once(
    stack: Stack, robot: Robot, run: Run
) -> None:
    if run.name != "S2" or run.single:
        return  # only that recipe has a rule for it, and only a process of its own can be killed
    robot.subscribe(ComponentStatus, "/mapper/status", LATCHED)
    rules = Rules(robot)
    (rule_id,) = (each["id"] for each in rules.rules() if "mapper" in each["id"])
    # On a busy machine a mapper is late now and then, and a rule without a hold fires already then.
    if rules.status(rule_id).state == "used up":
        assert rules.reset(rule_id).success
    firings: list[RuleFiring] = []
    robot.node.create_subscription(RuleFiring, "/monitor/firings", firings.append, 100)
    handle = robot.send_goal(-0.55, 0.55)
    wait_until(lambda: robot.speed > 0.1, 15, "motion")
    os.kill(stack.pid_of("mapper"), signal.SIGKILL)
    wait_until(lambda: any("mapper" in f.rule_id for f in firings), 5, "the rule's firing")
    assert robot.result(handle).status == 4
    fired = [f for f in firings if "mapper" in f.rule_id and f.phase == "fired"]
    assert len(fired) == 1
    done = [f for f in firings if "mapper" in f.rule_id and f.phase == "done"]
    assert [f.ok for f in done] == [True], [f.text for f in done]
