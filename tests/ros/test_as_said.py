"""What a recipe says is what happens in a launched stack: in the journal, and in the processes."""

import os
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from std_msgs.msg import Bool

from kompass.rulebook.schema.journal import FiringRecord
from tests.ros.test_rules_live import say
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.rules import Rules
from tests.support.stack import Stack

pytestmark = pytest.mark.ros
LAB = Path(__file__).parents[1] / "recipes" / "as_said.py"


class Lab:
    """The launched recipe."""

    def __init__(self, stack: Stack, robot: Robot, folder: Path) -> None:
        self.stack, self.robot, self.folder, self.rules = stack, robot, folder, Rules(robot)

    def say(self, topic: str) -> None:
        say(self.robot, Bool, topic, True)

    def ended(self, rule_id: str) -> FiringRecord:
        """The first run of a rule in the journal."""

        def found() -> list[FiringRecord]:
            return [each for each in self.rules.journal(rule_id) if each.ended is not None]

        wait_until(found, 15, f"the end of a run of '{rule_id}'")
        return found()[-1]

    def notes(self, name: str) -> list[str]:
        path = self.folder / name
        return path.read_text().splitlines() if path.exists() else []


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    folder = tmp_path_factory.mktemp("lab")
    with (
        closing(Stack.active(LAB, LAB_FOLDER=str(folder))) as stack,
        closing(Robot(stack.domain)) as robot,
    ):
        yield Lab(stack, robot, folder)


def test_two_async_conditions_of_one_name_are_both_asked(lab: Lab) -> None:
    (lab.folder / "wanted-a").touch()
    wait_until(lambda: lab.notes("found-a"), 10, "the first condition's action")
    assert lab.notes("found-b") == []
    (lab.folder / "wanted-b").touch()
    wait_until(lambda: lab.notes("found-b"), 10, "the second condition's action")
    assert len(lab.notes("found-a")) == 1
    ids = {rule["id"] for rule in lab.rules.rules()}
    assert {"look-name-a", "look-name-b"} <= ids


def test_an_event_given_twice_has_both_actions_in_order(lab: Lab) -> None:
    lab.say("/twice")
    assert [each.text for each in lab.ended("twice").actions] == ["first", "second"]


def test_an_async_action_is_awaited(lab: Lab) -> None:
    lab.say("/dock")
    assert [each.text for each in lab.ended("dock").actions] == ["docked at home"]
    assert len(lab.notes("docked")) == 1


def test_a_function_reaches_the_component_in_its_process(lab: Lab) -> None:
    lab.say("/switch")
    assert lab.ended("switch").ok
    assert lab.notes("lamp") == [f"True by {lab.stack.pid_of('lamp')}"]
    assert os.getpid() != lab.stack.pid_of("lamp")


def test_settings_of_a_copy_are_refused_in_the_journal(lab: Lab) -> None:
    lab.say("/settings")
    run = lab.ended("settings")
    assert not run.ok
    assert "lamp.config is not reached from here" in run.error


def test_a_plain_function_is_tried_as_a_fallback(lab: Lab) -> None:
    lab.say("/fail")
    run = lab.ended("lamp-on-fail")
    assert run.ok, run.error
    assert len(lab.notes("fallback")) == 1
