"""A stand-in for the monitor: the far side of DDS for the console's routes on rules.

It keeps the contract of the services, topics and the action, and judges nothing: what it answers
hangs on what it is asked. Run it with `python -m tests.console.fake_monitor`.
"""

from __future__ import annotations

import signal
import threading
import time
from typing import Any

import rclpy
from kompass_interfaces.action import BacktestRules
from kompass_interfaces.msg import ProcessState, RuleFiring, RulesState, StackState
from kompass_interfaces.srv import (
    ApplyRules,
    CheckRules,
    ConfirmRules,
    DescribeGraph,
    ExplainRule,
    GetFirings,
    GetHistory,
    GetRules,
    ResetRule,
    RollbackRules,
    SaveRecording,
)
from pydantic import TypeAdapter, ValidationError
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from kompass.backtest.report import BacktestReport
from kompass.rulebook.diff import diff_tables
from kompass.rulebook.schema.alarm import Alarm
from kompass.rulebook.schema.diff_models import TableDiff
from kompass.rulebook.schema.explanation import ExplanationView
from kompass.rulebook.schema.graph_view import GraphView
from kompass.rulebook.schema.journal import Journal
from kompass.rulebook.schema.report import ApplyReport, CheckReport, Conflict, Effect, Finding
from kompass.rulebook.schema.revision import History
from kompass.rulebook.schema.status import RuleStatus
from kompass.rulebook.views.views import table_view
from kompass.rules.schema.actions import Log
from kompass.rules.schema.conditions import Compare
from kompass.rules.schema.events import Event
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Table

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

NEAR = Rule(
    id="near",
    name="Something is near",
    event=Event(
        condition=Compare(
            signal=Signal(
                topic="scan", type="sensor_msgs/msg/LaserScan", path=("ranges",), aggregate="min"
            ),
            operator="<",
            value=0.3,
        )
    ),
    actions=(Log(text="near"),),
)
TABLE = Table(rules=(NEAR,))
DISK_FULL = "disk full"  # the reason with which applying fails


