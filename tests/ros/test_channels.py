"""What rules ask of components goes over a channel of their own, whoever dies at its ends."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from rclpy.qos import ReliabilityPolicy
from std_msgs.msg import Int32, String

from tests.support.journal import Journal, Step
from tests.support.processes import children, wait_until
from tests.support.robot import Robot
from tests.support.rules import Rules, rule
from tests.support.rules import signal as signal_of
from tests.support.stack import Stack

pytestmark = pytest.mark.ros
RECIPE = Path(__file__).parents[1] / "recipes" / "asked_robot.py"
SEQPACKET = "0005"  # type of a socket in /proc/net/unix


class Asked(NamedTuple):
    """A stack with a worker that rules ask something of; nothing is let in over ROS unsigned."""

    stack: Stack
    robot: Robot
    journal: Journal
    rules: Rules
    folder: Path
    publishers: dict[str, Any]
    dead: set[bytes]  # readers of monitors that were killed

    def begin(self) -> None:
        """Wait until we hear what rules do: the first that a monitor says may be lost."""
        publisher, since = self.publisher("double", Int32), self.journal.mark

        def is_heard() -> bool:
            publisher.publish(Int32(data=1))
            return bool(self.journal.of("double", "done", since))

        wait_until(is_heard, 10, "word of a firing")

    def publisher(self, topic: str, kind: type) -> Any:
        """What makes a rule fire."""
        if topic not in self.publishers:
            self.publishers[topic] = self.robot.node.create_publisher(kind, f"/{topic}", 10)
        return self.publishers[topic]

    def readers(self, topic: str) -> dict[bytes, ReliabilityPolicy]:
        """Who listens; DDS remembers the dead for a while."""
        found = self.robot.node.get_subscriptions_info_by_topic(f"/{topic}")
        return {bytes(one.endpoint_gid): one.qos_profile.reliability for one in found}

    def say(self, topic: str, value: str | int) -> None:
        """Have a rule fire, once the monitor does not read at best effort any more."""
        kind = String if isinstance(value, str) else Int32
        publisher = self.publisher(topic, kind)

        def is_heard() -> bool:
            living = [how for gid, how in self.readers(topic).items() if gid not in self.dead]
            return living == [ReliabilityPolicy.RELIABLE]

        wait_until(is_heard, 10, f"a reliable listener on {topic}")
        since = self.journal.mark
        publisher.publish(kind(data=value))
        wait_until(lambda: self.journal.of(topic, "fired", since), 10, f"a firing of {topic}")

    def done(self, topic: str, value: str | int) -> Step:
        """The end of the action of a rule that was made to fire."""
        since = self.journal.mark
        self.say(topic, value)
        return self.action(topic, since)

    def action(self, topic: str, since: int) -> Step:
        """What came of the action of a rule."""
        wait_until(lambda: self.journal.of(topic, "action", since), 10, f"the action of {topic}")
        return self.journal.of(topic, "action", since)[0]

    def clients(self) -> list[str]:
        """Services of components that the monitor can ask over ROS by now."""
        found = self.robot.node.get_client_names_and_types_by_node("monitor", "/")
        return [name for name, _ in found if name.startswith(("/worker/", "/other/"))]

    def notes(self) -> list[str]:
        """What was carried out."""
        file = self.folder / "notes"
        return file.read_text().splitlines() if file.exists() else []

    def count_up(self, name: str) -> int:
        """How many lives of a process have come up so far."""
        return self.stack.output.count(f" {name} is up")

    def end(self, name: str) -> Callable[[], None]:
        """Kill a process; what is returned waits for its next life."""
        if name == "monitor":
            self.dead.update(gid for topic in self.publishers for gid in self.readers(topic))
        lives = self.count_up(name)
        os.kill(self.stack.pid_of(name), signal.SIGKILL)
        return lambda: wait_until(lambda: self.count_up(name) > lives, 20, f"another {name}")


@pytest.fixture(scope="module")
def asked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Asked]:
    folder = tmp_path_factory.mktemp("asked")
    stack = Stack(
        *("run", str(RECIPE), "--no-browser", "--port", "0", "--ros-control", "off"),
        LAB_FOLDER=str(folder),
        KOMPASS_ROBOT_NAME="asked",
    )
    try:
        stack.wait_for_line("all components active", 20)
        robot = Robot(stack.domain)
        try:
            made = Asked(stack, robot, Journal(robot), Rules(robot), folder, {}, set())
            made.begin()
            yield made
        finally:
            robot.close()
    finally:
        assert stack.close() == 0, stack.output


def test_a_component_answers_a_rule_past_ros_whatever_ros_may_do(asked: Asked) -> None:
    step = asked.done("note", "a word\nand a line")
    assert (step.ok, step.text) == (True, '"a word\\nand a line"')
    assert asked.clients() == []


@pytest.mark.parametrize("letters", [3, 50_000, 100_000, 2_000_000])
def test_what_is_asked_and_answered_may_be_large(asked: Asked, letters: int) -> None:
    step = asked.done("double", letters)
    assert (step.ok, step.text) == (True, f"{2 * letters} letters")


def test_what_was_asked_of_one_that_dies_fails_at_once_and_the_next_is_answered(
    asked: Asked,
) -> None:
    since = asked.journal.mark
    asked.say("work", "killed")
    wait_until(lambda: "killed begun" in asked.notes(), 10, "the work's beginning")
    is_up_again = asked.end("worker")
    step = asked.action("work", since)
    assert not step.ok
    assert step.text == "worker died before it answered: the process was killed by SIGKILL"
    is_up_again()
    assert asked.done("note", "after a death").ok
    assert "killed ended" not in asked.notes()


def test_what_a_dead_process_did_not_read_is_not_carried_out_by_its_successor(
    asked: Asked,
) -> None:
    os.kill(asked.stack.pid_of("worker"), signal.SIGSTOP)
    since = asked.journal.mark
    asked.say("note", "for the dead")
    is_up_again = asked.end("worker")
    step = asked.action("note", since)
    assert not step.ok
    assert "died before it answered" in step.text
    is_up_again()
    assert asked.done("note", "for the living").ok
    assert asked.notes()[-1] == "for the living"
    assert "for the dead" not in asked.notes()


def test_what_comes_too_late_to_be_waited_for_is_not_carried_out(asked: Asked) -> None:
    late: dict[str, Any] = {"kind": "method", "component": "worker", "method": "note"}
    heard = {"kind": "received", "signal": signal_of("late")}
    action = {**late, "kwargs": {"text": "too late"}, "timeout": 0.3}
    asked.rules.add(rule("late", heard, action))
    pid = asked.stack.pid_of("worker")
    assert asked.done("late", 1).ok
    assert asked.notes()[-1] == "too late"
    os.kill(pid, signal.SIGSTOP)
    try:
        step = asked.done("late", 2)
    finally:
        os.kill(pid, signal.SIGCONT)
    assert (step.ok, step.text) == (False, "no answer from /worker/signed_call within 0.3 s")
    assert asked.done("note", "in time").ok
    assert asked.notes()[-2:] == ["too late", "in time"]
    assert asked.notes().count("too late") == 1
    assert asked.stack.pid_of("worker") == pid
    asked.stack.wait_for_line("execute_method: asked too long ago, and not carried out", 5)


def test_another_monitor_asks_as_the_first_did_and_gets_no_answer_of_another(
    asked: Asked,
) -> None:
    asked.say("work", "for two monitors")
    wait_until(lambda: "for two monitors begun" in asked.notes(), 10, "the work's beginning")
    asked.end("monitor")()
    asked.begin()
    # Its requests have the numbers that those of the dead one had.
    for number in range(10):
        step = asked.done("note", f"word {number}")
        assert (step.ok, step.text) == (True, f'"word {number}"')
    wait_until(lambda: "for two monitors ended" in asked.notes(), 10, "the work's end")
    step = asked.done("note", "after all")
    assert (step.ok, step.text) == (True, '"after all"')


def test_only_the_monitor_and_the_component_can_speak_on_a_channel(asked: Asked) -> None:
    supervisor = asked.stack.process.pid

    def expected() -> list[set[int]]:
        pids = [asked.stack.pid_of(name) for name in ("monitor", "monitor", "worker", "other")]
        return [{supervisor, pid} for pid in pids]

    def holders() -> list[set[int]]:
        found = {inode: set[int]() for inode in seqpackets()}
        for pid in (supervisor, *descendants(supervisor)):
            for inode in sockets_of(pid) & found.keys():
                found[inode].add(pid)
        return [pids for pids in found.values() if pids]

    beside = ("guard", "program", "sleep", "console", "recorder")
    assert {asked.stack.pid_of(name) for name in beside} <= set(children(supervisor))
    assert sorted(map(sorted, holders())) == sorted(map(sorted, expected()))
    for name in ("worker", "program"):
        asked.end(name)()
    assert sorted(map(sorted, holders())) == sorted(map(sorted, expected()))


def test_components_that_share_a_process_share_its_channel(tmp_path: Path) -> None:
    stack = Stack(
        *("run", str(RECIPE), "--no-browser", "--port", "0", "--single-process"),
        LAB_FOLDER=str(tmp_path),
        KOMPASS_ROBOT_NAME="asked",
    )
    try:
        stack.wait_for_line("all components active", 20)
        with contextlib.closing(Robot(stack.domain)) as robot:
            asked = Asked(stack, robot, Journal(robot), Rules(robot), tmp_path, {}, set())
            asked.begin()
            to_other = {"kind": "method", "component": "other", "method": "note"}
            heard = {"kind": "received", "signal": signal_of("other")}
            asked.rules.add(rule("other", heard, {**to_other, "kwargs": {"text": "for the other"}}))
            assert asked.done("note", "for the worker").text == '"for the worker"'
            assert asked.done("other", 1).text == '"for the other"'
            assert asked.clients() == []
            since = asked.journal.mark
            asked.say("work", "killed")
            wait_until(lambda: "killed begun" in asked.notes(), 10, "the work's beginning")
            os.kill(stack.pid_of("components"), signal.SIGKILL)
            text = "worker died before it answered: the process was killed by SIGKILL"
            assert asked.action("work", since).text == text
    finally:
        assert stack.close() == 0, stack.output


def seqpackets() -> set[str]:
    """Inodes of all sockets of this machine that are of a channel's kind."""
    rows = [line.split() for line in Path("/proc/net/unix").read_text().splitlines()[1:]]
    return {row[6] for row in rows if row[4] == SEQPACKET}


def sockets_of(pid: int) -> set[str]:
    """Inodes of the sockets that a process has open."""
    links = [
        str(link.readlink()) for link in Path(f"/proc/{pid}/fd").iterdir() if link.is_symlink()
    ]
    return {link[len("socket:[") : -1] for link in links if link.startswith("socket:[")}


def descendants(pid: int) -> Iterator[int]:
    """Walk the processes below one."""
    for child in children(pid):
        yield child
        yield from descendants(child)
