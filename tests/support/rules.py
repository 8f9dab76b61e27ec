"""The rules of a running stack, through the services of its monitor."""

import json
import time
from typing import Any

from kompass_interfaces.msg import RuleFiring, RulesState
from kompass_interfaces.srv import (
    ApplyRules,
    CheckRules,
    ConfirmRules,
    ExplainRule,
    GetFirings,
    GetHistory,
    GetRules,
    ResetRule,
    RollbackRules,
)

from kompass.rulebook.schema.explanation import ExplanationView
from kompass.rulebook.schema.journal import FiringRecord, Journal
from kompass.rulebook.schema.revision import History
from kompass.rulebook.schema.status import RuleStatus
from kompass.rulebook.schema.table_view import TableView
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot

LONGEST = 15.0  # s for an answer, on a busy machine
Rule = dict[str, Any]


class Rules:
    """Looks at the rules of the robot's monitor, and changes them."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.firings: list[RuleFiring] = []
        self.arrived: list[float] = []
        robot.node.create_subscription(RuleFiring, "/monitor/firings", self._hear, 1000)
        robot.subscribe(RulesState, "/monitor/rules_state", LATCHED)
        self._clients: dict[str, Any] = {}

    def _hear(self, message: RuleFiring) -> None:
        self.arrived.append(time.monotonic())
        self.firings.append(message)

    def begin(self, kind: Any, name: str, **request: Any) -> Any:
        """Send a request; the future of its answer."""
        client = self._clients.get(name)
        if client is None:
            client = self.robot.node.create_client(kind, f"/monitor/{name}")
            self._clients[name] = client
        wait_until(client.service_is_ready, 10, f"the service {name}")
        return client.call_async(kind.Request(**request))

    def call(self, kind: Any, name: str, **request: Any) -> Any:
        """Send a request; its answer."""
        future = self.begin(kind, name, **request)
        return self.robot.await_future(future, LONGEST, f"the answer of {name}")

    def view(self, revision: int = 0) -> TableView:
        """The table in force, or another."""
        answer = self.call(GetRules, "get_rules", revision=revision)
        assert answer.success, answer.message
        return TableView.model_validate_json(answer.answer)

    def rules(self) -> list[Rule]:
        """The rules in force as data, to be changed."""
        table: dict[str, list[Rule]] = json.loads(self.view().table.model_dump_json())
        return table["rules"]

    def check(self, text: str, role: str = "operator") -> CheckRules.Response:
        """Have a table checked."""
        return self.call(CheckRules, "check_rules", table=text, role=role)

    def begin_apply(self, rules: list[Rule], expected: int, **more: Any) -> Any:
        """Hand in a table; the future of the answer."""
        request = {"author": "tester", "role": "operator", "probation": 0.0} | more
        text = json.dumps({"rules": rules})
        return self.begin(
            ApplyRules, "apply_rules", table=text, expected_revision=expected, **request
        )

    def apply(self, rules: list[Rule], expected: int = 0, **more: Any) -> ApplyRules.Response:
        """Hand in a table, based on the revision in force unless told otherwise."""
        future = self.begin_apply(rules, expected or self.view().revision, **more)
        answer: ApplyRules.Response = self.robot.await_future(future, LONGEST, "the answer")
        return answer

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
        request = {"revision": revision, "author": "tester", "role": role}
        return self.call(ConfirmRules, "confirm_rules", **request)

    def roll_back(self, revision: int = 0, **more: Any) -> RollbackRules.Response:
        """Go back."""
        request = {"author": "tester", "role": "operator"} | more
        return self.call(RollbackRules, "rollback_rules", revision=revision, **request)

    def reset(self, rule_id: str, role: str = "operator") -> ResetRule.Response:
        """Let a rule start afresh."""
        request = {"rule_id": rule_id, "author": "tester", "role": role}
        return self.call(ResetRule, "reset_rule", **request)

    def history(self) -> History:
        """All revisions."""
        answer = self.call(GetHistory, "get_history", count=1000)
        return History.model_validate_json(answer.answer)

    def journal(self, rule_id: str = "") -> tuple[FiringRecord, ...]:
        """The newest entries."""
        answer = self.call(GetFirings, "get_firings", rule_id=rule_id)
        return Journal.model_validate_json(answer.answer).firings

    def explain(self, rule_id: str, run_id: int = 0, epoch: str = "") -> ExplanationView:
        """Why."""
        request = {"rule_id": rule_id, "run_id": run_id, "epoch": epoch}
        answer = self.call(ExplainRule, "explain_rule", **request)
        assert answer.success, answer.message
        return ExplanationView.model_validate_json(answer.answer)

    def status(self, rule_id: str) -> RuleStatus:
        """How a rule is doing, right now."""
        status = self.explain(rule_id).status
        assert status is not None
        return status

    @property
    def state(self) -> RulesState:
        """What the monitor last said of itself."""
        wait_until(lambda: "/monitor/rules_state" in self.robot.newest, 10, "the rules' state")
        return self.robot.newest["/monitor/rules_state"]


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
