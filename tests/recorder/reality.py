"""A faulted run of the simulator, and what its recording says of the rules afterwards."""

from __future__ import annotations

import itertools
import json
import math
import os
import signal
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from kompass_interfaces.action import BacktestRules
from kompass_interfaces.msg import RuleFiring
from kompass_interfaces.srv import ApplyRules, GetRules, SaveRecording, SetFault
from mcap.reader import make_reader
from rclpy.action import ActionClient
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import LaserScan

from kompass.backtest.report import BacktestFiring, BacktestReport
from kompass.rulebook.schema.report import ApplyReport
from kompass.rulebook.schema.status import LeafReading
from kompass.rulebook.schema.table_view import TableView
from kompass.rules.schema.table import Table
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import Stack

SCAN = {"topic": "scan", "type": "sensor_msgs/msg/LaserScan"}
ODOMETRY = {"topic": "odometry/filtered", "type": "nav_msgs/msg/Odometry"}
STATUS = {"topic": "controller/status", "type": "automatika_ros_sugar/msg/ComponentStatus"}
TWIST = ["twist", "twist", "angular", "z"]
NEAR = "near"
TRUE_BEFORE = "true-before"
EDITED = 0.05  # m by which the threshold is moved


def compare(signal: dict[str, Any], operator: str, value: Any) -> dict[str, Any]:
    """A leaf of a condition."""
    return {"kind": "compare", "signal": signal, "operator": operator, "value": value}


def rule(id_: str, condition: dict[str, Any], **event: Any) -> dict[str, Any]:
    """A rule that writes a line into the log."""
    actions = event.pop("actions", [{"kind": "log", "text": id_}])
    return {"id": id_, "event": {"condition": condition, **event}, "actions": actions}


def reality_table(threshold: float) -> Table:
    """Rules of every kind of timing, that fire often on a robot that drives to and fro."""
    nearest = {**SCAN, "path": ["ranges"], "aggregate": "min", "timeout": 0.5}
    turns = {**ODOMETRY, "path": TWIST, "timeout": 0.5}
    say = {"kind": "publish", "topic": "/note", "type": "std_msgs/msg/String"}
    turning = {
        "kind": "any",
        "conditions": [compare(turns, ">", 0.15), compare(turns, "<", -0.15)],
    }
    moves = compare({**ODOMETRY, "path": ["twist", "twist", "linear", "x"]}, ">", 0.05)
    return Table.model_validate(
        {
            "rules": [
                rule(NEAR, compare(nearest, "<", threshold), trigger="edge"),
                rule("silent", {"kind": "absent", "signal": SCAN, "seconds": 0.6}, trigger="edge"),
                rule(
                    "turning",
                    turning,
                    hold=0.3,
                    cooldown=1.0,
                    # Nobody listens, so each run takes the half second in which one might come.
                    actions=[{**say, "message": {"data": "I turn"}}],
                ),
                rule("queued", turning, trigger="edge", mode={"kind": "queued", "size": 3}),
                rule("once", moves, once=True),
                rule(
                    "not-near",
                    {
                        "kind": "all",
                        "conditions": [
                            {"kind": "not", "condition": compare(nearest, "<", threshold)},
                            moves,
                        ],
                    },
                    trigger="edge",
                    clear=compare(turns, ">", 0.1),
                ),
                rule(
                    "status",
                    {"kind": "received", "signal": {**STATUS, "path": ["status"]}},
                    cooldown=2.0,
                ),
            ]
        }
    )


class Told(NamedTuple):
    """A firing, as the monitor told it live, or as the recording has it."""

    rule_id: str
    run_id: int
    leaves: tuple[tuple[str, Any], ...]


