"""The monitor: everything around the pure engine, put together on one node."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Future
from functools import partial
from typing import Any, NamedTuple

from builtin_interfaces.msg import Time

from kompass.access.gatekeeper import Gatekeeper
from kompass.bus.clock import Clock
from kompass.bus.node import Executor, Node
from kompass.channel.channels import Channels
from kompass.components.base.component import Component
from kompass.monitor.engine_loop import EngineLoop
from kompass.monitor.execution.action_runner import ActionRunner
from kompass.monitor.execution.component_handles import make_handles
from kompass.monitor.execution.runs import Runs
from kompass.monitor.inputs.polled_functions import PolledFunctions
from kompass.monitor.inputs.previews import Previews
from kompass.monitor.inputs.rule_inputs import RuleInputs
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.introspection.graph import Graph
from kompass.monitor.live_engine import LiveEngine
from kompass.monitor.local_socket import LocalAnswer
from kompass.monitor.missions.missions import Missions
from kompass.monitor.places import Places
from kompass.monitor.recording import FlightRecording
from kompass.monitor.reporting.alarms import Alarms
from kompass.monitor.reporting.explanations import Explanations
from kompass.monitor.reporting.firings import Firings
from kompass.monitor.reporting.journal_watch import JournalWatch
from kompass.monitor.reporting.process_states import USAGE_PERIOD, Measure, ProcessStates
from kompass.monitor.reporting.status_proxy import StatusProxy
from kompass.monitor.reporting.supervisor_watch import SupervisorWatch
from kompass.monitor.rules_state import RulesStatePublisher
from kompass.monitor.services import Services, Sources
from kompass.monitor.settings import MonitorSettings
from kompass.monitor.start import Start, with_permissions
from kompass.monitor.tables.active_table import ActiveTable
from kompass.monitor.tables.live_lints import LiveLints
from kompass.monitor.tables.table_manager import TableManager
from kompass.monitor.tables.types import InForce
from kompass.monitor.timeline.timeline import Timeline
from kompass.monitor.timeline.watch import RobotWatch
from kompass.monitor.worker_thread import WorkerThread
from kompass.monitor.zones import Zones
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rclpy_ext.timers import MovableTimer, Timers
from kompass.recipe.table import RecipeRules
from kompass.rulebook.permissions import Permissions
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.schema.table import Table, table_hash
from kompass.store.mission_store import MissionStore
from kompass.store.place_store import PlaceStore
from kompass.store.store import RuleStore
from kompass.store.timeline_store import TimelineStore
from kompass.store.zone_store import ZoneStore
from kompass.supervisor.news import ProcessNews
from kompass.timeline.entry import RevisionLink
from kompass.timeline.happening import Happened

FIT_PERIOD = 0.5  # s between looks at the publishers of the rules' topics
REPEAT_PERIOD = 0.4  # s between repetitions for those who are silent
RATE_PERIOD = 2.0  # s between two measurements of how fast messages come
JOURNAL_PERIOD = 1.0  # s between looks at whether firings can be written down
SUPERVISOR_PERIOD = 0.5  # s between looks at whether the supervisor shows life
STORE_PERIOD = 5.0  # s between tries to write on a disk that was full at the start
STATE_LIMIT = 5.0  # s for the states of all rules to be made
PROBATION_PERIOD = 0.2  # s between looks at the end of a probation


class Memory(NamedTuple):
    """What the robot keeps beside its rules, each in a file of its own that may be damaged alone.

    Attributes
    ----------
    places, missions, zones, timeline
        Open them.
    """

    places: Callable[[], PlaceStore]
    missions: Callable[[], MissionStore]
    zones: Callable[[], ZoneStore]
    timeline: Callable[[], TimelineStore]


class Monitor:
    """Feeds the engine with messages and time, carries out what fires, and offers the services.

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
    settings
        How it runs.
    ask
        Takes a line for the supervisor: ``restart <component>``.
    recording
        The flight recorder; None where there is none.
    channels
        To components; what they answer is for :meth:`component_answered`.
    supervisor_silent
        For how long the supervisor has shown no life [s]; None where it always does.
    memory
        Opens the robot's places, missions, zones and timeline; None where nobody keeps any.
    measure
        What processes take of the machine; None where nobody can tell.
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
        ask: Callable[[str], None],
        recording: FlightRecording | None = None,
        channels: Channels | None = None,
        supervisor_silent: Callable[[], float] | None = None,
        memory: Memory | None = None,
        measure: Measure | None = None,
    ) -> None:
        def stamp() -> Time:
            return node.get_clock().now().to_msg()

        permissions = Permissions(catalog.components(), recipe.table, recipe.opened)
        start = with_permissions(start, permissions)
        self._recording, self._clock = recording, node.clock
        self._main = main = MainThread(executor)
        self._worker = WorkerThread(node, "tables")
        timers = Timers(node)
        gatekeeper = Gatekeeper(node)
        self._timeline = timeline = Timeline(
            *(node, main, timers, gatekeeper), memory.timeline if memory else None
        )
        alarms = Alarms(node, timers, timeline.add)
        timeline.offer_changes(node, alarms)
        self._robot = RobotWatch(node, timers, catalog, timeline.add_all)
        # What fires begins runs, and the end of a run is an input of the engine: a circle.
        wake_up = MovableTimer(timers, lambda: loop.tick())
        loop = EngineLoop(
            compile_table(start.table),
            start.revision,
            start.epoch,
            handle=lambda outputs, table, revision: runs.take(outputs, table, revision),
            wake=wake_up.set,
            used=start.used,
            recipe=_recipe_key(recipe.table, catalog.components()),
            event_log=recording.event_log if recording else None,
            clock=node.clock,
        )
        firings = Firings(
            node, loop, store, stamp, recording.fired if recording else None, timeline.add
        )
        proxy = StatusProxy(node, loop.heard)
        self._processes = ProcessStates(node, proxy, ask, stamp, measure)
        self._runner = ActionRunner(
            *(node, executor, timers, recipe.functions, alarms, permissions),
            frozenset(catalog.components()),
            self._processes.restart_if_stuck,
            channels,
        )
        self._runner.people = self._robot.people
        publishers = self._runner.publishers
        self._runs = runs = Runs(self._runner.run, loop.ended, firings)
        inputs = RuleInputs(node, proxy.pass_on)
        self._polled = PolledFunctions(
            *(node, timers, main, recipe.polled),
            answered=lambda name, answer: loop.answered(f"callable/{name}", answer),
            tell=firings.announce,
        )
        engine = LiveEngine(main, loop, inputs, self._polled, runs, publishers)
        graph = Graph(
            node, catalog, inputs.counts, lambda: publishers.topics, permissions=permissions
        )
        previews = Previews(node, main)
        active = ActiveTable(
            InForce(start.table, start.revision, start.revision, notice=start.notice),
            start.merge,
            changed=lambda gone: main.post(partial(in_force_changed, gone)),
            clock=node.clock.monotonic,
        )
        self._state = state = RulesStatePublisher(node, loop, engine.extras, active, stamp, timers)

        def in_force_changed(gone: frozenset[str]) -> None:
            alarms.end_those_of(gone)
            state.changed()

        tables = TableManager(
            store,
            engine,
            catalog,
            active,
            recipe=recipe.table,
            permissions=permissions,
            robot=settings.robot,
            lints=LiveLints(engine, graph, previews),
            announce=lambda text: main.post(partial(firings.announce, text)),
            later=self._worker.post,
            edited=self._edited,
            safe_mode=settings.safe_mode,
            probation=settings.probation,
        )
        explanations = Explanations(main, loop, engine.extras, store)
        sources = Sources(
            explanations.explain,
            explanations.firings,
            graph.view,
            partial(_save, recording, main, node.clock) if recording else None,
        )
        self._services = Services(
            *(node, main, gatekeeper, self._worker, tables, previews.hear, sources)
        )
        self._places = self._missions = self._zones = None
        if memory is not None:
            self._places = Places(node, main, gatekeeper, memory.places, timeline.add)
            self._missions = Missions(
                *(node, executor, main, timers, gatekeeper, self._runner, catalog, permissions),
                *(self._places, memory.missions, timeline.add_all),
            )
            self._runner.start_mission = self._missions.start
            self._zones = Zones(
                *(node, main, timers, gatekeeper, catalog, sorted(permissions.gates)),
                *(memory.zones, timeline.add),
            )
        if recording:
            recording.start(node, executor, store, gatekeeper)

        def look_at_probation() -> None:
            if active.overdue:
                self._worker.post(tables.end_probation)

        def look_at_store() -> None:
            if not tables.has_recovered():
                self._worker.post(tables.recover)

        timers.every(STORE_PERIOD, look_at_store)
        timers.every(FIT_PERIOD, inputs.fit)
        timers.every(FIT_PERIOD, previews.tidy)
        timers.every(FIT_PERIOD, publishers.fit)
        timers.every(REPEAT_PERIOD, proxy.repeat)
        timers.every(USAGE_PERIOD, self._processes.look)
        timers.every(RATE_PERIOD, graph.measure)
        timers.every(PROBATION_PERIOD, look_at_probation)
        if store is not None:
            watch = JournalWatch(store, alarms, firings.announce)
            timers.every(JOURNAL_PERIOD, watch.look)
        if supervisor_silent is not None:
            supervisor = SupervisorWatch(supervisor_silent, alarms, firings.announce)
            timers.every(SUPERVISOR_PERIOD, supervisor.look)
        engine.begin()
        state.changed()
        if start.notice:
            firings.announce(start.notice)

    def process_changed(self, line: str) -> None:
        """Take the state of a process, as the supervisor tells it (a JSON line)."""
        news = ProcessNews.of_line(line)
        self._runner.channels.changed(news)
        self._processes.changed(news)
        self._robot.process_changed(news)
        if self._missions is not None:
            self._missions.process_changed(news)

    def _edited(self, title: str, revision: int, by: str, reason: str) -> None:
        link = RevisionLink(number=revision)
        now = self._clock.wall()
        self._timeline.add(Happened(now, "edit", title, reason, who=by, link=link))

    def look(self, service: str, fields: Mapping[str, Any]) -> LocalAnswer:
        """Answer who asks on this machine, not over ROS; on a thread of the caller's.

        Parameters
        ----------
        service, fields
            A service that only looks, and its request; or ``rules_state``, which is a topic.

        Raises
        ------
        Exception
            What cannot be answered, as a sentence.
        """
        if service != "rules_state":
            return self._services.look(service, fields)
        told: Future[str] = Future()
        self._main.call(partial(self._state.told_next, told))
        try:
            return LocalAnswer(True, "", told.result(timeout=STATE_LIMIT))
        except TimeoutError:
            late = f"the monitor did not look at all of its rules within {STATE_LIMIT:g} s"
            raise TimeoutError(f"{late}; it is busy: try again") from None

    def component_answered(self, packet: bytes) -> None:
        """Take what a component sent over its channel."""
        self._runner.channels.answered(packet)

    def reach_components(self, components: Iterable[Component]) -> None:
        """Let functions of the recipe, which hold these copies, reach the components themselves."""
        make_handles(components, self._runner.reach)

    def close(self) -> None:
        """End what runs, and begin nothing any more."""
        self._main.close()
        self._worker.close()
        self._services.close()
        if self._missions is not None:
            self._missions.close()
        for kept in (self._places, self._zones):
            if kept is not None:
                kept.close()
        self._runs.close()
        self._timeline.close()
        self._polled.close()
        self._runner.close()
        if self._recording is not None:
            self._recording.close()


def _save(
    recording: FlightRecording, main: MainThread, clock: Clock, seconds: float, name: str
) -> str:
    """Keep the last seconds up to now; no step of the engine is cut in two."""
    return recording.save(seconds, name, main.call(clock.monotonic_ns))


def _recipe_key(rules: Table, components: Iterable[str]) -> str:
    """Tell recipes apart: by their components, and by the rules that they bring."""
    return f"{' '.join(sorted(components))} {table_hash(rules)}"
