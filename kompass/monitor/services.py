"""The desk as services of ROS: what comes in is not trusted, what goes out is JSON."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any, NamedTuple

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
from rclpy.node import Node

from kompass.monitor.tables.table_manager import TableManager
from kompass.monitor.tables.types import Answer, Who
from kompass.rclpy_ext.deferred_service import answered_by_worker, create_deferred_service
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rulebook.schema.explanation import ExplanationView
from kompass.rulebook.schema.graph_view import GraphView
from kompass.rulebook.schema.journal import Journal
from kompass.rulebook.schema.revision import History
from kompass.rules.schema.model import Model

REVISIONS = 50  # of the history, unless asked otherwise
FIRINGS = 100
MOST = 1_000
# Characters of an answer that can be asked for in parts. The middleware keeps the last ten of each
# service for good: without a bound, a look at a long history costs the monitor its memory tenfold.
LARGEST = 1_000_000
_OUTCOMES = {
    "applied": ApplyRules.Request.APPLIED,
    "conflict": ApplyRules.Request.CONFLICT,
    "refused": ApplyRules.Request.REFUSED,
    "failed": ApplyRules.Request.FAILED,
}


class Sources(NamedTuple):
    """What the services answer from, beside the desk; each may be called on a worker.

    Attributes
    ----------
    explain
        Takes rule, run (0 for now) and epoch (empty for this one).
    firings
        Takes before, count and rule.
    save
        Takes seconds and name; returns the path. Raises what it cannot.
    """

    explain: Callable[[str, int, str], ExplanationView]
    firings: Callable[[int, int, str], Journal]
    graph: Callable[[], GraphView]
    save: Callable[[float, str], str]


class Services:
    """Offers the services of ``<node>/…``.

    Requests that look at the rules or change them are answered one after another; those that only
    look at the robot or at the disk have a thread of their own.
    """

    def __init__(self, node: Node, main: MainThread, desk: TableManager, sources: Sources) -> None:
        self._desk, self._sources, self._log = desk, sources, node.get_logger()
        self.worker = ThreadPoolExecutor(1, thread_name_prefix="desk")
        desk.later = self._after
        self._looker = ThreadPoolExecutor(1, thread_name_prefix="look")
        offers: list[tuple[Any, str, Callable[[Any, Any], Any], ThreadPoolExecutor]] = [
            (GetRules, "get_rules", self._get, self.worker),
            (CheckRules, "check_rules", self._check, self.worker),
            (ApplyRules, "apply_rules", self._apply, self.worker),
            (ConfirmRules, "confirm_rules", self._confirm, self.worker),
            (RollbackRules, "rollback_rules", self._rollback, self.worker),
            (ResetRule, "reset_rule", self._reset, self.worker),
            (GetHistory, "get_history", self._history, self.worker),
            (ExplainRule, "explain_rule", self._explain, self._looker),
            (GetFirings, "get_firings", self._firings, self._looker),
            (DescribeGraph, "describe_graph", self._graph, self._looker),
            (SaveRecording, "save_recording", self._save, self._looker),
        ]
        for kind, name, answer, worker in offers:
            failed = partial(_changed_nothing, desk) if _has_outcome(kind) else _failed
            deferred = answered_by_worker(main, worker, answer)
            create_deferred_service(node, kind, f"{node.get_name()}/{name}", deferred, failed)

    def _after(self, work: Callable[[], None]) -> None:
        """Have something done once the request under way is answered."""

        def do() -> None:
            try:
                work()
            except Exception as error:  # noqa: BLE001 - a worker's future tells nobody
                self._log.error(f"{type(error).__name__}: {error}")

        self.worker.submit(do)

    def close(self) -> None:
        """Take no more requests; the one under way ends first."""
        for worker in (self.worker, self._looker):
            worker.shutdown(wait=True, cancel_futures=True)

    def _get(self, request: Any, response: Any) -> Any:
        return _told(response, self._desk.window.view(request.revision))

    def _check(self, request: Any, response: Any) -> Any:
        report = self._desk.window.check(request.table, request.role)
        response.success, response.answer = report.ok, report.model_dump_json()
        errors = sum(finding.level == "error" for finding in report.findings)
        response.message = "" if report.ok else f"{errors} errors; nothing was changed"
        return response

    def _apply(self, request: Any, response: Any) -> Any:
        answer = self._desk.apply(
            request.table,
            Who(request.author, request.role),
            expected=request.expected_revision,
            reason=request.reason,
            probation=request.probation,
            cancel_running=request.cancel_running,
            reset=list(request.reset),
        )
        return _outcome(response, answer)

    def _confirm(self, request: Any, response: Any) -> Any:
        answer = self._desk.confirm(request.revision, Who(request.author, request.role))
        response.success, response.message = answer.ok, answer.message
        return response

    def _rollback(self, request: Any, response: Any) -> Any:
        answer = self._desk.rollback(
            request.revision,
            Who(request.author, request.role),
            expected=request.expected_revision,
            reason=request.reason,
            cancel_running=request.cancel_running,
        )
        return _outcome(response, answer)

    def _reset(self, request: Any, response: Any) -> Any:
        answer = self._desk.reset(request.rule_id, Who(request.author, request.role))
        response.success, response.message = answer.ok, answer.message
        return response

    def _history(self, request: Any, response: Any) -> Any:
        if request.diff_from or request.diff_to:
            return _told(response, self._desk.window.diff(request.diff_from, request.diff_to))
        count = min(request.count or REVISIONS, MOST)
        history = self._desk.window.history(request.before, count)
        return _told_in_parts(response, history, "revisions")

    def _explain(self, request: Any, response: Any) -> Any:
        view = self._sources.explain(request.rule_id, request.run_id, request.epoch)
        return _told(response, view)

    def _firings(self, request: Any, response: Any) -> Any:
        count = min(request.count or FIRINGS, MOST)
        journal = self._sources.firings(request.before, count, request.rule_id)
        return _told_in_parts(response, journal, "firings")

    def _graph(self, request: Any, response: Any) -> Any:
        return _told(response, self._sources.graph())

    def _save(self, request: Any, response: Any) -> Any:
        response.path = self._sources.save(request.seconds, request.name)
        response.success = True
        return response


def _told(response: Any, answer: Model) -> Any:
    response.success, response.answer = True, answer.model_dump_json()
    return response


def _told_in_parts(response: Any, answer: History | Journal, items: str) -> Any:
    """As many items as fit; that there are more is said, and the rest can be asked for."""
    _told(response, answer)
    while (size := len(response.answer)) > LARGEST and (count := len(getattr(answer, items))) > 1:
        fewer = getattr(answer, items)[: max(min(count - 1, count * LARGEST // size), 1)]
        answer = answer.model_copy(update={items: fewer, "more": True})
        _told(response, answer)
    return response


def _outcome(response: Any, answer: Answer) -> Any:
    response.outcome = _OUTCOMES[answer.outcome]
    response.message, response.revision = answer.message, answer.revision
    if answer.body is not None:
        response.answer = answer.body.model_dump_json()
    return response


def _has_outcome(kind: Any) -> bool:
    return hasattr(kind.Response, "outcome")


def _failed(response: Any, error: Exception) -> Any:
    response.success, response.message = False, _sentence(error)
    return response


def _changed_nothing(desk: TableManager, response: Any, error: Exception) -> Any:
    response.outcome = ApplyRules.Request.FAILED
    response.message, response.revision = _sentence(error), desk.in_force.revision
    return response


def _sentence(error: Exception) -> str:
    text = str(error.args[0] if isinstance(error, KeyError) and error.args else error)
    return text or type(error).__name__
