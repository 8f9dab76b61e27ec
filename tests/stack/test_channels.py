"""What rules ask of components, in virtual time as over the channels of real processes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from std_msgs.msg import String

from tests.support.journal import Journal, Step
from tests.support.virtual_robot import VirtualRobot

pytestmark = pytest.mark.ros
RECIPE = Path(__file__).parents[1] / "recipes" / "asked_robot.py"
SOON = 0.1  # s


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[VirtualRobot]:
    with closing(VirtualRobot(RECIPE, LAB_FOLDER=str(tmp_path))) as client:
        client.rest(SOON)  # until the monitor has been told who is up
        yield client


def ask(robot: VirtualRobot, journal: Journal, topic: str, text: str) -> None:
    """Make a rule fire that asks the worker."""
    since = journal.mark
    publisher = robot.node.create_publisher(String, f"/{topic}", 10)
    robot.wait_until(publisher.get_subscription_count, 5, "the monitor")
    publisher.publish(String(data=text))
    robot.wait_until(lambda: journal.of(topic, "fired", since), 5, "a firing")


def answer(robot: VirtualRobot, journal: Journal, topic: str, within: float) -> Step:
    robot.wait_until(lambda: journal.of(topic, "action"), within, "an outcome")
    return journal.of(topic, "action")[-1]


def test_what_was_asked_of_one_that_dies_fails_at_once(robot: VirtualRobot, tmp_path: Path) -> None:
    journal = Journal(robot)
    ask(robot, journal, "work", "long")
    robot.wait_until(lambda: (tmp_path / "notes").exists(), 1, "the work's beginning")

    robot.stack.kill("worker")
    step = answer(robot, journal, "work", SOON)

    assert not step.ok
    assert step.text == "worker died before it answered: the process was killed by SIGKILL"
    ask(robot, journal, "note", "after a death")
    assert answer(robot, journal, "note", 3).ok
    robot.rest(3.0)
    assert (tmp_path / "notes").read_text().splitlines() == ["long begun", "after a death"]


def test_what_a_dead_process_did_not_read_is_not_carried_out_by_its_successor(
    robot: VirtualRobot, tmp_path: Path
) -> None:
    journal = Journal(robot)
    robot.stack.stop("worker")
    ask(robot, journal, "note", "for the dead")

    robot.stack.kill("worker")
    step = answer(robot, journal, "note", SOON)

    assert not step.ok
    assert "worker died before it answered" in step.text
    robot.rest(3.0)
    assert not (tmp_path / "notes").exists()


def test_what_hangs_answers_in_time_or_the_rule_is_told_that_it_died(robot: VirtualRobot) -> None:
    journal = Journal(robot)
    robot.stack.program("worker").executors("worker")[0].hang()
    ask(robot, journal, "note", "for one that hangs")

    robot.rest(14.0)
    assert not journal.of("note", "action")  # this recipe kills nothing
    robot.stack.kill("worker")

    assert not answer(robot, journal, "note", SOON).ok