class Reality:
    """Drives a simulated robot with faults while its rules are recorded."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self.told: list[Told] = []
        robot.node.create_subscription(
            RuleFiring, "/monitor/firings", self._hear, QoSProfile(depth=1000)
        )
        self._action = ActionClient(robot.node, BacktestRules, "/monitor/backtest_rules")
        wait_until(self._action.server_is_ready, 10, "the server of back-tests")
        wait_until(
            lambda: robot.node.count_publishers("/monitor/firings") == 1, 10, "the monitor's word"
        )

    def close(self) -> None:
        """Leave the robot alone."""
        self._robot.do(self._action.destroy)

    def _hear(self, message: RuleFiring) -> None:
        if message.phase == "fired":
            leaves = json.loads(message.details)["leaves"]
            told = tuple((leaf["text"], leaf["verdict"]) for leaf in leaves)
            self.told.append(Told(message.rule_id, message.run_id, told))

    def apply(self, table: Table) -> ApplyReport:
        """Put a table in force for good."""
        view = self._robot.call(GetRules, "/monitor/get_rules", GetRules.Request())
        request = ApplyRules.Request(
            table=table.model_dump_json(),
            expected_revision=TableView.model_validate_json(view.answer).active,
            author="tester",
            role="engineer",
            reason="a test",
            probation=0.0,
        )
        answer = self._robot.call(ApplyRules, "/monitor/apply_rules", request)
        assert answer.outcome == ApplyRules.Request.APPLIED, answer.message
        return ApplyReport.model_validate_json(answer.answer)

    def begin(self, stack: Stack, table: Table) -> None:
        """Put a table in force, and have the engine begin anew with it: the monitor is killed.

        A table that comes into force while the robot drives finds the topics silent which nobody
        listened to before; what is to be compared begins with nothing heard at all.
        """
        self.apply(table)
        old = stack.pid_of("monitor")
        os.kill(old, signal.SIGKILL)
        wait_until(lambda: stack.pid_of("monitor") != old, 10, "another monitor")
        self.told.clear()
        wait_until(lambda: stack.output.count("monitor is up") >= 2, 20, "it to be up")
        wait_until(self._action.server_is_ready, 10, "the server of back-tests")
        wait_until(lambda: bool(self.told), 30, "the first firing")

    def drive(self, seconds: float) -> None:
        """To and fro past the pillars, the lidar unplugged for a moment now and then."""
        end = time.monotonic() + seconds
        goals = itertools.cycle([(-0.5, -0.55), (-1.6, 0.5), (-0.5, 0.55), (-1.6, -0.5)])
        for count in itertools.count():
            if count % 2 == 1:
                self._robot.click(*next(goals), taker="planner")
            if count % 5 == 3:
                request = SetFault.Request(fault="lidar_unplugged", on=True, duration=1.0)
                assert self._robot.call(SetFault, "/simulator/set_fault", request).success
            left = end - time.monotonic()
            time.sleep(max(0.0, min(2.0, left)))
            if left <= 2.0:
                return

    def save(self, name: str) -> Path:
        """Keep all of the rotating recording."""
        request = SaveRecording.Request(seconds=0.0, name=name)
        answer = self._robot.call(SaveRecording, "/monitor/save_recording", request, timeout=30)
        assert answer.success, answer.message
        return Path(answer.path)

    def backtest(
        self,
        table: Table,
        recording: str,
        seconds: float = 0.0,
        progress: Callable[[float], None] = lambda share: None,
    ) -> BacktestReport:
        """What a table would have done, by the monitor's action."""
        result = self.result(self.send(table.model_dump_json(), recording, seconds, progress))
        assert result.success, result.message
        return BacktestReport.model_validate_json(result.answer)

    def send(
        self,
        table: str,
        recording: str,
        seconds: float = 0.0,
        progress: Callable[[float], None] = lambda share: None,
    ) -> Any:
        """Begin a back-test; its handle."""
        goal = BacktestRules.Goal(table=table, recording=recording, seconds=seconds)
        robot = self._robot
        sent = robot._executor.create_task(
            lambda: self._action.send_goal_async(
                goal, lambda message: progress(message.feedback.progress)
            )
        )
        return robot.await_future(robot.await_future(sent, 5, "sending"), 10, "acceptance")

    def result(self, handle: Any, timeout: float = 120.0) -> Any:
        """How a back-test ended."""
        ended = self._robot.result(handle, timeout)
        return ended.result


class Firing(NamedTuple):
    """A firing that the engine recorded."""

    rule_id: str
    run_id: int
    time: float  # s since the epoch
    leaves: tuple[LeafReading, ...]


class Record(NamedTuple):
    """What a recording says of the engine; times in seconds since the epoch."""

    in_force: float  # when the engine last began, with the table of the test in force
    firings: list[Firing]  # since then
    shift: float  # from the recording's times to those of firings


