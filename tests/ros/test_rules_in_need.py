"""The rules of a robot go on whatever is sent to them, whoever dies, and when the disk is full."""

import json
import resource
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from kompass_interfaces.srv import ApplyRules, GetFirings, GetRules
from std_msgs.msg import Int32, String

from tests.recorder.reality import Reality
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot
from tests.support.rules import Rules, compare, rule
from tests.support.stack import Stack

pytestmark = pytest.mark.ros
LAB = Path(__file__).parents[1] / "recipes" / "rules_lab.py"
ROOT = Path(__file__).parents[2]
Request = ApplyRules.Request
SMALL = {"event": {"condition": {"kind": "received", "topic": "a"}}, "actions": []}

# Begins a back-test, says so, and waits for an end that it does not live to see.
ASKER = """
import sys
from tests.recorder.reality import Reality
from tests.support.robot import Robot
reality = Reality(Robot(int(sys.argv[1])))
handle = reality.send('{"rules": []}', "")
print("begun", flush=True)
reality.result(handle, 600)
"""


@pytest.fixture(scope="module")
def stack(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stack]:
    folder = str(tmp_path_factory.mktemp("lab"))
    with closing(Stack.active(LAB, LAB_FOLDER=folder, KOMPASS_ROBOT_NAME="needy")) as running:
        yield running


@pytest.fixture(scope="module")
def robot(stack: Stack) -> Iterator[Robot]:
    with closing(Robot(stack.domain)) as client:
        yield client


@pytest.fixture(scope="module")
def rules(robot: Robot) -> Rules:
    return Rules(robot)


@pytest.mark.parametrize(
    "text",
    [
        "[" * 10_000_000,
        json.dumps({"rules": [{"id": "x" * 10_000_000}]}),
        json.dumps({"rules": [{"id": f"r{n}", **SMALL} for n in range(10_000)]}),
    ],
    ids=["10 MB of brackets", "an id of 10 MB", "10,000 rules"],
)
def test_a_monstrous_table_is_refused_while_others_are_answered(
    stack: Stack, rules: Rules, text: str
) -> None:
    before, monitor = rules.view(), stack.pid_of("monitor")

    refusal = rules.begin(
        ApplyRules.Request(table=text, role="operator", expected_revision=before.revision)
    )
    others = [rules.begin(GetRules.Request()), rules.begin(GetFirings.Request())]

    for other in others:
        assert rules.robot.await_future(other, 15, "the answer of another service").success
    answer = rules.robot.await_future(refusal, 30, "the refusal")
    assert answer.outcome == Request.REFUSED
    assert " more than " in answer.message
    assert len(answer.message) < 500
    assert rules.view().table == before.table
    assert stack.pid_of("monitor") == monitor


def test_a_client_that_dies_in_its_backtest_takes_nobody_along(
    stack: Stack, robot: Robot, rules: Rules
) -> None:
    monitor = stack.pid_of("monitor")
    for _ in range(2):
        with subprocess.Popen(
            [sys.executable, "-c", ASKER, str(stack.domain)],
            stdout=subprocess.PIPE,
            cwd=ROOT,
        ) as asker:
            assert asker.stdout is not None
            assert asker.stdout.readline() == b"begun\n"
            asker.kill()
    reality = Reality(robot)
    try:
        # There is room for two at a time: those of the dead come to their end.
        wait_until(lambda: reality.send('{"rules": []}', "").accepted, 20, "room for another")
    finally:
        reality.close()
    assert rules.view().revision
    assert stack.pid_of("monitor") == monitor


def test_with_a_full_disk_nothing_is_applied_and_the_rules_go_on(
    stack: Stack, robot: Robot, rules: Rules
) -> None:
    robot.subscribe(String, "/monitor/alarms", LATCHED)
    robot.subscribe(String, "/acted")
    act = {
        "kind": "publish",
        "topic": "acted",
        "type": "std_msgs/msg/String",
        "message": {"data": "done"},
    }
    rules.add(rule("act", compare("go", ">", 0), act))
    before, monitor = rules.view(), stack.pid_of("monitor")
    go = robot.node.create_publisher(Int32, "/go", 10)

    def alarms() -> list[dict[str, Any]]:
        heard = robot.newest.get("/monitor/alarms")
        found: list[dict[str, Any]] = json.loads(heard.data) if heard else []
        return found

    def acts() -> None:
        robot.newest.pop("/acted", None)

        def acted() -> bool:
            go.publish(Int32(data=1))
            return "/acted" in robot.newest

        wait_until(acted, 10, "the action")

    acts()
    unlimited = resource.prlimit(monitor, resource.RLIMIT_FSIZE)
    # No file may grow any more: what a full disk is to those who write.
    resource.prlimit(monitor, resource.RLIMIT_FSIZE, (0, unlimited[1]))
    try:
        answer = rules.apply([*rules.rules(), rule("late", compare("a", ">", 1))])
        assert answer.outcome == Request.FAILED
        assert "cannot write" in answer.message
        assert f"revision {before.revision} stay in force" in answer.message
        acts()

        def alarmed() -> bool:
            # What acted just now may have been a firing of before.
            go.publish(Int32(data=1))
            return bool(alarms())

        wait_until(alarmed, 10, "the alarm")
        assert "firings are not written down: cannot write" in alarms()[0]["text"]
        assert rules.status("act").fired > 1
    finally:
        resource.prlimit(monitor, resource.RLIMIT_FSIZE, unlimited)
    assert rules.view().table == before.table

    def heals() -> bool:
        acts()
        return not alarms()

    wait_until(heals, 20, "the end of the alarm")
    assert rules.add(rule("late", compare("a", ">", 1))) == before.revision + 1
    assert stack.pid_of("monitor") == monitor
