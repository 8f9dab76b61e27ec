"""A stack in virtual time: the same components, monitor and policies, without a real process."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from kompass.bus.node import LifecycleNode, Transitions
from kompass.components import MapServer, MapServerConfig
from kompass.components.base.component import Component
from kompass.components.drive.drive_manager import DriveManager
from kompass.components.drive.halt import HALT_NODE, PERIOD, Halt
from kompass.launch.gates import feeders_of, halting
from kompass.launch.host import give_life
from kompass.launch.processes import process_name
from kompass.launch.stack import Monitored, Stack
from kompass.monitor.monitor import Monitor
from kompass.monitor.process import NAME as MONITOR
from kompass.monitor.settings import MonitorSettings
from kompass.monitor.start import Start, start_in
from kompass.rules.schema.table import Table
from kompass.share import map_path
from kompass.simulation.faults.fault_manager import FaultRefused
from kompass.simulation.faults.fault_names import TARGETED, FaultOrder
from kompass.simulation.simulator import Simulator
from kompass.simulation.worlds.world import World as Place
from kompass.store import RuleStore
from kompass.store.robot_key import robot_key
from kompass.supervisor.desired_state import DesiredState
from kompass.supervisor.liveness import LivenessLimits, Observation, assess_liveness
from kompass.supervisor.news import ProcessCondition, ProcessNews
from kompass.supervisor.restarts import Restarts
from kompass.supervisor.supervisor import LIVENESS_PERIOD, StartupError
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.lifecycle import VirtualLifecycleNode
from kompass.virtual.node import VirtualNode
from kompass.virtual.process import VirtualProcess, World
from kompass.virtual.scheduler import nanoseconds

STARTING = 0.5  # s from the fork of a process to its first callback
TOLD = 0.0005  # s after which a process reads what the supervisor tells it
LEARNED = 0.001  # s after which the supervisor knows of a death, or a stop
SIMULATOR, MAP_SERVER = "simulator", "map_server"

# Makes what runs in a process; returns who is told of the others, if it wants to be.
Main = Callable[[VirtualProcess], Callable[[str], object] | None]


class _Program:
    """A process of the stack, over all its lives."""

    def __init__(self, name: str, nodes: Sequence[str], main: Main) -> None:
        self.name, self.nodes, self.main = name, list(nodes), main
        self.starts = 0
        self.process: VirtualProcess | None = None
        self.listener: Callable[[str], object] | None = None
        self.began = 0.0
        self.active = False
        self.stopped: float | None = None
        self.condition = "active"
        self.stuck_since: float | None = None
        self.killed = ""

    @property
    def members(self) -> list[str]:
        """Whose conditions are told one by one."""
        return self.nodes or [self.name]


class VirtualStack:
    """Runs a stack and the embedded robot in one virtual world.

    Parameters
    ----------
    world
        Time, network and processes.
    stack
        As a launcher hands it over. Its components become handles of those that run, as in the
        real monitor: a stack is for one world.
    place
        Where the robot is.
    table
        In force at first; the recipe's own when left out.
    orders
        Faults to begin by themselves, in seconds from now.
    folder
        Where the rules are kept, so that they can be edited; None when nothing can be stored.
    """

    def __init__(
        self,
        world: World,
        stack: Stack,
        place: Place,
        *,
        seed: int = 0,
        table: Table | None = None,
        orders: Sequence[FaultOrder] = (),
        folder: Path | None = None,
    ) -> None:
        self._world, self._stack, self._place, self._seed = world, stack, place, seed
        self._table, self._orders, self._folder = table, orders, folder
        # Before any process, as the launcher does: whoever is to sign requests finds it.
        robot_key()
        self._limits = stack.patience or LivenessLimits()
        self._restarts = Restarts(stack.process_retries)
        self._states: dict[str, str] = {}  # the last line told of each process
        self._epochs = 0
        # Told each piece of news that the processes are told.
        self.on_news: Callable[[ProcessNews], object] = lambda _: None
        self.simulator: Simulator | None = None
        # As before any process: a life begins with a copy, as a fork does.
        groups = [copy.deepcopy(list(group)) for group in stack.groups]
        self._programs = [
            _Program(process_name(group), [one.node_name for one in group], self._hosted(group))
            for group in groups
        ]
        if stack.monitored is not None:
            monitor = partial(self._monitor, stack.monitored)
            self._programs.append(_Program(MONITOR, [MONITOR], monitor))
        halted = halting(stack.components)
        if halted is not None:
            self._programs.append(_Program(HALT_NODE, [HALT_NODE], partial(_halt, *halted)))
        known = {name for program in self._programs for name in program.nodes}
        beside = [
            _Program(SIMULATOR, [SIMULATOR], self._simulate),
            _Program(MAP_SERVER, [MAP_SERVER], self._serve_map),
        ]
        self._programs += [one for one in beside if not known & set(one.nodes)]
        self._originals = {id(one): type(one) for one in stack.components}

    def start(self) -> None:
        """Start all processes; they come up while time passes."""
        for program in self._programs:
            self._start(program)
        self._world.scheduler.call_later(nanoseconds(LIVENESS_PERIOD), self._look)

    @property
    def is_up(self) -> bool:
        """Whether all processes work."""
        return all(program.active for program in self._programs)

    # -- the fate of processes ----------------------------------------------------------------

    def program(self, name: str) -> _Program:
        """The process of a name, or of a node.

        Raises
        ------
        FaultRefused
            When there is none.
        """
        for program in self._programs:
            if name in (program.name, *program.nodes):
                return program
        known = ", ".join(program.name for program in self._programs)
        raise FaultRefused(f"no process {name!r} is running; known are {known}")

    def kill(self, name: str) -> None:
        """End a process as SIGKILL does."""
        self._kill(self.program(name), "")

    def stop(self, name: str) -> None:
        """Hold a process as SIGSTOP does."""
        program = self.program(name)
        process = program.process
        if process is None or process.stopped:
            return
        process.stop()
        self._later(LEARNED, self._note_stopped, program, process)

    def go_on(self, name: str) -> None:
        """Let a process go on, as SIGCONT does; nothing where another has taken its place."""
        program = self.program(name)
        if program.process is not None and program.process.stopped:
            program.process.go_on()
            program.stopped = None

    def _kill(self, program: _Program, why: str) -> None:
        process = program.process
        if process is None:
            return
        process.kill()
        program.process, program.killed = None, why
        self._later(LEARNED, self._note_death, program)

    def _note_stopped(self, program: _Program, process: VirtualProcess) -> None:
        if program.process is process and process.stopped:
            program.stopped = self._now
            self._assess(program)

    def _note_death(self, program: _Program) -> None:
        reason = program.killed or "the process was killed by SIGKILL"
        lived = self._now - program.began
        was_active = program.active
        program.active, program.listener, program.stopped = False, None, None
        program.condition, program.stuck_since, program.killed = "active", None, ""
        self._tell(program, "dead", reason)
        if not was_active and not self._restarts.ever_died(program.name):
            raise StartupError(f"{program.name} could not start")
        delay = self._restarts.after_death(program.name, lived)
        if delay is None:
            text = f"died {self._restarts.in_a_row(program.name)} times in a row"
            self._tell(program, "given up", text)
            return
        self._later(delay, self._start, program)

    def _look(self) -> None:
        """At the heartbeats, as the supervisor does."""
        for program in self._programs:
            self._assess(program)
        self._world.scheduler.call_later(nanoseconds(LIVENESS_PERIOD), self._look)

    def _assess(self, program: _Program) -> None:
        if not program.active or program.process is None:
            return
        held = None if program.stopped is None else self._now - program.stopped
        condition, reason = assess_liveness(
            Observation(silent=held or 0.0, stopped=held), self._limits
        )
        if condition != program.condition:
            program.condition = condition
            self._tell(program, condition, reason, stopped=held is not None)
        if condition != "stuck":
            program.stuck_since = None
        elif program.stuck_since is None:
            program.stuck_since = self._now
        elif self._limits.killed is not None:
            stuck = self._now - program.stuck_since
            if stuck >= self._limits.killed:
                self._kill(program, f"it was stuck for {stuck:.0f} s")

    def _asked(self, line: str) -> None:
        """What the monitor asks of the supervisor."""
        word, _, name = line.partition(" ")
        if word == "restart":
            self._kill(self.program(name), "a restart was asked for")

    # -- lives --------------------------------------------------------------------------------

    def _start(self, program: _Program) -> None:
        program.starts += 1
        program.began = self._now
        program.process = process = self._world.process(program.name)
        self._tell(program, "starting")
        process.later(nanoseconds(STARTING), self._begin, program, process)

    def _begin(self, program: _Program, process: VirtualProcess) -> None:
        program.listener = program.main(process)
        for line in self._states.values():
            self._tell_listener(program, line)
        program.active = True
        self._tell(program, "active")

    def _tell(
        self,
        program: _Program,
        state: ProcessCondition,
        reason: str = "",
        *,
        stopped: bool = False,
    ) -> None:
        shared = len(program.members) > 1
        for member in program.members:
            name = member if shared else program.name
            nodes = [member] if shared else program.nodes
            pid = 1000 + 100 * program.starts + self._programs.index(program)
            news = ProcessNews(name, nodes, state, pid, program.starts - 1, reason, stopped, pid)
            self._states[name] = news.to_line()
            self.on_news(news)
            for each in self._programs:
                self._tell_listener(each, news.to_line())

    def _tell_listener(self, program: _Program, line: str) -> None:
        if program.listener is not None and program.process is not None:
            program.process.later(nanoseconds(TOLD), program.listener, line)

    # -- what runs in them --------------------------------------------------------------------

    def _hosted(self, group: list[Component]) -> Main:
        desired = DesiredState(
            {one.node_name: one.node_name in self._stack.activate for one in group}
        )
        feeders = {
            one.node_name: feeders_of(one, self._stack.components)
            for one in group
            if one.stops_robot
        }

        def main(process: VirtualProcess) -> Callable[[str], object] | None:
            running = [(one, self._alive(process, one, desired)) for one in copy.deepcopy(group)]
            if not feeders:
                return None

            def listen(line: str) -> None:
                news = ProcessNews.of_line(line)
                if not news.is_lost:
                    return
                for component, executor in running:
                    lost = feeders.get(component.node_name, frozenset()) & set(news.nodes)
                    if lost:
                        text = f"{', '.join(sorted(lost))}: {news.reason}"
                        executor.create_task(component.on_feeder_lost, text)

            return listen

        return main

    def _alive(
        self, process: VirtualProcess, component: Component, desired: DesiredState
    ) -> VirtualExecutor:
        executor = VirtualExecutor(process, component.on_callback_error)

        def make(name: str, transitions: Transitions, namespace: str) -> LifecycleNode:
            return VirtualLifecycleNode(process, name, transitions, namespace)

        give_life(component, executor, desired, self._stack.namespace, make)
        if isinstance(component, DriveManager):
            process.at_death(component.custom_on_shutdown)  # unlocks its file of STOP
        return executor

    def _monitor(self, monitored: Monitored, process: VirtualProcess) -> Callable[[str], object]:
        node = VirtualNode(process, MONITOR, self._stack.namespace)
        executor = VirtualExecutor(process)
        executor.add_node(node)
        self._epochs += 1
        rules = monitored.rules
        table, epoch = self._table or rules.table, f"drill-{self._epochs}"
        settings = MonitorSettings(robot="drill", probation=0.0)
        start, store = Start(table, 0, epoch), None
        if self._folder is not None:
            store = RuleStore.open(self._folder, clock=self._world.clock.wall)
            process.at_death(store.close)  # which no session has ended: that is a crash
            start, store = start_in(store, table, settings, epoch=epoch, stack="drill")
        monitor = Monitor(
            *(node, executor, rules, monitored.catalog, start, store, settings, self._asked)
        )
        for component in rules.components:  # the last monitor has made handles of them
            object.__setattr__(component, "__class__", self._originals[id(component)])
        monitor.reach_components(rules.components)
        return partial(executor.create_task, monitor.process_changed)

    def _simulate(self, process: VirtualProcess) -> None:
        node = VirtualNode(process, SIMULATOR)
        executor = VirtualExecutor(process)
        faults = _VirtualProcessFaults(self)
        self.simulator = Simulator(node, self._place, self._seed, self._orders, faults)
        executor.add_node(node)

    def _serve_map(self, process: VirtualProcess) -> None:
        config = MapServerConfig(map_file_path=str(map_path(self._place.name)))
        server = MapServer(MAP_SERVER, config=config)
        self._alive(process, server, DesiredState({MAP_SERVER: True}))

    # -- time ---------------------------------------------------------------------------------

    @property
    def _now(self) -> float:
        return self._world.clock.monotonic()

    def _later(self, seconds: float, function: Callable[..., object], *args: Any) -> None:
        self._world.scheduler.call_later(nanoseconds(seconds), function, *args)


class _VirtualProcessFaults:
    """Faults of the virtual stack's processes, as a kind of faults of the robot."""

    def __init__(self, stack: VirtualStack) -> None:
        self._stack = stack

    def knows(self, name: str) -> bool:
        return name.partition(":")[0] in TARGETED

    def begin(self, name: str) -> bool:
        kind, _, target = name.partition(":")
        if kind == "kill":
            self._stack.kill(target)
            return False
        self._stack.stop(target)
        return True

    def end(self, name: str) -> None:
        self._stack.go_on(name.partition(":")[2])

    def ended(self) -> Iterable[str]:
        return ()


def _halt(
    gates: Sequence[str], topics: Sequence[Any], frame: str, process: VirtualProcess
) -> Callable[[str], object]:
    node = VirtualNode(process, HALT_NODE)
    executor = VirtualExecutor(process)
    executor.add_node(node)
    halt = Halt(node, gates, topics, frame)
    node.create_timer(PERIOD, halt.look)

    def listen(line: str) -> None:
        halt.note(line)
        halt.look()

    return partial(executor.create_task, listen)
