"""The rules of a running stack, through the services of its monitor."""

import json
from typing import Any

from kompass_interfaces.srv import (
    ApplyRules,
    CheckRules,
    ConfirmRules,
    ResetRule,
    RollbackRules,
)

from kompass.monitor.client import MonitorClient, TableState
from kompass.rclpy_ext.reply import Reply
from kompass.rulebook.schema.explanation import ExplanationView
from kompass.rulebook.schema.journal import FiringRecord, FiringStep
from kompass.rulebook.schema.revision import History
from kompass.rulebook.schema.status import RuleStatus
from kompass.rulebook.schema.table_view import TableView
from tests.support.tester import Tester

LONGEST = 15.0  # s for an answer, on a busy machine
Rule = dict[str, Any]


class Rules:
    """Looks at the rules of the robot's monitor, and changes them."""

    def __init__(self, robot: Tester) -> None:
        self.robot = robot
        self.firings: list[FiringStep] = []
        self.arrived: list[float] = []
        self._states: list[TableState] = []
        self.monitor = MonitorClient(robot.node, "/monitor", limit=LONGEST)
        self.monitor.watch_firings(self._hear)
        self.monitor.watch_state(self._states.append)

    def _hear(self, step: FiringStep) -> None:
        self.arrived.append(self.robot.clock.monotonic())
        self.firings.append(step)

    def begin(self, request: Any) -> Reply[Any]:
        """Send a request of a service, whatever is in it."""
        reply: Reply[Any] = self.monitor.request(request)
        self.robot.wait_until(reply.begin, 10, f"the service for {type(request).__name__}")
        return reply

    def call(self, request: Any) -> Any:
        """Send a request of a service; its answer as it came."""
        return self.robot.answer(self.monitor.request(request))

    def view(self, revision: int = 0) -> TableView:
        """The table in force, or another."""
        return self.robot.answer(self.monitor.table(revision)).parsed()

    def rules(self) -> list[Rule]:
        """The rules in force as data, to be changed."""
        table: dict[str, list[Rule]] = json.loads(self.view().table.model_dump_json())
        return table["rules"]

    def check(self, text: str, role: str = "operator") -> CheckRules.Response:
        """Have a table checked."""
        return self.call(CheckRules.Request(table=text, role=role))

    def begin_apply(self, rules: list[Rule], expected: int, **more: Any) -> Reply[Any]:
        """Hand in a table; the answer as it will come."""
        fields = {"author": "tester", "role": "engineer", "probation": 0.0} | more
        text = json.dumps({"rules": rules})
        return self.begin(ApplyRules.Request(table=text, expected_revision=expected, **fields))

    def apply(self, rules: list[Rule], expected: int = 0, **more: Any) -> ApplyRules.Response:
        """Hand in a table, based on the revision in force unless told otherwise."""
        return self.robot.answer(self.begin_apply(rules, expected or self.view().revision, **more))

    def must_apply(self, rules: list[Rule], **more: Any) -> int:
        """Put a table in force; its revision."""
        answer = self.apply(rules, **more)
        assert answer.outcome == ApplyRules.Request.APPLIED, answer.message
        return int(answer.revision)

    def add(self, *added: Rule, **more: Any) -> int:
        """Put rules in force in addition to those that are; the revision."""
        ids = {rule["id"] for rule in added}
        kept = [rule for rule in self.rules() if rule["id"] not in ids]
        return self.must_apply([*kept, *added], **more)

    def remove(self, *ids: str, **more: Any) -> int:
        """Take rules away."""
        return self.must_apply([r for r in self.rules() if r["id"] not in ids], **more)

    def confirm(self, revision: int, role: str = "operator") -> ConfirmRules.Response:
        """Keep a revision."""
        return self.call(ConfirmRules.Request(revision=revision, author="tester", role=role))

    def roll_back(self, revision: int = 0, **more: Any) -> RollbackRules.Response:
        """Go back."""
        fields = {"author": "tester", "role": "operator"} | more
        return self.call(RollbackRules.Request(revision=revision, **fields))

    def reset(self, rule_id: str, role: str = "operator") -> ResetRule.Response:
        """Let a rule start afresh."""
        return self.call(ResetRule.Request(rule_id=rule_id, author="tester", role=role))

    def history(self) -> History:
        """All revisions."""
        return self.robot.answer(self.monitor.history(count=1000)).parsed()

    def journal(self, rule_id: str = "") -> tuple[FiringRecord, ...]:
        """The newest entries."""
        return self.robot.answer(self.monitor.firings(rule_id=rule_id)).parsed().firings

    def explain(self, rule_id: str, run_id: int = 0, epoch: str = "") -> ExplanationView:
        """Why."""
        return self.robot.answer(self.monitor.explain(rule_id, run_id, epoch)).parsed()

    def status(self, rule_id: str) -> RuleStatus:
        """How a rule is doing, right now."""
        status = self.explain(rule_id).status
        assert status is not None
        return status

    @property
    def state(self) -> TableState:
        """What the monitor last said of itself."""
        self.robot.wait_until(lambda: self._states, 10, "the rules' state")
        return self._states[-1]


def rule(rule_id: str, condition: Rule, *actions: Rule, **more: Any) -> Rule:
    """A rule as data; ``more`` are fields of the rule and of its event."""
    fields = ("severity", "lane", "shadow", "enabled", "protected", "name", "note")
    outer = {key: more.pop(key) for key in list(more) if key in fields}
    event = {"condition": condition, **more}
    return {"id": rule_id, "event": event, "actions": list(actions) or [log(rule_id)], **outer}


def log(text: str) -> Rule:
    """Write a line to the log."""
    return {"kind": "log", "text": text}


def compare(
    topic: str, operator: str, value: Any, path: str = "data", type_name: str = "Int32", **more: Any
) -> Rule:
    """A comparison with a field of a topic of std_msgs, unless told otherwise."""
    return {
        "kind": "compare",
        "signal": signal(topic, path, type_name, **more),
        "operator": operator,
        "value": value,
    }


def signal(topic: str, path: str = "data", type_name: str = "Int32", **more: Any) -> Rule:
    """A field of a topic."""
    full = type_name if "/" in type_name else f"std_msgs/msg/{type_name}"
    return {"topic": topic, "type": full, "path": path.split(".") if path else [], **more}