class FakeMonitor:
    """Services, topics and the action of the monitor, in one node."""

    def __init__(self, ending: threading.Event) -> None:
        self.ending = ending
        self.node = rclpy.create_node("monitor")
        self.tables = {1: TABLE}
        self.revision = self.confirmed = 1
        self.reset: list[str] = []
        group = ReentrantCallbackGroup()
        offered = {
            GetRules: self.get_rules,
            CheckRules: self.check,
            ApplyRules: self.apply,
            RollbackRules: self.rollback,
            ConfirmRules: self.confirm,
            ResetRule: self.reset_rule,
            ExplainRule: self.explain,
            GetHistory: self.history,
            GetFirings: self.firings,
            DescribeGraph: self.graph,
            SaveRecording: self.save,
        }
        names = {
            kind: "".join("_" + c.lower() if c.isupper() else c for c in kind.__name__)[1:]
            for kind in offered
        }
        for kind, answer in offered.items():
            name = f"/monitor/{names[kind]}"
            self.node.create_service(kind, name, answer, callback_group=group)
        self.steps = self.node.create_publisher(RuleFiring, "/monitor/firings", 100)
        self.states = self.node.create_publisher(RulesState, "/monitor/rules_state", LATCHED)
        self.alarms = self.node.create_publisher(String, "/monitor/alarms", LATCHED)
        self.stack = self.node.create_publisher(StackState, "/monitor/stack_state", LATCHED)
        self.backtests = ActionServer(
            self.node,
            BacktestRules,
            "/monitor/backtest_rules",
            self.backtest,
            callback_group=group,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        self.node.create_timer(0.25, self.say, callback_group=group)
        alarm = Alarm(name="low-battery", text="Battery at 9 %", since=time.time())
        self.alarms.publish(String(data=TypeAdapter(list[Alarm]).dump_json([alarm]).decode()))
        planner = ProcessState(
            name="planner", nodes=["planner"], state="busy", pid=77, restarts=2, reason="killed"
        )
        self.stack.publish(StackState(processes=[planner]))

    def say(self) -> None:
        status = RuleStatus(rule_id="near", state="ready", text="the condition is false")
        rules = TypeAdapter(list[RuleStatus]).dump_json([status]).decode()
        left = 60.0 if self.revision != self.confirmed else 0.0
        self.states.publish(
            RulesState(
                revision=self.revision, confirmed=self.confirmed, probation_left=left, rules=rules
            )
        )

    def get_rules(self, request: Any, response: Any) -> Any:
        number = request.revision or self.revision
        if number not in self.tables:
            response.message = f"there is no revision {number}"
            return response
        view = table_view(
            self.tables[number],
            revision=number,
            active=self.revision,
            confirmed=self.confirmed,
            robot="fake",
        )
        response.success, response.answer = True, view.model_dump_json()
        return response

    def check(self, request: Any, response: Any) -> Any:
        try:
            report = self.report(Table.model_validate_json(request.table), request.role)
        except ValidationError:
            response.message = "this is no table"
            return response
        response.success, response.answer = report.ok, report.model_dump_json()
        return response

    def report(self, table: Table, role: str) -> CheckReport:
        found = []
        if role == "viewer":
            found.append(_error("role", "a viewer changes nothing"))
        if not table.rules:
            found.append(_error("protected", "the last rule is protected"))
        return CheckReport(ok=not found, revision=self.revision, findings=tuple(found))

    def apply(self, request: Any, response: Any) -> Any:
        try:
            table = Table.model_validate_json(request.table)
        except ValidationError:
            response.outcome, response.message = ApplyRules.Request.REFUSED, "this is no table"
            return response
        return self.put(request, response, table)

    def rollback(self, request: Any, response: Any) -> Any:
        return self.put(request, response, self.tables[request.revision or self.revision - 1])

    def put(self, request: Any, response: Any, table: Table) -> Any:
        response.revision = self.revision
        report = self.report(table, request.role)
        if request.expected_revision != self.revision:
            conflict = Conflict(
                expected=request.expected_revision,
                revision=self.revision,
                author="ben",
                time=time.time(),
                reason="faster",
                theirs=TableDiff(),
                yours=diff_tables(self.tables[1], table),
            )
            response.outcome, response.answer = ApplyRules.Request.CONFLICT, _json(conflict)
            response.message = f"revision {self.revision} is in force by now"
        elif not report.ok:
            response.outcome, response.answer = ApplyRules.Request.REFUSED, _json(report)
            response.message = report.findings[0].text
        elif request.reason == DISK_FULL:
            response.outcome = ApplyRules.Request.FAILED
            response.message = "the disk is full"
        else:
            self.revision += 1
            self.tables[self.revision] = table
            answer = ApplyReport(
                revision=self.revision,
                previous=self.revision - 1,
                probation=getattr(request, "probation", 0.0),
                pause=0.0,
                effect=Effect(),
                diff=TableDiff(),
            )
            response.answer, response.revision = _json(answer), self.revision
            self.say()
        return response

    def confirm(self, request: Any, response: Any) -> Any:
        if request.revision == self.revision:
            self.confirmed, response.success = self.revision, True
            self.say()
        else:
            response.message = f"revision {self.revision} is in force"
        return response

    def reset_rule(self, request: Any, response: Any) -> Any:
        response.success = request.rule_id == "near"
        response.message = "" if response.success else f"there is no rule {request.rule_id!r}"
        if response.success:  # and fires at once, in front of whoever listens
            for number in range(3):
                self.steps.publish(
                    RuleFiring(
                        rule_id="near", run_id=number, phase="fired", details='{"leaves":[]}'
                    )
                )
        return response

    def explain(self, request: Any, response: Any) -> Any:
        if request.rule_id != "near":
            response.message = f"there is no rule {request.rule_id!r}"
            return response
        view = ExplanationView(
            rule_id="near", time=time.time(), text="false", condition="", rule=NEAR, revision=1
        )
        response.success, response.answer = True, _json(view)
        return response

    def history(self, request: Any, response: Any) -> Any:
        found: Any = History(active=self.revision, confirmed=1, revisions=(), more=False)
        if request.diff_from:
            found = TableDiff(before=request.diff_from, after=request.diff_to)
        response.success, response.answer = True, _json(found)
        return response

    def firings(self, _: Any, response: Any) -> Any:
        response.success, response.answer = True, _json(Journal(firings=(), more=False))
        return response

    def graph(self, _: Any, response: Any) -> Any:
        view = GraphView(
            topics=(), types={}, components=(), services=(), actions=(), functions=("beep",)
        )
        response.success, response.answer = True, _json(view)
        return response

    def save(self, request: Any, response: Any) -> Any:
        response.success = request.name != "taken"
        response.message = "" if response.success else "there is a recording 'taken' already"
        response.path = f"/recordings/{request.name}.mcap"
        return response

    def backtest(self, handle: Any) -> BacktestRules.Result:
        handle.publish_feedback(BacktestRules.Feedback(progress=0.5, text="half"))
        if handle.request.recording == "broken":
            handle.abort()
            return BacktestRules.Result(message="it is no recording")
        while handle.request.recording == "endless":
            if handle.is_cancel_requested:
                handle.canceled()
                return BacktestRules.Result()
            if self.ending.wait(0.02):
                handle.abort()
                return BacktestRules.Result()
        report = BacktestReport(
            start=0.0,
            end=1.0,
            messages=1,
            seconds=0.1,
            firings=(),
            tallies=(),
            same=0,
            new=0,
            gone=0,
        )
        handle.succeed()
        return BacktestRules.Result(success=True, answer=_json(report))


def _error(code: str, text: str) -> Finding:
    return Finding(level="error", code=code, rule_id="near", field="", text=text, remedy="leave it")


def _json(model: Any) -> str:
    return str(model.model_dump_json())


def main() -> None:
    """Run until SIGTERM."""
    ending = threading.Event()
    rclpy.init()
    monitor = FakeMonitor(ending)
    executor = MultiThreadedExecutor(8)
    executor.add_node(monitor.node)
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: ending.set())
    spinning = threading.Thread(target=executor.spin)
    spinning.start()
    ending.wait()
    executor.shutdown(2.0)
    spinning.join(2.0)
    monitor.node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
