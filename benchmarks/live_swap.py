"""Change the rules of a running monitor hundreds of times while messages come at 1 kHz.

On real ROS: a stack with one small component; clicked points at 1 kHz and, beside them, the status
of a component at 100 Hz from this process; the rules applied over the monitor's service. Every
point must be evaluated by exactly one table, and the monitor must not pause for longer than a
millisecond. "In force" is when the changed rule has fired on a message, "answered" when the answer
has arrived here; both since the request, and both include the disk.

Run: python benchmarks/live_swap.py [swaps] [other rules in the table] [seconds of probation]
"""

import json
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from automatika_ros_sugar.msg import ComponentStatus
from geometry_msgs.msg import PointStamped
from rclpy.qos import ReliabilityPolicy

from benchmarks.common import percentile
from kompass.rulebook.schema.status import RuleStatus

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.ros.test_rules_live import LAB, RELIABLE
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.rules import Rules, compare, rule, signal
from tests.support.stack import Stack
from tests.support.tester import Tester

POINT = "geometry_msgs/msg/PointStamped"
STATUS = "automatika_ros_sugar/msg/ComponentStatus"


class Stream:
    """Publishes on a topic, so many times a second, until it is left."""

    def __init__(
        self, robot: Tester, kind: Any, topic: str, rate: float, make: Callable[[int], Any]
    ) -> None:
        self.sent = 0
        self._robot, self._rate, self._make = robot, rate, make
        self._publisher = robot.node.create_publisher(kind, topic, RELIABLE)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def __enter__(self) -> "Stream":
        wait_until(self._heard, 10, f"a reliable listener to {self._publisher.topic_name}")
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def _heard(self) -> bool:
        """Whether the monitor has one reader, as reliable as this; others may listen, too."""
        readers = self._robot.node.get_subscriptions_info_by_topic(self._publisher.topic_name)
        offers = [r.qos_profile.reliability for r in readers if r.node_name == "monitor"]
        matched = self._publisher.get_subscription_count() == len(readers)
        return matched and offers == [ReliabilityPolicy.RELIABLE]

    def _run(self) -> None:
        begun = time.monotonic()
        while not self._ended.is_set():
            self.sent += 1
            self._publisher.publish(self._make(self.sent))
            time.sleep(max(0.0, begun + self.sent / self._rate - time.monotonic()))


def point(number: int) -> PointStamped:
    """A click that tells its number."""
    message = PointStamped()
    message.point.x = float(number)
    return message


def main(swaps: int, others: int, probation: float) -> int:
    """Print the figures; 0 when nothing was missed or doubled, and no pause was too long."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ["LAB_FOLDER"] = folder
        stack = Stack("run", str(LAB), "--no-browser", "--port", "0", KOMPASS_ROBOT_NAME="bench")
        try:
            stack.wait_for_line("all components active", 30)
            robot = Robot(stack.domain)
            try:
                return measure(Rules(robot), swaps, others, probation)
            finally:
                robot.close()
        finally:
            stack.close()


def clicked(operator: str, value: float) -> dict[str, Any]:
    """A comparison with the number of a click."""
    return compare("clicked_point", operator, value, "point.x", POINT)


def measure(rules: Rules, swaps: int, others: int, probation: float) -> int:
    """Swap and count."""
    every = {"kind": "changed", "signal": signal("clicked_point", "point.x", POINT)}
    failing = compare("bench/status", ">", 0, "status", STATUS)
    table = rules.rules()
    table += [rule(f"other-{n}", clicked("<", -1 - n)) for n in range(others)]
    table += [rule("failing", failing), rule("every", every, cooldown=1e6)]
    table.append(rule("swapped", clicked("<", -1)))
    revision = rules.must_apply(table)
    pauses: list[float] = []
    answers: list[float] = []
    asked: dict[int, float] = {}  # by revision; s since the epoch
    with (
        Stream(rules.robot, PointStamped, "/clicked_point", 1000.0, point) as stream,
        Stream(rules.robot, ComponentStatus, "/bench/status", 100.0, lambda _: ComponentStatus()),
    ):
        begun = time.monotonic()
        for number in range(swaps):
            table[-1] = rule("swapped", clicked(">", -2 - number), cooldown=1e6)
            wall, since = time.time(), time.monotonic()
            answer = rules.apply(table, revision, probation=probation)
            assert answer.outcome == 0, answer.message
            answers.append(time.monotonic() - since)
            pauses.append(json.loads(answer.answer)["pause"])
            revision = answer.revision
            asked[revision] = wall
        rate = stream.sent / (time.monotonic() - begun)
    found = settled(rules)
    missed = stream.sent - found.evaluated
    # A message that is taken twice changes nothing the second time.
    doubled = found.evaluated - 1 - found.true
    print(f"{swaps} swaps of a table of {len(table)} rules, {rate:.0f} points/s")
    print(f"  points {stream.sent}, missed {missed}, doubled {doubled}")
    for name, values in (
        ("pause", pauses),
        ("in force", in_force(rules, asked)),
        ("answered", answers),
    ):
        shares = (0.5, 0.95, 0.99, 1.0)
        p50, p95, p99, most = (1e3 * percentile(values, share) for share in shares)
        print(f"  {name:8s} p50 {p50:.2f}, p95 {p95:.2f}, p99 {p99:.2f}, max {most:.2f} ms")
    return int(missed != 0 or doubled != 0 or percentile(pauses, 0.99) > 1e-3)


def settled(rules: Rules) -> RuleStatus:
    """How the rule that counts is doing, once the monitor has taken all that was on its way."""
    seen = [rules.status("every")]

    def rests() -> bool:
        seen.append(rules.status("every"))
        time.sleep(0.5)
        return seen[-1].evaluated == seen[-2].evaluated

    wait_until(rests, 60, "the end of the messages")
    return seen[-1]


def in_force(rules: Rules, asked: dict[int, float]) -> list[float]:
    """Seconds from each request to the first firing of the rule that it changed."""
    first: dict[int, float] = {}
    for firing in rules.firings:
        if firing.rule_id == "swapped" and firing.phase == "fired":
            first.setdefault(firing.revision, firing.time)
    wait = [first[number] - when for number, when in asked.items() if number in first]
    # The last may have been followed by no message any more.
    assert len(wait) >= len(asked) - 1, f"{len(asked) - len(wait)} swaps had no effect"
    return wait


if __name__ == "__main__":
    counts = [float(each) for each in sys.argv[1:]]
    swaps, others, probation = [*counts, *[500.0, 50.0, 0.0][len(counts) :]]
    sys.exit(main(int(swaps), int(others), probation))
