"""The monitor: everything around the pure engine, put together on one node."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Mapping
from functools import partial

from builtin_interfaces.msg import Time
from kompass_interfaces.msg import ProcessState, StackState
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.serialization import serialize_message

from kompass.monitor.engine_loop import EngineLoop, Swap
from kompass.monitor.execution.action_runner import ActionRunner
from kompass.monitor.execution.alarms import Alarms
from kompass.monitor.execution.runs import Runs
from kompass.monitor.inputs.polled_functions import PolledFunctions
from kompass.monitor.inputs.rule_inputs import RuleInputs, wanted
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.introspection.graph import Graph
from kompass.monitor.recording import NoRecording, Recording
from kompass.monitor.reporting.explanations import Explanations
from kompass.monitor.reporting.firings import Firings
from kompass.monitor.reporting.journal_watch import JournalWatch
from kompass.monitor.reporting.rules_state import RulesStatePublisher
from kompass.monitor.reporting.status_proxy import StatusProxy
from kompass.monitor.services import Services, Sources
from kompass.monitor.settings import MonitorSettings
from kompass.monitor.start import Start
from kompass.monitor.tables.live_lints import LiveLints
from kompass.monitor.tables.table_manager import TableManager
from kompass.monitor.tables.types import InForce
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rclpy_ext.timers import MovableTimer, Timers
from kompass.rclpy_ext.topic import LATCHED
from kompass.recipe.table import RecipeRules
from kompass.rulebook.views.views import Extras
from kompass.rules.engine.compiled_table import CompiledTable, compile_table
from kompass.rules.engine.migration import plan_migration
from kompass.store import RuleStore

FIT_PERIOD = 0.5  # s between looks at the publishers of the rules' topics
REPEAT_PERIOD = 0.4  # s between repetitions for those who are silent
RATE_PERIOD = 2.0  # s between two measurements of how fast messages come
JOURNAL_PERIOD = 1.0  # s between looks at whether firings can be written down
PROBATION_PERIOD = 0.2  # s between looks at the end of a probation
SILENT = ("stuck", "dead", "given up")  # who cannot speak is spoken for


class Monitor:
    """Feeds the engine with messages and time, carries out what fires, serves the desk.

    The engine, the subscriptions and the actions live on the executor's thread. Requests are
    answered by workers, which come to that thread for the swap and nothing longer.

    Parameters
    ----------
    node, executor
        Where it runs.
    recipe
        The recipe's rules, and the functions that they name.
    catalog
        What rules are checked against.
    start
        The table to begin with.
    store
        None when nothing can be stored.
    """

    def __init__(
        self,
        node: Node,
        executor: Executor,
        recipe: RecipeRules,
        catalog: RecipeCatalog,
        start: Start,
        store: RuleStore | None,
        settings: MonitorSettings,
        recording: Recording | None = None,
    ) -> None:
        self._node = node
        self._recording = recording or NoRecording()
        self._main = MainThread(executor)
        self._spokesman = StatusProxy(node)
        self._processes: dict[str, ProcessState] = {}
        self._stack = node.create_publisher(
            StackState, f"{node.get_name()}/stack_state", LATCHED.to_ros()
        )
        timers = Timers(node)
        self._wake_up = MovableTimer(timers, lambda: self._loop.tick())
        self._loop = EngineLoop(
            compile_table(start.table),
            start.revision,
            start.epoch,
            handle=lambda outputs, table, revision: self._runs.take(outputs, table, revision),
            wake=self._wake_up.set,
            used=start.used,
            tape=self._recording.tape,
        )
        self._firings = Firings(node, self._loop, store, self._stamp, self._recording.fired)
        alarms = Alarms(node)
        self._runner = ActionRunner(node, executor, timers, recipe.functions, alarms)
        self._runs = Runs(self._runner.run, self._loop.ended, self._firings)
        self._inputs = RuleInputs(node, self._receive)
        self._polled = PolledFunctions(
            timers,
            node.get_logger(),
            self._main,
            recipe.polled,
            lambda name, answer: self._loop.answered(f"callable/{name}", answer),
        )
        self._graph = Graph(node, catalog, self._inputs.counts)
        self._desk = TableManager(
            store,
            self,
            catalog,
            InForce(start.table, start.revision, start.revision, notice=start.notice),
            recipe=recipe.table,
            robot=settings.robot,
            lints=LiveLints(self._main, self._loop, self._graph),
            changed=lambda: self._main.post(self._state.changed),
            announce=lambda text: self._main.post(partial(self._firings.announce, text)),
            merge=start.merge,
            safe_mode=settings.safe_mode,
            probation=settings.probation,
        )
        self._state = RulesStatePublisher(
            node,
            self._loop,
            self._extras,
            lambda: (self._desk.in_force, self._desk.probation_left),
            self._stamp,
            timers,
        )
        explaining = Explanations(self._main, self._loop, self._extras, store)
        self._services = Services(
            node,
            self._main,
            self._desk,
            Sources(explaining.explain, explaining.firings, self._graph.view, self._recording.save),
        )
        self._recording.start(node, executor, store)
        self._listen(self._loop.table, _topics(self._loop.table))
        timers.every(FIT_PERIOD, self._inputs.fit)
        timers.every(REPEAT_PERIOD, self._repeat)
        timers.every(RATE_PERIOD, self._graph.measure)
        timers.every(PROBATION_PERIOD, self._look_at_probation)
        if store is not None:
            watch = JournalWatch(store, alarms, self._firings.announce)
            timers.every(JOURNAL_PERIOD, watch.look)
        self._loop.begin()
        self._state.changed()
        if start.notice:
            self._firings.announce(start.notice)

    def close(self) -> None:
        """End what runs, and begin nothing any more."""
        self._main.close()
        self._services.close()
        self._runs.close()
        self._polled.close()
        self._runner.close()
        self._recording.close()

    def process_changed(self, line: str) -> None:
        """The supervisor says how a process is doing (a JSON line)."""
        data = json.loads(line)
        process = ProcessState(**data)
        self._processes[process.name] = process
        self._stack.publish(StackState(stamp=self._stamp(), processes=[*self._processes.values()]))
        for component in process.nodes:
            if process.state in SILENT:
                self._speak_for(component, self._spokesman.begin(component, process.reason))
            elif process.state == "active":
                self._spokesman.end(component)

    def ask_supervisor(self, ask: Callable[[str], None]) -> None:
        """Have a rule's restart of a component that hangs carried out by the supervisor."""

        def restart_stuck(component: str) -> bool:
            processes = self._processes.values()
            stuck = any(one.state == "stuck" and component in one.nodes for one in processes)
            if stuck:
                ask(f"restart {component}")
            return stuck

        self._runner.restart_stuck = restart_stuck

    # -- the engine, as the table manager uses it ------------------------------------------------

    def prepare(self, table: CompiledTable) -> None:
        """Listen to what a coming table needs; the engine goes on between two subscriptions."""
        for name, kind in _topics(table).items():
            # Asked on this thread: whoever calls this is the only one who has topics listened to.
            if not self._inputs.listens_to(name):
                self._main.call(partial(self._inputs.prepare, {name: kind}))

    def swap(
        self, table: CompiledTable, revision: int, reset: Collection[str], cancel: str
    ) -> Swap:
        """Put a table in force between two messages."""
        # Whoever calls this is the only one who changes the table in force.
        way, topics = plan_migration(self._loop.table, table, reset), _topics(table)

        def between_messages() -> Swap:
            swap = self._loop.swap(way, revision, reset)
            self._listen(table, topics)
            if cancel:
                self._runs.cancel(swap.carried.running, cancel)
            self._runs.forget((*swap.carried.reset, *swap.carried.removed))
            return swap

        return self._main.call(between_messages)

    def running(self) -> frozenset[str]:
        """Ids of rules whose actions are running."""
        return self._main.call(self._runs.running)

    # -- into the engine ------------------------------------------------------------------------

    def _listen(self, table: CompiledTable, topics: Mapping[str, str]) -> None:
        self._inputs.follow(topics)
        self._polled.follow(table)

    def _receive(self, topic: str, type_name: str, message: object, raw: bytes) -> None:
        # What comes on the status topics of a dead component comes from ourselves.
        if not self._spokesman.speaks_for(topic.removesuffix("/status").removesuffix("_status")):
            self._loop.heard(topic, type_name, message, raw)

    def _speak_for(self, component: str, message: object) -> None:
        raw = serialize_message(message)
        for topic in (f"{component}/status", f"{component}_status"):
            self._loop.heard(topic, "automatika_ros_sugar/msg/ComponentStatus", message, raw)

    def _repeat(self) -> None:
        for component, message in self._spokesman.repeat().items():
            self._speak_for(component, message)

    def _look_at_probation(self) -> None:
        if self._desk.in_force.probation_ends is not None and not self._desk.probation_left:
            self._services.worker.submit(self._take_back)

    def _take_back(self) -> None:
        try:
            self._desk.tick()
        except Exception as error:  # noqa: BLE001 - said, and tried again at the next look
            self._node.get_logger().error(f"taking the table back failed: {error}")

    # -- out of it ------------------------------------------------------------------------------

    def _extras(self, rule_id: str) -> Extras:
        extras = self._runs.extras(rule_id)
        if self._inputs.broken:
            table = self._loop.table
            for topic in table.by_id[rule_id].topics:
                why = self._inputs.broken.get(table.topics[topic].name)
                if why:
                    return extras._replace(broken=why)
        return extras

    def _stamp(self) -> Time:
        return self._node.get_clock().now().to_msg()


def _topics(table: CompiledTable) -> dict[str, str]:
    return wanted(table.topic_types().items())
