"""What a signature costs: releasing STOP and applying a table, with it and without, in turn.

On a robot that accepts both (``--ros-control full``), and the two halves alone for large tables.

.venv/bin/python benchmarks/signed_requests.py [TIMES]
"""

import json
import sys
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))
from kompass_interfaces.srv import ApplyRules, ReleaseStop, StopRobot

from benchmarks.common import percentile
from kompass.access.signer import Signer
from kompass.signing.key import RobotKey
from kompass.signing.proof import Verifier, make_proof
from kompass.store.robot_key import known_keys
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.rules import Rules
from tests.support.stack import Stack

SIZES = (1_000, 100_000, 1_000_000)  # characters of a table


class Caller:
    """Calls one service, signed or not."""

    def __init__(self, robot: Robot, kind: Any, name: str) -> None:
        self._robot, self._name = robot, name
        self._client = robot.node.create_client(kind, name)
        self._signer = Signer(robot.node, name.rpartition("/")[0], known_keys())
        ready = lambda: self._signer.is_ready and self._client.service_is_ready()  # noqa: E731
        wait_until(ready, 10, name)

    def call(self, request: Any, *, signed: bool) -> tuple[float, Any]:
        """Seconds until the answer was there, and the answer."""
        began = time.perf_counter()
        if signed:
            self._signer.sign(self._name, request)
        future = self._client.call_async(request)
        while not future.done():
            time.sleep(0.0002)
        return time.perf_counter() - began, future.result()


def show(what: str, seconds: list[float]) -> None:
    middle, high = percentile(seconds, 0.5), percentile(seconds, 0.95)
    print(f"{what:32} median {1e3 * middle:7.2f} ms   95 % {1e3 * high:7.2f} ms")


def compare(what: str, times: int, once: Callable[[bool], float]) -> None:
    """Do something signed and unsigned in turn."""
    took: dict[bool, list[float]] = {False: [], True: []}
    for number in range(2 * times):
        signed = number % 2 == 1
        took[signed].append(once(signed))
    show(f"{what}, unsigned", took[False])
    show(f"{what}, signed", took[True])


def alone(times: int) -> None:
    """Making and judging a proof, without ROS."""
    key = RobotKey.new()
    for size in SIZES:
        made, judged = [], []
        verifier = Verifier(key, 0.0)
        challenge = verifier.announcement.partition(".")[0]
        for _ in range(times):
            request = ApplyRules.Request(table="x" * size, author="ava", role="engineer")
            began = time.perf_counter()
            request.proof = make_proof(key, challenge, "/monitor/apply_rules", request)
            between = time.perf_counter()
            assert verifier.judge("/monitor/apply_rules", request, 0.0) == "good"
            made.append(between - began)
            judged.append(time.perf_counter() - between)
        show(f"make a proof, {size:,} characters", made)
        show(f"judge it, {size:,} characters", judged)


def main() -> None:
    times = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    alone(times)
    stack = Stack.simulated("--ros-control", "full")
    with closing(stack), closing(Robot(stack.domain)) as robot:
        release = Caller(robot, ReleaseStop, "/drive_manager/release_stop")
        apply = Caller(robot, ApplyRules, "/monitor/apply_rules")
        rules = Rules(robot)

        def release_stop(signed: bool) -> float:
            robot.call(StopRobot, "/drive_manager/stop", StopRobot.Request(operator_name="ava"))
            took, answer = release.call(ReleaseStop.Request(operator_name="ava"), signed=signed)
            assert answer.success, answer.message
            return took

        def apply_table(signed: bool) -> float:
            view = rules.view()
            request = ApplyRules.Request(
                table=json.dumps({"rules": rules.rules()}),
                expected_revision=view.active,
                author="ava",
                role="engineer",
                probation=0.0,
            )
            took, answer = apply.call(request, signed=signed)
            assert answer.outcome == ApplyRules.Request.APPLIED, answer.message
            return took

        compare("release STOP", times, release_stop)
        compare("apply the recipe's table", times, apply_table)


if __name__ == "__main__":
    main()
