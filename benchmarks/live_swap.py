"""Change the rules of a running monitor hundreds of times while messages come at 1 kHz.

On real ROS: a stack with one small component, a publisher in this process, the rules applied over
the monitor's service. Every message must be evaluated by exactly one table, and the monitor must
not pause for longer than a millisecond.

Run: python benchmarks/live_swap.py [swaps] [other rules in the table]
"""

import json
import os
import sys
import tempfile
import time
from pathlib import Path

from common import percentile

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.ros.test_rules_live import LAB, Stream
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.rules import Rules, compare, rule, signal
from tests.support.stack import Stack


def main(swaps: int, others: int) -> int:
    """Print the figures; 0 when nothing was missed or doubled, and no pause was too long."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ["LAB_FOLDER"] = folder
        stack = Stack("run", str(LAB), "--no-browser", "--port", "0", KOMPASS_ROBOT_NAME="bench")
        try:
            stack.wait_for_line("all components active", 30)
            robot = Robot(stack.domain)
            try:
                return measure(Rules(robot), swaps, others)
            finally:
                robot.close()
        finally:
            stack.close()


def measure(rules: Rules, swaps: int, others: int) -> int:
    """Swap and count."""
    every = {"kind": "changed", "signal": signal("flood")}
    table = rules.rules()
    table += [rule(f"other-{n}", compare("flood", "<", -1 - n)) for n in range(others)]
    table += [rule("every", every, cooldown=1e6), rule("swapped", compare("flood", "<", -1))]
    revision = rules.must_apply(table)
    pauses: list[float] = []
    answers: list[float] = []
    with Stream(rules.robot, "/flood") as stream:
        begun = time.monotonic()
        for number in range(swaps):
            table[-1] = rule("swapped", compare("flood", "<", -2 - number))
            asked = time.monotonic()
            answer = rules.apply(table, revision)
            assert answer.outcome == 0, answer.message
            answers.append(time.monotonic() - asked)
            pauses.append(json.loads(answer.answer)["pause"])
            revision = answer.revision
        rate = stream.sent / (time.monotonic() - begun)
    wait_until(lambda: rules.status("every").evaluated >= stream.sent, 20, "the last message")
    found = rules.status("every")
    missed = stream.sent - found.evaluated
    # A message that is taken twice changes nothing the second time.
    doubled = found.evaluated - 1 - found.true
    print(f"{swaps} swaps of a table of {len(table)} rules, {rate:.0f} messages/s")
    print(f"  messages {stream.sent}, missed {missed}, doubled {doubled}")
    for name, values in (("pause", pauses), ("answer", answers)):
        p50, p99, most = (1e3 * percentile(values, share) for share in (0.5, 0.99, 1.0))
        print(f"  {name:6s} p50 {p50:.2f} ms, p99 {p99:.2f} ms, max {most:.2f} ms")
    return int(missed != 0 or doubled != 0 or percentile(pauses, 0.99) > 1e-3)


if __name__ == "__main__":
    counts = [int(each) for each in sys.argv[1:]]
    sys.exit(main(*(counts + [500, 50][len(counts) :])))
