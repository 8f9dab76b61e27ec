"""A small ROS client of the monitor's services: one call at a time, each with an end."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self, TypeVar

import rclpy
from kompass_interfaces.action import BacktestRules
from kompass_interfaces.msg import RulesState
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
from pydantic import TypeAdapter
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions

from kompass.backtest.report import BacktestReport
from kompass.rulebook.schema.diff_models import TableDiff
from kompass.rulebook.schema.explanation import ExplanationView
from kompass.rulebook.schema.journal import Journal
from kompass.rulebook.schema.report import ApplyReport, CheckReport, Conflict
from kompass.rulebook.schema.revision import History
from kompass.rulebook.schema.status import RuleStatus
from kompass.rulebook.schema.table_view import TableView
from kompass.rules.schema.model import Model
from kompass.rules.schema.table import Table
from kompass_console.cli_error import CliError

SERVICE = "kompass_interfaces/srv/GetRules"
NAME = "/get_rules"
SEARCH = 5.0  # s for a monitor to be found
SETTLE = 0.3  # s for a second one to be found too
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
M = TypeVar("M", bound=Model)
_STATUSES = TypeAdapter(tuple[RuleStatus, ...])
REFUSED = 1  # exit codes, as the help tells them
CONFLICT = 4


class Refused(CliError):
    """The robot did not do it; ``body`` says why in full."""

    def __init__(self, text: str, body: Model | None = None, code: int = REFUSED) -> None:
        super().__init__(code, text)
        self.body = body


class RulesClient:
    """Speaks with the monitor of one robot.

    Parameters
    ----------
    namespace
        Of the robot; None for the only one there is.
    timeout
        Seconds that the monitor may take for an answer.

    Raises
    ------
    CliError
        When there is no monitor, or more than one to choose from.
    """

    def __init__(self, namespace: str | None, timeout: float) -> None:
        self._timeout = timeout
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node(
            f"rules_cli_{os.getpid()}",
            context=self._context,
            start_parameter_services=False,
            enable_rosout=False,
        )
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        try:
            self._monitor = self._find(namespace)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    # -- looking ------------------------------------------------------------------------------

    def table(self, revision: int = 0) -> TableView:
        """A revision of the table; 0 for the one in force."""
        return self._ask(GetRules, "get_rules", TableView, revision=revision)

    def history(self, before: int = 0, count: int = 0) -> History:
        """The revisions, newest first."""
        return self._ask(GetHistory, "get_history", History, before=before, count=count)

    def diff(self, before: int, after: int) -> TableDiff:
        """What differs between two revisions."""
        return self._ask(GetHistory, "get_history", TableDiff, diff_from=before, diff_to=after)

    def explain(self, rule_id: str, run_id: int = 0, epoch: str = "") -> ExplanationView:
        """Why a rule fires or does not."""
        return self._ask(
            ExplainRule,
            "explain_rule",
            ExplanationView,
            rule_id=rule_id,
            run_id=run_id,
            epoch=epoch,
        )

    def firings(self, before: int = 0, count: int = 0, rule_id: str = "") -> Journal:
        """The journal, newest first."""
        return self._ask(
            GetFirings, "get_firings", Journal, before=before, count=count, rule_id=rule_id
        )

    def check(self, table: Table, role: str) -> CheckReport:
        """What is wrong with a table, and what applying it would do."""
        answer = self._call(CheckRules, "check_rules", table=table.model_dump_json(), role=role)
        if not answer.answer:
            raise Refused(answer.message)
        return CheckReport.model_validate_json(answer.answer)

    def statuses(self, timeout: float = 2.0) -> dict[str, RuleStatus]:
        """How the rules are doing, by id; empty when the monitor does not tell in time."""
        received: list[Any] = []
        subscription = self._node.create_subscription(
            RulesState, f"{self._monitor}/rules_state", received.append, LATCHED
        )
        try:
            self._spin(lambda: bool(received), timeout)
        finally:
            self._node.destroy_subscription(subscription)
        if not received:
            return {}
        statuses = _STATUSES.validate_json(received[-1].rules)
        return {status.rule_id: status for status in statuses}

    # -- changing -----------------------------------------------------------------------------

    def apply(
        self,
        table: Table,
        *,
        expected: int,
        author: str,
        role: str,
        reason: str,
        probation: float,
        cancel_running: bool,
        reset: list[str],
    ) -> ApplyReport:
        """Put a table in force.

        Raises
        ------
        Refused
            When it is not: the table is wrong, a guard rail forbids it, or somebody was faster.
        """
        answer = self._call(
            ApplyRules,
            "apply_rules",
            table=table.model_dump_json(),
            expected_revision=expected,
            author=author,
            role=role,
            reason=reason,
            probation=probation,
            cancel_running=cancel_running,
            reset=reset,
        )
        return _applied(answer)

    def rollback(
        self,
        revision: int,
        *,
        expected: int,
        author: str,
        role: str,
        reason: str,
        cancel_running: bool,
    ) -> ApplyReport:
        """Put an earlier table in force; 0 for the one before.

        Raises
        ------
        Refused
            When it is not.
        """
        answer = self._call(
            RollbackRules,
            "rollback_rules",
            revision=revision,
            expected_revision=expected,
            author=author,
            role=role,
            reason=reason,
            cancel_running=cancel_running,
        )
        return _applied(answer)

    def confirm(self, revision: int, *, author: str, role: str) -> str:
        """Keep the revision on probation; what the monitor says."""
        return self._do(ConfirmRules, "confirm_rules", revision=revision, author=author, role=role)

    def reset(self, rule_id: str, *, author: str, role: str) -> str:
        """Let a rule start afresh; what the monitor says."""
        return self._do(ResetRule, "reset_rule", rule_id=rule_id, author=author, role=role)

    # -- back-test ----------------------------------------------------------------------------

    def backtest(
        self,
        table: Table,
        *,
        recording: str,
        seconds: float,
        progress: Callable[[float, str], None],
    ) -> BacktestReport:
        """Try a table on a recording; ``progress`` takes 0 to 1 and a text.

        Raises
        ------
        Refused
            When it cannot be done.
        KeyboardInterrupt
            After the back-test was cancelled.
        """
        client = ActionClient(self._node, BacktestRules, f"{self._monitor}/backtest_rules")
        try:
            if not self._spin(client.server_is_ready, self._timeout):
                raise Refused(
                    f"{self._monitor} offers no back-tests; its flight recorder is off "
                    "(--no-record), or it is of an older release"
                )
            goal = BacktestRules.Goal(
                table=table.model_dump_json(), recording=recording, seconds=seconds
            )
            sent = client.send_goal_async(
                goal,
                feedback_callback=lambda message: progress(
                    message.feedback.progress, message.feedback.text
                ),
            )
            handle = self._result(sent, "backtest_rules")
            if not handle.accepted:
                raise Refused("the monitor refused the back-test; another one may be running")
            ended = handle.get_result_async()
            try:
                self._spin(ended.done, None)
            except KeyboardInterrupt:
                self._spin(handle.cancel_goal_async().done, self._timeout)
                raise
            result = ended.result().result
        finally:
            client.destroy()
        if not result.success:
            raise Refused(result.message)
        return BacktestReport.model_validate_json(result.answer)

    # -- helpers ------------------------------------------------------------------------------

    def _find(self, namespace: str | None) -> str:
        """Name of the monitor's node, as its services begin."""
        wanted = None if namespace is None else f"/{namespace.strip('/')}/".replace("//", "/")
        found: list[str] = []

        def look() -> bool:
            found[:] = sorted(
                name.removesuffix(NAME)
                for name, types in self._node.get_service_names_and_types()
                if name.endswith(NAME) and SERVICE in types
            )
            if wanted is not None:
                found[:] = [name for name in found if name.rpartition("/")[0] + "/" == wanted]
            return bool(found)

        if self._spin(look, SEARCH):
            self._spin(lambda: False, SETTLE)
            look()
        domain = os.environ.get("ROS_DOMAIN_ID") or "0"
        if not found:
            where = "" if wanted is None else f" in the namespace {wanted}"
            raise CliError(
                REFUSED,
                f"no monitor was found on ROS domain {domain}{where} within {SEARCH:g} s; start a "
                "stack with 'kompass-console run', or give its --domain-id and --namespace",
            )
        if len(found) > 1:
            raise CliError(
                2,
                f"there are {len(found)} monitors on ROS domain {domain}: {', '.join(found)}; "
                "choose one with --namespace",
            )
        return found[0]

    def _ask(self, kind: Any, name: str, model: type[M], **fields: Any) -> M:
        answer = self._call(kind, name, **fields)
        if not answer.success:
            raise Refused(answer.message)
        return model.model_validate_json(answer.answer)

    def _do(self, kind: Any, name: str, **fields: Any) -> str:
        answer = self._call(kind, name, **fields)
        if not answer.success:
            raise Refused(answer.message)
        return str(answer.message)

    def _call(self, kind: Any, name: str, **fields: Any) -> Any:
        client = self._node.create_client(kind, f"{self._monitor}/{name}")
        try:
            if not self._spin(client.service_is_ready, self._timeout):
                raise self._silent(name)
            return self._result(client.call_async(kind.Request(**fields)), name)
        finally:
            self._node.destroy_client(client)

    def _result(self, future: Any, name: str) -> Any:
        if not self._spin(future.done, self._timeout):
            raise self._silent(name)
        return future.result()

    def _silent(self, name: str) -> CliError:
        return CliError(
            REFUSED,
            f"{self._monitor}/{name} did not answer within {self._timeout:g} s; the monitor may "
            "have ended or be busy: try again, or give it more with --timeout",
        )

    def _spin(self, done: Callable[[], bool], timeout: float | None) -> bool:
        """Let the node work until ``done``; whether it was in time."""
        deadline = None if timeout is None else time.monotonic() + timeout
        while not done():
            if deadline is not None and time.monotonic() >= deadline:
                return False
            self._executor.spin_once(timeout_sec=0.02)
        return True


def _applied(answer: Any) -> ApplyReport:
    if answer.outcome == ApplyRules.Request.APPLIED:
        return ApplyReport.model_validate_json(answer.answer)
    if answer.outcome == ApplyRules.Request.CONFLICT:
        raise Refused(answer.message, Conflict.model_validate_json(answer.answer), CONFLICT)
    body = CheckReport.model_validate_json(answer.answer) if answer.answer else None
    raise Refused(answer.message, body)
