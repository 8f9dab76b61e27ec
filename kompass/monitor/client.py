"""The monitor, for whoever asks it from elsewhere: the console, the command line, tests.

Answers come as :class:`kompass.rclpy_ext.reply.Reply`, to be awaited in asyncio or waited for in a
thread. Waiting raises :class:`NoAnswer` when the monitor does not answer in time, and
:class:`Refused` with a sentence when it does not do what it is asked for.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import Any, Generic, NamedTuple, TypeVar

from action_msgs.msg import GoalStatus
from kompass_interfaces.action import BacktestRules
from kompass_interfaces.msg import RuleFiring, RulesState
from kompass_interfaces.srv import (
    ApplyRules,
    ChangeMissions,
    ChangePlaces,
    ChangeTimeline,
    ChangeZones,
    CheckRules,
    ConfirmRules,
    DescribeGraph,
    ExplainRule,
    GetFirings,
    GetHistory,
    GetRules,
    GetTimeline,
    ResetRule,
    RollbackRules,
    SaveRecording,
)
from pydantic import TypeAdapter
from std_msgs.msg import String

from kompass.access.signer import Signer
from kompass.backtest.report import BacktestReport
from kompass.bus.node import ActionClient, Node
from kompass.missions.change import MissionChange
from kompass.missions.mission import Mission
from kompass.places.change import PlaceChange
from kompass.places.place import Place
from kompass.rclpy_ext.reply import NoAnswer, Reply
from kompass.rclpy_ext.topic import LATCHED, QoSConfig
from kompass.rulebook.schema.alarm import Alarm
from kompass.rulebook.schema.diff_models import TableDiff
from kompass.rulebook.schema.explanation import ExplanationView
from kompass.rulebook.schema.graph_view import GraphView
from kompass.rulebook.schema.journal import FiringStep, Journal
from kompass.rulebook.schema.report import ApplyReport, CheckReport, Conflict
from kompass.rulebook.schema.revision import History
from kompass.rulebook.schema.status import RuleStatus
from kompass.rulebook.schema.table_view import TableView
from kompass.store.robot_key import known_keys
from kompass.timeline.change import TimelineChange
from kompass.timeline.query import TimelinePage, TimelineQuery
from kompass.zones.change import ZoneChange
from kompass.zones.zone import Zone

DEFAULT_PROBATION = -1.0  # s; the monitor's own

# Service types, names, and the seconds that they may take: checking and applying compile the
# table, a recording is written.
_SERVICES: dict[Any, tuple[str, float]] = {
    GetRules: ("get_rules", 5.0),
    CheckRules: ("check_rules", 15.0),
    ApplyRules: ("apply_rules", 20.0),
    ConfirmRules: ("confirm_rules", 5.0),
    RollbackRules: ("rollback_rules", 20.0),
    ResetRule: ("reset_rule", 5.0),
    ExplainRule: ("explain_rule", 5.0),
    GetHistory: ("get_history", 5.0),
    GetFirings: ("get_firings", 5.0),
    DescribeGraph: ("describe_graph", 10.0),
    SaveRecording: ("save_recording", 60.0),
    ChangeMissions: ("change_missions", 5.0),
    ChangePlaces: ("change_places", 5.0),
    ChangeZones: ("change_zones", 5.0),
    GetTimeline: ("get_timeline", 5.0),
    ChangeTimeline: ("change_timeline", 5.0),
}
_ACCEPT_LIMIT = 10.0  # s for a back-test to be taken
_ALARMS = TypeAdapter(tuple[Alarm, ...])
_STATUSES = TypeAdapter(tuple[RuleStatus, ...])

T = TypeVar("T")


class Json(Generic[T]):
    """What the monitor wrote of a model of the rulebook: to be passed on as it is, or parsed.

    Attributes
    ----------
    text
        JSON, of which nothing was checked.
    """

    __slots__ = ("_adapter", "text")

    def __init__(self, text: str, model: type[T] | TypeAdapter[T]) -> None:
        self.text = text
        self._adapter = model

    def parsed(self) -> T:
        """The model.

        Raises
        ------
        pydantic.ValidationError
            When the monitor is of another release, or the answer is damaged.
        """
        adapter = self._adapter
        if not isinstance(adapter, TypeAdapter):
            adapter = TypeAdapter(adapter)
        return adapter.validate_json(self.text)


class NoMonitor(NoAnswer):
    """There is no monitor to ask."""

    def __init__(self) -> None:
        super().__init__("no monitor is there")


class Refused(Exception):
    """The monitor did not do it; the message is its sentence, and may be empty."""


class BacktestCanceled(Refused):
    """The back-test was cancelled before its end."""


class NotApplied(Refused):
    """A change of the table was not made. Raised as itself when the table could not be stored.

    Attributes
    ----------
    in_force
        Number of the revision that is in force.
    """

    def __init__(self, message: str, in_force: int) -> None:
        super().__init__(message)
        self.in_force = in_force


class Conflicting(NotApplied):
    """Somebody else was faster; ``conflict`` has both changes."""

    def __init__(self, message: str, in_force: int, conflict: Json[Conflict]) -> None:
        super().__init__(message, in_force)
        self.conflict = conflict


class TableRefused(NotApplied):
    """The table has errors, or is guarded; ``report`` is None when it could not even be read."""

    def __init__(self, message: str, in_force: int, report: Json[CheckReport] | None) -> None:
        super().__init__(message, in_force)
        self.report = report


class Applied(NamedTuple):
    """A table was put in force, as ``revision``."""

    message: str
    revision: int
    report: Json[ApplyReport]


class SavedRecording(NamedTuple):
    """Where a recording was written, on the robot."""

    path: str
    message: str


class BacktestEnd(NamedTuple):
    """What a back-test found, and what there is to remark of it."""

    remark: str
    report: Json[BacktestReport]


class TableState(NamedTuple):
    """What the monitor says of the table in force, a few times a second.

    Attributes
    ----------
    probation_left
        Seconds; 0 when it is not on probation.
    notice
        What a person should know; empty for nothing.
    """

    revision: int
    confirmed: int
    probation_left: float
    notice: str
    statuses: Json[tuple[RuleStatus, ...]]


class Backtest:
    """A back-test that was asked for.

    Attributes
    ----------
    accepted
        Done when the monitor has taken it; Refused when it has not.
    ended
        Its end; Refused when it failed, BacktestCanceled when it was cancelled. It may take any
        time.
    """

    def __init__(
        self,
        node: Node,
        client: ActionClient,
        server: str,
        goal: BacktestRules.Goal,
        signer: Signer,
        limit: float | None,
        progress: Callable[[float, str], None],
    ) -> None:
        self._handle: Any = None
        self._canceled = False
        self._node = node

        def heard(message: Any) -> None:
            progress(min(max(float(message.feedback.progress), 0.0), 1.0), message.feedback.text)

        def send(answered: Callable[[Any], None]) -> Callable[[], object]:
            # From the executor's own thread: rclpy may else see the answer before the question.
            def begin() -> None:
                signed = signer.sign(server, goal)
                client.send_goal_async(signed, heard).add_done_callback(answered)

            node.executor.create_task(begin)
            return self.cancel  # should it be accepted after all

        def ask_result(answered: Callable[[Any], None]) -> Callable[[], object]:
            self._handle.get_result_async().add_done_callback(answered)
            return lambda: None

        self.ended: Reply[BacktestEnd] = Reply(
            server, None, ready=lambda: self._handle is not None, send=ask_result, read=_backtest
        )
        self.accepted: Reply[None] = Reply(
            server,
            limit,
            ready=lambda: signer.is_ready and client.server_is_ready(),
            send=send,
            read=self._accept,
        )

    def cancel(self) -> None:
        """Have it cancelled; of one that has ended, nothing is done. Any thread."""
        self._canceled = True
        if self._handle is not None and not self.ended.done():
            self._node.executor.create_task(self._cancel)

    def _accept(self, handle: Any) -> None:
        if not handle.accepted:
            raise Refused(
                "the monitor refused the back-test; it may run two already, or answer only who "
                "has the robot's key (--robot-key)"
            )
        self._handle = handle
        self.ended.begin()
        if self._canceled:
            self._cancel()

    def _cancel(self) -> None:
        self._handle.cancel_goal_async()


class MonitorClient:
    """The services, the action and the topics of one monitor.

    Requests are signed when we have the key of its robot; see :mod:`kompass.store.robot_key`.

    To be made and closed on the thread that spins the node; all else may be called on any.

    Parameters
    ----------
    node
        Spun by somebody.
    name
        Of the monitor's node, with its namespace: ``/monitor``.
    limit
        Seconds that every answer may take; None for what is usual of each.
    """

    def __init__(self, node: Node, name: str, *, limit: float | None = None) -> None:
        self.name = name
        self._node, self._limit = node, limit
        self._signer = Signer(node, name, known_keys())
        self._clients: dict[type, tuple[Any, str, float]] = {}
        for kind, (service, usual) in _SERVICES.items():
            full = f"{name}/{service}"
            self._clients[kind.Request] = (node.create_client(kind, full), full, usual)
        self._backtests = node.create_action_client(BacktestRules, f"{name}/backtest_rules")
        self._subscriptions: list[Any] = []

    def close(self) -> None:
        """Ask and hear nothing any more."""
        for client, *_ in self._clients.values():
            self._node.destroy_client(client)
        self._backtests.destroy()
        self._signer.close()
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)

    # -- looking ----------------------------------------------------------------------------------

    def table(self, revision: int = 0) -> Reply[Json[TableView]]:
        """A revision of the table; 0 for the one in force."""
        return self._look(GetRules.Request(revision=revision), TableView)

    def history(self, before: int = 0, count: int = 0) -> Reply[Json[History]]:
        """Revisions below ``before`` (0: from the newest), newest first; ``count`` 0 for 50."""
        return self._look(GetHistory.Request(before=before, count=count), History)

    def diff(self, before: int, after: int) -> Reply[Json[TableDiff]]:
        """What differs between two revisions."""
        return self._look(GetHistory.Request(diff_from=before, diff_to=after), TableDiff)

    def explain(
        self, rule_id: str, run_id: int = 0, epoch: str = ""
    ) -> Reply[Json[ExplanationView]]:
        """Why a rule fires or does not: now, or at the firing ``run_id`` of an epoch."""
        request = ExplainRule.Request(rule_id=rule_id, run_id=run_id, epoch=epoch)
        return self._look(request, ExplanationView)

    def firings(self, before: int = 0, count: int = 0, rule_id: str = "") -> Reply[Json[Journal]]:
        """Entries of the journal below ``before`` (0: from the newest); ``count`` 0 for 100."""
        request = GetFirings.Request(before=before, count=count, rule_id=rule_id)
        return self._look(request, Journal)

    def timeline(self, query: TimelineQuery) -> Reply[Json[TimelinePage]]:
        """What has happened, newest first."""
        return self._look(GetTimeline.Request(query=query.model_dump_json()), TimelinePage)

    def graph(self) -> Reply[Json[GraphView]]:
        """What rules can be made of on this robot, now."""
        return self._look(DescribeGraph.Request(), GraphView)

    def check(self, table: str, role: str) -> Reply[Json[CheckReport]]:
        """What is wrong with a table (JSON), and what applying it would do.

        Refused only when the table cannot be read; what is wrong with it is in the report.
        """

        def read(answer: Any) -> Json[CheckReport]:
            if not answer.answer:
                raise Refused(str(answer.message))
            return Json(str(answer.answer), CheckReport)

        return self.request(CheckRules.Request(table=table, role=role), read)

    # -- changing ---------------------------------------------------------------------------------

    def apply(
        self,
        table: str,
        *,
        expected: int,
        author: str,
        role: str,
        reason: str = "",
        probation: float = DEFAULT_PROBATION,
        cancel_running: bool = False,
        reset: Sequence[str] = (),
    ) -> Reply[Applied]:
        """Put a table (JSON) in force; NotApplied when it is not.

        Parameters
        ----------
        expected
            Number of the revision that the edit began from.
        probation
            Seconds after which it is taken back unless confirmed; 0 for never.
        cancel_running
            Cancel running actions of changed and removed rules, instead of letting them finish.
        reset
            Ids of unchanged rules that are to start afresh.
        """
        request = ApplyRules.Request(
            table=table,
            expected_revision=expected,
            author=author,
            role=role,
            reason=reason,
            probation=probation,
            cancel_running=cancel_running,
            reset=list(reset),
        )
        return self.request(request, _applied)

    def roll_back(
        self,
        revision: int = 0,
        *,
        expected: int,
        author: str,
        role: str,
        reason: str = "",
        cancel_running: bool = False,
    ) -> Reply[Applied]:
        """Put an earlier table in force again (0: the one before); NotApplied when it is not."""
        request = RollbackRules.Request(
            revision=revision,
            expected_revision=expected,
            author=author,
            role=role,
            reason=reason,
            cancel_running=cancel_running,
        )
        return self.request(request, _applied)

    def confirm(self, revision: int, *, author: str, role: str) -> Reply[str]:
        """Keep the revision on probation; what the monitor says."""
        request = ConfirmRules.Request(revision=revision, author=author, role=role)
        return self.request(request, _message)

    def reset(self, rule_id: str, *, author: str, role: str) -> Reply[str]:
        """Let a rule start afresh; what the monitor says."""
        return self.request(ResetRule.Request(rule_id=rule_id, author=author, role=role), _message)

    def save_recording(self, seconds: float, name: str) -> Reply[SavedRecording]:
        """Keep the last seconds of the flight recorder (0: all) under a name (empty: the time)."""

        def read(answer: Any) -> SavedRecording:
            return SavedRecording(str(answer.path), _message(answer))

        return self.request(SaveRecording.Request(seconds=seconds, name=name), read)

    def change_place(self, change: PlaceChange, *, author: str, role: str) -> Reply[Place]:
        """Save, edit, delete or restore a place; as it is then, or was before it was deleted."""

        def read(answer: Any) -> Place:
            _message(answer)
            return Place.model_validate_json(answer.answer)

        request = ChangePlaces.Request(change=change.model_dump_json(), author=author, role=role)
        return self.request(request, read)

    def change_zone(self, change: ZoneChange, *, author: str, role: str) -> Reply[Zone]:
        """Save, edit, delete or restore a zone; as it is then, or was before it was deleted."""

        def read(answer: Any) -> Zone:
            _message(answer)
            return Zone.model_validate_json(answer.answer)

        request = ChangeZones.Request(change=change.model_dump_json(), author=author, role=role)
        return self.request(request, read)

    def change_mission(
        self, change: MissionChange, *, author: str, role: str
    ) -> Reply[Mission | None]:
        """Edit a mission, start one, or steer the run; the mission that it was about, if any."""

        def read(answer: Any) -> Mission | None:
            _message(answer)
            return Mission.model_validate_json(answer.answer) if answer.answer else None

        request = ChangeMissions.Request(change=change.model_dump_json(), author=author, role=role)
        return self.request(request, read)

    def change_timeline(self, change: TimelineChange, *, author: str, role: str) -> Reply[None]:
        """Write a note down, or say what is to become of an alarm."""
        request = ChangeTimeline.Request(change=change.model_dump_json(), author=author, role=role)

        def read(answer: Any) -> None:
            _message(answer)

        return self.request(request, read)

    # -- back-tests -------------------------------------------------------------------------------

    @property
    def runs_backtests(self) -> bool:
        """Whether it offers back-tests, and is connected."""
        return bool(self._backtests.server_is_ready())

    @property
    def backtest_servers(self) -> frozenset[bytes]:
        """Who offers back-tests, by the ids that DDS gives.

        A monitor that was started again has the name of the old one and another id, and knows
        nothing of what the old one ran.
        """
        topic = f"{self.name}/backtest_rules/_action/feedback"
        infos = self._node.get_publishers_info_by_topic(topic)
        return frozenset(bytes(info.endpoint_gid) for info in infos)

    def backtest(
        self,
        table: str,
        *,
        recording: str = "",
        seconds: float = 0.0,
        progress: Callable[[float, str], None] = lambda share, text: None,
    ) -> Backtest:
        """Try a table (JSON) on a recording.

        Parameters
        ----------
        recording
            Path of an MCAP file on the robot; empty for the flight recorder's ring.
        seconds
            The last ones of it; 0 for all.
        progress
            Told how far it is (0 to 1), and in a few words; on the thread that spins the node.
        """
        goal = BacktestRules.Goal(table=table, recording=recording, seconds=seconds)
        server = f"{self.name}/backtest_rules"
        limit = _ACCEPT_LIMIT if self._limit is None else self._limit
        return Backtest(self._node, self._backtests, server, goal, self._signer, limit, progress)

    # -- listening, on the thread that spins the node ---------------------------------------------

    def watch_state(self, heard: Callable[[TableState], None]) -> None:
        """Hear how the rules are doing, from what was said last on."""

        def read(message: Any) -> None:
            statuses = Json(str(message.rules) or "[]", _STATUSES)
            heard(
                TableState(
                    int(message.revision),
                    int(message.confirmed),
                    float(message.probation_left),
                    str(message.notice),
                    statuses,
                )
            )

        self._subscribe(RulesState, "rules_state", read, LATCHED)

    def watch_firings(self, heard: Callable[[FiringStep], None]) -> None:
        """Hear every step of every firing."""
        self._subscribe(
            RuleFiring, "firings", lambda message: heard(_step(message)), QoSConfig(queue_size=1000)
        )

    def watch_alarms(self, heard: Callable[[tuple[Alarm, ...]], None]) -> None:
        """Hear of the alarms that stand, from what was said last on."""

        def read(message: Any) -> None:
            heard(_ALARMS.validate_json(message.data or "[]"))

        self._subscribe(String, "alarms", read, LATCHED)

    def watch_places(self, heard: Callable[[str], None]) -> None:
        """Hear of all places (JSON: PlaceBook), from what was said last on."""
        self._subscribe(String, "places", lambda message: heard(str(message.data)), LATCHED)

    def watch_zones(self, heard: Callable[[str], None]) -> None:
        """Hear of all zones (JSON: ZoneBook), from what was said last on."""
        self._subscribe(String, "zones", lambda message: heard(str(message.data)), LATCHED)

    def watch_timeline(self, heard: Callable[[str], None]) -> None:
        """Hear that something has happened (JSON: TimelineNews), from what was said last on."""
        self._subscribe(String, "timeline", lambda message: heard(str(message.data)), LATCHED)

    def watch_missions(self, book: Callable[[str], None], state: Callable[[str], None]) -> None:
        """Hear of all missions (JSON: MissionBook) and of what runs (JSON: MissionState), from what
        was said last on."""
        self._subscribe(String, "missions", lambda message: book(str(message.data)), LATCHED)
        self._subscribe(String, "mission_state", lambda message: state(str(message.data)), LATCHED)

    # -- pieces -----------------------------------------------------------------------------------

    def request(self, request: Any, read: Callable[[Any], T] = lambda answer: answer) -> Reply[T]:
        """Send a request of one of the services, found by its type, signed; the answer as it came.

        Parameters
        ----------
        read
            Makes something else of the answer.
        """
        client, service, usual = self._clients[type(request)]
        return self._signer.call(client, service, request, self._limit or usual, read)

    def _look(self, request: Any, model: type[T]) -> Reply[Json[T]]:
        def read(answer: Any) -> Json[T]:
            _message(answer)
            return Json(str(answer.answer), model)

        return self.request(request, read)

    def _subscribe(
        self, kind: type, topic: str, heard: Callable[[Any], None], qos: QoSConfig
    ) -> None:
        self._subscriptions.append(
            self._node.create_subscription(kind, f"{self.name}/{topic}", heard, qos.to_ros())
        )


def _message(answer: Any) -> str:
    if not answer.success:
        raise Refused(str(answer.message))
    return str(answer.message)


def _applied(answer: Any) -> Applied:
    message, in_force, text = str(answer.message), int(answer.revision), str(answer.answer)
    if answer.outcome == ApplyRules.Request.APPLIED:
        return Applied(message, in_force, Json(text, ApplyReport))
    if answer.outcome == ApplyRules.Request.CONFLICT:
        raise Conflicting(message, in_force, Json(text, Conflict))
    if answer.outcome == ApplyRules.Request.REFUSED:
        raise TableRefused(message, in_force, Json(text, CheckReport) if text else None)
    raise NotApplied(message, in_force)


def _backtest(answer: Any) -> BacktestEnd:
    result = answer.result
    if answer.status == GoalStatus.STATUS_CANCELED:
        raise BacktestCanceled("it was cancelled")
    if not result.success:
        raise Refused(str(result.message))
    return BacktestEnd(str(result.message), Json(str(result.answer), BacktestReport))


def _step(message: Any) -> FiringStep:
    return FiringStep(
        time=message.stamp.sec + 1e-9 * message.stamp.nanosec,
        rule_id=str(message.rule_id),
        rule_hash=str(message.revision),
        revision=int(message.table_revision),
        run_id=int(message.run_id),
        phase=str(message.phase),
        ok=bool(message.ok),
        text=str(message.text),
        details=json.loads(message.details or "null"),
    )