def recorded(path: Path) -> Record:
    """The engine's channel, read with the mcap package alone."""
    found: list[Firing] = []
    offset = in_force = shift = 0.0
    with path.open("rb") as stream:
        for _, _, message in make_reader(stream).iter_messages("/monitor/engine"):
            event = json.loads(message.data)
            data = event["data"]
            if event["kind"] == "began" or (event["kind"] == "resumed" and not offset):
                offset = data["wall"] - data["now"]
                shift = offset - (message.log_time - event["now_ns"]) * 1e-9
                in_force, found = data["wall"], []
            elif event["kind"] == "fired":
                leaves = tuple(LeafReading.model_validate(leaf) for leaf in data["leaves"])
                time_ = data["now"] + offset
                found.append(Firing(data["rule_id"], data["run_id"], time_, leaves))
    return Record(in_force, found, shift)


class Applied(NamedTuple):
    """When a table came into force, as a recording has it."""

    seconds: float  # before the end of the recording
    time: float  # s since the epoch
    firings: list[Firing]  # since then


def last_applied(path: Path) -> Applied:
    """The last table of a recording that was applied, read with the mcap package alone."""
    offset, logged, found = 0.0, 0, Applied(0.0, 0.0, [])
    with path.open("rb") as stream:
        reader = make_reader(stream)
        for _, _, message in reader.iter_messages("/monitor/engine"):
            event = json.loads(message.data)
            if event["kind"] in ("began", "resumed"):
                offset = event["data"]["wall"] - event["data"]["now"]
            elif event["kind"] == "swapped":
                found = Applied(0.0, event["data"]["now"] + offset, [])
                logged = message.log_time
        summary = reader.get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert logged, "no table was applied in it"
    seconds = (summary.statistics.message_end_time - logged) * 1e-9
    firings = [each for each in recorded(path).firings if each.time > found.time]
    return found._replace(seconds=seconds, firings=firings)


def applied_table(threshold: float) -> Table:
    """Rules of :func:`reality_table`: some as they are, one changed, one gone, and new ones."""
    nearest = {**SCAN, "path": ["ranges"], "aggregate": "min", "timeout": 0.5}
    hears_transforms = {"topic": "tf", "type": "tf2_msgs/msg/TFMessage", "above": 1.0}
    kept = [r for r in reality_table(threshold).rules if r.id not in (NEAR, "once")]
    data = {"rules": [each.model_dump(mode="json") for each in kept]}
    data["rules"] += [
        rule(NEAR, compare(nearest, "<", threshold - EDITED), trigger="edge"),
        # True before it is applied, on a topic that rules listen to, and on one that none did.
        rule(TRUE_BEFORE, compare(nearest, "<", 20.0), trigger="edge", hold=2.0),
        rule("transforms", {"kind": "rate", **hears_transforms, "window": 1.0}, trigger="edge"),
    ]
    return Table.model_validate(data)


def since(report: BacktestReport, in_force: float) -> list[BacktestFiring]:
    """Firings of a back-test since the engine began with the table of the test."""
    return [f for f in report.firings if f.time >= in_force]


def expected_near(path: Path, threshold: float, record: Record) -> list[float]:
    """When the rule on the nearest obstacle must fire: worked out from the scans alone.

    It has been in force from the beginning, as in a back-test: what the recorder heard itself
    counts until the engine listened.
    """
    times, armed = [], True
    with path.open("rb") as stream:
        for _, channel, message in make_reader(stream).iter_messages("/scan"):
            at = message.log_time * 1e-9 + record.shift
            source = channel.metadata["source"]
            if source != "engine" and not (source == "tap" and at < record.in_force):
                continue
            scan = deserialize_message(message.data, LaserScan)
            finite = [value for value in scan.ranges if math.isfinite(value)]
            if finite:
                near = min(finite) < threshold
                if near and armed and at >= record.in_force:
                    times.append(at)
                armed = not near
    return times


def same_times(left: Sequence[float], right: Sequence[float]) -> bool:
    """Whether two rows of times are the same, to the microsecond."""
    return len(left) == len(right) and all(
        abs(a - b) < 2e-6 for a, b in zip(sorted(left), sorted(right), strict=True)
    )
