"""The monitor's services on ROS: what comes in is not trusted, what goes out is JSON."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
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

from kompass.access.gatekeeper import Gatekeeper, NotAdmitted
from kompass.bus.node import Node
from kompass.monitor.local_socket import LocalAnswer
from kompass.monitor.tables.table_manager import TableManager
from kompass.monitor.tables.types import ChangeAnswer, Who
from kompass.monitor.worker_thread import WorkerThread
from kompass.rclpy_ext.deferred_service import (
    DeferredAnswer,
    answered_by_worker,
    create_deferred_service,
)
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rulebook.schema.explanation import ExplanationView
from kompass.rulebook.schema.graph_view import GraphView
from kompass.rulebook.schema.journal import Journal
from kompass.rulebook.schema.revision import History
from kompass.rules.schema.model import Model
from kompass.timeline.query import TimelinePage

REVISIONS = 50  # of the history, unless asked otherwise
FIRINGS = 100
MOST = 1_000
# Characters of an answer that can be asked for in parts. The middleware keeps the last ten of each
# service for good: without a bound, a look at a long history costs the monitor its memory tenfold.
LARGEST = 250_000
# What only looks, and may be asked without ROS, too.
LOOKS = {"get_rules", "get_history", "explain_rule", "get_firings"}
_OUTCOMES = {
    "applied": ApplyRules.Request.APPLIED,
    "conflict": ApplyRules.Request.CONFLICT,
    "refused": ApplyRules.Request.REFUSED,
    "failed": ApplyRules.Request.FAILED,
}


class Sources(NamedTuple):
    """What the services answer from, beside the tables; each may be called on a worker.

    Attributes
    ----------
    explain
        Takes rule, run (0 for now) and epoch (empty for this one).
    firings
        Takes before, count and rule.
    graph
        Returns what rules can be made of.
    save
        Takes seconds and name, returns the path, and raises what it cannot; None when nothing is
        recorded.
    """

    explain: Callable[[str, int, str], ExplanationView]
    firings: Callable[[int, int, str], Journal]
    graph: Callable[[], GraphView]
    save: Callable[[float, str], str] | None


class Services:
    """Offers the services of ``<node>/…``.

    Requests that look at the rules or change them are answered one after another; those that only
    look at the robot or at the disk have a thread of their own.

    Parameters
    ----------
    node, main
        Offers them, and its executor's thread.
    gatekeeper
        Lets requests in.
    worker
        Answers what looks at the rules or changes them.
    tables
        The table in force and its revisions.
    hear
        Listens to topics for a moment, by their types; awaited before a table is checked.
    sources
        What all else is answered from.
    """

    def __init__(
        self,
        node: Node,
        main: MainThread,
        gatekeeper: Gatekeeper,
        worker: WorkerThread,
        tables: TableManager,
        hear: Callable[[Mapping[str, str]], Awaitable[None]],
        sources: Sources,
    ) -> None:
        self._gatekeeper = gatekeeper
        self._tables, self._hear, self._sources = tables, hear, sources
        self._lookups = WorkerThread(node, "lookups")
        offers: list[tuple[Any, str, Callable[..., Any], WorkerThread]] = [
            (GetRules, "get_rules", self._get, worker),
            (ApplyRules, "apply_rules", self._apply, worker),
            (ConfirmRules, "confirm_rules", self._confirm, worker),
            (RollbackRules, "rollback_rules", self._rollback, worker),
            (ResetRule, "reset_rule", self._reset, worker),
            (GetHistory, "get_history", self._history, worker),
            (ExplainRule, "explain_rule", self._explain, self._lookups),
            (GetFirings, "get_firings", self._firings, self._lookups),
            (DescribeGraph, "describe_graph", self._graph, self._lookups),
            (SaveRecording, "save_recording", self._save, self._lookups),
        ]
        self._looks = {
            name: (kind, answer, by) for kind, name, answer, by in offers if name in LOOKS
        }
        for kind, name, answer, by in offers:
            failed = partial(_changed_nothing, tables) if _has_outcome(kind) else _failed
            service = f"{node.get_name()}/{name}"
            deferred = answered_by_worker(main, by, self._for_admitted(service, kind, answer))
            create_deferred_service(node, kind, service, deferred, failed)
        service = f"{node.get_name()}/check_rules"
        checked = self._checked(service, main, worker)
        create_deferred_service(node, CheckRules, service, checked, _failed)

    def look(self, service: str, fields: Mapping[str, Any]) -> LocalAnswer:
        """Answer who asks on this machine, not over ROS; any thread but those that answer.

        Raises
        ------
        Exception
            What cannot be answered, as a sentence.
        """
        if service not in self._looks:
            raise ValueError(f"{service} is not answered here, but over ROS only")
        kind, answer, by = self._looks[service]
        request = kind.Request(**fields)
        response = by.submit(partial(answer, request, kind.Response())).result()
        return LocalAnswer(response.success, response.message, response.answer)

    def close(self) -> None:
        """Look nothing up any more; what is under way ends first."""
        self._lookups.close()

    def _for_admitted(
        self, service: str, kind: Any, answer: Callable[..., Any]
    ) -> Callable[[Any, Any], Any]:
        """Answer whom the gatekeeper lets in, and tell the others why not.

        What changes the rules is told who asks, too.
        """
        changes_rules = hasattr(kind.Request, "author")
        changes = changes_rules or kind is SaveRecording

        def respond(request: Any, response: Any) -> Any:
            author = request.author if changes_rules else ""
            try:
                verified = self._gatekeeper.admit(service, request, changes=changes, who=author)
            except NotAdmitted as error:
                if _has_outcome(kind):
                    response.outcome = ApplyRules.Request.REFUSED
                    response.revision = self._tables.in_force.revision
                else:
                    response.success = False
                response.message = str(error)
                return response
            if changes_rules:
                return answer(request, response, Who(author, request.role, verified))
            return answer(request, response)

        return respond

    def _get(self, request: Any, response: Any) -> Any:
        return _answered(response, self._tables.queries.view(request.revision))

    def _checked(self, service: str, main: MainThread, worker: WorkerThread) -> DeferredAnswer:
        """Check a table once what only it looks at was heard; the worker has other work meanwhile.

        Whoever is not admitted has nothing listened to.
        """
        look = answered_by_worker(main, worker, self._for_admitted(service, CheckRules, self._look))
        check = answered_by_worker(main, worker, self._check)

        async def respond(request: Any, response: Any) -> Any:
            topics = await look(request, response)
            if topics is response:
                return response  # not admitted
            await self._hear(topics)
            return await check(request, response)

        return respond

    def _look(self, request: Any, _: Any) -> dict[str, str]:
        return self._tables.queries.unheard(request.table, request.role)

    def _check(self, request: Any, response: Any) -> Any:
        report = self._tables.queries.check(request.table, request.role)
        response.success, response.answer = report.ok, report.model_dump_json()
        errors = sum(finding.level == "error" for finding in report.findings)
        response.message = "" if report.ok else f"{errors} errors; nothing was changed"
        return response

    def _apply(self, request: Any, response: Any, who: Who) -> Any:
        answer = self._tables.apply(
            request.table,
            who,
            expected=request.expected_revision,
            reason=request.reason,
            probation=request.probation,
            cancel_running=request.cancel_running,
            reset=list(request.reset),
        )
        return _outcome(response, answer)

    def _confirm(self, request: Any, response: Any, who: Who) -> Any:
        answer = self._tables.confirm(request.revision, who)
        response.success, response.message = answer.ok, answer.message
        return response

    def _rollback(self, request: Any, response: Any, who: Who) -> Any:
        answer = self._tables.rollback(
            request.revision,
            who,
            expected=request.expected_revision,
            reason=request.reason,
            cancel_running=request.cancel_running,
        )
        return _outcome(response, answer)

    def _reset(self, request: Any, response: Any, who: Who) -> Any:
        answer = self._tables.reset(request.rule_id, who)
        response.success, response.message = answer.ok, answer.message
        return response

    def _history(self, request: Any, response: Any) -> Any:
        if request.diff_from or request.diff_to:
            return _answered(
                response, self._tables.queries.diff(request.diff_from, request.diff_to)
            )
        count = min(request.count or REVISIONS, MOST)
        history = self._tables.queries.history(request.before, count, LARGEST)
        return answer_in_parts(response, history, "revisions")

    def _explain(self, request: Any, response: Any) -> Any:
        try:
            view = self._sources.explain(request.rule_id, request.run_id, request.epoch)
        except KeyError as error:  # of who asks, and nothing that is wrong here: not for the log
            return _failed(response, error)
        return _answered(response, view)

    def _firings(self, request: Any, response: Any) -> Any:
        count = min(request.count or FIRINGS, MOST)
        journal = self._sources.firings(request.before, count, request.rule_id)
        return answer_in_parts(response, journal, "firings")

    def _graph(self, request: Any, response: Any) -> Any:
        return _answered(response, self._sources.graph())

    def _save(self, request: Any, response: Any) -> Any:
        if self._sources.save is None:
            raise RuntimeError("nothing is recorded on this robot; its log says why")
        response.path = self._sources.save(request.seconds, request.name)
        response.success = True
        return response


def _answered(response: Any, answer: Model) -> Any:
    response.success, response.answer = True, answer.model_dump_json()
    return response


def answer_in_parts(response: Any, answer: History | Journal | TimelinePage, items: str) -> Any:
    """Fill a response with as many items of an answer as fit; the rest can be asked for.

    Parameters
    ----------
    items
        Name of the field that holds them, newest first.
    """
    _answered(response, answer)
    while (size := len(response.answer)) > LARGEST and (count := len(getattr(answer, items))) > 1:
        fewer = getattr(answer, items)[: max(min(count - 1, count * LARGEST // size), 1)]
        answer = answer.model_copy(update={items: fewer, "more": True})
        _answered(response, answer)
    return response


def _outcome(response: Any, answer: ChangeAnswer) -> Any:
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


def _changed_nothing(tables: TableManager, response: Any, error: Exception) -> Any:
    response.outcome = ApplyRules.Request.FAILED
    response.message, response.revision = _sentence(error), tables.in_force.revision
    return response


def _sentence(error: Exception) -> str:
    text = str(error.args[0] if isinstance(error, KeyError) and error.args else error)
    return text or type(error).__name__
