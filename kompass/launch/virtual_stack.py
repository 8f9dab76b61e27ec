"""A stack in virtual time: the same components, monitor and policies, without a real process."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from kompass.bus.node import LifecycleNode, Transitions
from kompass.channel.channels import Channels
from kompass.channel.life import Life as ChannelLife
from kompass.components import MapServer, MapServerConfig
from kompass.components.base.component import Component
from kompass.components.drive.drive_manager import DriveManager
from kompass.components.drive.halt import HALT_NODE, PERIOD, Halt
from kompass.launch.answering import Answering
from kompass.launch.gates import feeders_of, halting
from kompass.launch.host import give_life
from kompass.launch.processes import process_name
from kompass.launch.stack import Monitored, Stack
from kompass.launch.virtual_faults import SIMULATOR, VirtualFaults
from kompass.launch.virtual_program import DEAF, Ears, Main, Program
from kompass.monitor.monitor import Memory, Monitor
from kompass.monitor.process import NAME as MONITOR
from kompass.monitor.recording import FlightRecording
from kompass.monitor.settings import MonitorSettings
from kompass.monitor.start import Start, start_in
from kompass.rules.schema.table import Table
from kompass.share import map_path
from kompass.simulation.faults.fault_manager import FaultRefused
from kompass.simulation.faults.fault_names import FaultOrder
from kompass.simulation.physics.robot_model import TURTLEBOT3, RobotModel
from kompass.simulation.simulator import Simulator
from kompass.simulation.worlds.world import World as Place
from kompass.store.mission_store import MissionStore
from kompass.store.place_store import PlaceStore
from kompass.store.robot_key import robot_key
from kompass.store.store import RuleStore
from kompass.store.timeline_store import TimelineStore
from kompass.store.zone_store import ZoneStore
from kompass.supervisor.desired_state import DesiredState
from kompass.supervisor.news import ProcessNews
from kompass.supervisor.oversight import Life, Oversight
from kompass.supervisor.restarts import Restarts
from kompass.supervisor.supervisor import LIVENESS_PERIOD
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.lifecycle import VirtualLifecycleNode
from kompass.virtual.node import VirtualNode
from kompass.virtual.process import VirtualProcess, World
from kompass.virtual.scheduler import nanoseconds

# s from the fork of a process to its first callback. By chance, for the periods of no two processes
# are in step with each other: how old what one reads of another is, differs from start to start.
STARTING = (0.15, 0.25)
DYING = 0.01  # s that a process takes to be gone, and its supervisor to learn of it
CALLBACK = 0.0003  # s that a callback takes in rclpy, with all that is done around it
TOLD = 0.0005  # s after which a process reads what the supervisor tells it
LEARNED = 0.001  # s after which the supervisor knows that a signal holds a process
MAP_SERVER = "map_server"


def process_names(stack: Stack) -> tuple[str, ...]:
    """What the processes of a stack in virtual time, and the nodes in them, are called.

    Without the simulator, which is no part of the robot: it is the world that it drives in.
    """
    names = {MAP_SERVER, *(one.node_name for one in stack.components)}
    names |= {process_name(group) for group in stack.groups}
    if stack.monitored is not None:
        names.add(MONITOR)
    if halting(stack.components) is not None:
        names.add(HALT_NODE)
    return tuple(sorted(names))


@dataclass(frozen=True)
class Embedded:
    """The embedded robot, and what the stack is told of where it is.

    Attributes
    ----------
    kind
        Which robot.
    map_file
        To be served; None for the map that comes with the world.
    has_map
        False when the stack gets no map at all.
    """

    kind: RobotModel = TURTLEBOT3
    map_file: Path | None = None
    has_map: bool = True


USUAL = Embedded()


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
    recording
        Given to each monitor; None for none.
    embedded
        The robot, and its map.
    remembers
        Whether places, missions and zones are kept in the folder, too.
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
        recording: FlightRecording | None = None,
        embedded: Embedded = USUAL,
        remembers: bool = False,
    ) -> None:
        self._remembers = remembers
        self._world, self._stack, self._place, self._seed = world, stack, place, seed
        self._embedded = embedded
        self._table, self._orders, self._folder = table, orders, folder
        self._recording = recording
        # Before any process, as the launcher does: whoever is to sign requests finds it.
        robot_key()
        self._oversight = Oversight(stack.patience, Restarts(stack.process_retries), self._tell)
        self._epochs = 0
        # Told each piece of news that the processes are told.
        self.on_news: Callable[[ProcessNews], object] = lambda _: None
        self._faults = VirtualFaults(self)
        # As before any process: a life begins with a copy, as a fork does.
        groups = [copy.deepcopy(list(group)) for group in stack.groups]
        self._programs = [
            Program(
                process_name(group),
                [one.node_name for one in group],
                self._hosted(group),
                {one.node_name: one.longest_step for one in group},
            )
            for group in groups
        ]
        if stack.monitored is not None:
            monitor = partial(self._monitor, stack.monitored)
            self._programs.append(Program(MONITOR, [MONITOR], monitor))
        halted = halting(stack.components)
        if halted is not None:
            self._programs.append(Program(HALT_NODE, [HALT_NODE], partial(_halt, *halted)))
        known = {name for program in self._programs for name in program.nodes}
        beside = [
            Program(SIMULATOR, [SIMULATOR], self._simulate),
            Program(MAP_SERVER, [MAP_SERVER], self._serve_map),
        ]
        self._programs += [one for one in beside if not known & set(one.nodes)]
        self._originals = {id(one): type(one) for one in stack.components}

    def start(self) -> None:
        """Start all processes; they come up while time passes."""
        for program in self._programs:
            self._start(program)
        self._world.scheduler.call_later(nanoseconds(LIVENESS_PERIOD), self._look)

    def close(self) -> None:
        """End what is broken beyond the virtual world, too: the disk is that of this process."""
        self._faults.close()

    @property
    def is_up(self) -> bool:
        """Whether all processes work."""
        return all(one.life is not None and one.life.active for one in self._programs)

    # -- the fate of processes ----------------------------------------------------------------

    def program(self, name: str) -> Program:
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

    @property
    def world(self) -> World:
        """Which it runs in."""
        return self._world

    def kill(self, name: str) -> None:
        """End a process as SIGKILL does."""
        self._kill(self.program(name), "")

    def stop(self, name: str) -> None:
        """Hold a process as SIGSTOP does."""
        program = self.program(name)
        process, life = program.process, program.life
        if process is None or life is None or process.stopped:
            return
        process.stop()
        self._later(LEARNED, self._note_stopped, program, life)

    def go_on(self, name: str) -> None:
        """Let a process go on, as SIGCONT does; nothing where another has taken its place."""
        program = self.program(name)
        process, life = program.process, program.life
        if process is not None and life is not None and process.stopped:
            process.go_on()
            self._later(LEARNED, self._note_going_on, process, life)

    def _kill(self, program: Program, why: str) -> None:
        process, life = program.process, program.life
        if process is None or life is None:
            return
        process.kill()
        life.killed = why
        program.process, program.life, program.ears = None, None, DEAF
        self._later(DYING, self._note_death, program, life)

    def _note_stopped(self, program: Program, life: Life) -> None:
        if program.life is life and program.process is not None and program.process.stopped:
            life.stopped = self._now
            self._assess(program)

    def _note_going_on(self, process: VirtualProcess, life: Life) -> None:
        if not process.stopped:
            life.stopped = None

    def _note_death(self, program: Program, life: Life) -> None:
        self._oversight.bury(life, "the process was killed by SIGKILL")
        death = self._oversight.after_death(life, self._now, failed=True)
        if death.delay is not None:
            self._later(death.delay, self._start, program)

    def _look(self) -> None:
        """At the heartbeats, as the supervisor does."""
        for program in self._programs:
            self._assess(program)
        self._world.scheduler.call_later(nanoseconds(LIVENESS_PERIOD), self._look)

    def _assess(self, program: Program) -> None:
        process, life = program.process, program.life
        if process is None or life is None:
            return
        if not life.active:
            assessed = self._oversight.assess_start(life, self._now)
            if assessed.kill:
                self._kill(program, assessed.kill)
            return
        # The thread that shows life of the process as such is held by a signal and nothing else.
        silent = 0.0 if life.stopped is None else self._now - life.stopped
        lags = [executor.lag * 1e-9 for executor in process.executors]
        assessed = self._oversight.assess(
            life,
            self._now,
            silent,
            dict(zip(life.members, lags, strict=True)),
            allowed=program.allowed,
        )
        if assessed.kill:
            self._kill(program, assessed.kill)

    def _asked(self, line: str) -> None:
        """What the monitor asks of the supervisor."""
        word, _, name = line.partition(" ")
        if word == "restart":
            self._kill(self.program(name), "a restart was asked for")

    # -- lives --------------------------------------------------------------------------------

    def _start(self, program: Program) -> None:
        program.starts += 1
        pid = 1000 + 100 * program.starts + self._programs.index(program)
        program.process = process = self._world.process(program.name, CALLBACK)
        program.life = life = Life(
            program.name, program.nodes, pid, pid, program.starts - 1, self._now
        )
        self._oversight.tell(life, "starting")
        chance = self._world.scheduler.random(f"start {program.starts} of {program.name}")
        process.later(nanoseconds(chance.uniform(*STARTING)), self._begin, program, process, life)

    def _begin(self, program: Program, process: VirtualProcess, life: Life) -> None:
        program.ears = program.main(process, life)
        for news in self._oversight.newest:
            self._tell_listener(program, news.to_line())
        self._oversight.activate(life)

    def _tell(self, news: ProcessNews) -> None:
        self.on_news(news)
        line = news.to_line()
        for program in self._programs:
            self._tell_listener(program, line)

    def _tell_listener(self, program: Program, line: str) -> None:
        if program.ears.news is not None and program.process is not None:
            program.process.later(nanoseconds(TOLD), program.ears.news, line)

    def _send(self, name: str, packet: bytes) -> bool:
        """Send over a channel; what a dead process has not read its successor would not take."""
        program = self.program(name)
        if program.ears.packet is not None and program.process is not None:
            program.process.later(nanoseconds(TOLD), program.ears.packet, packet)
        return True

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

        def main(process: VirtualProcess, life: Life) -> Ears:
            running = [(one, self._alive(process, one, desired)) for one in copy.deepcopy(group)]
            answering = Answering(_name_of(life), running, partial(self._send, MONITOR))
            if not feeders:
                return Ears(packet=answering.take)

            def listen(line: str) -> None:
                news = ProcessNews.of_line(line)
                if not news.is_lost:
                    return
                for component, executor in running:
                    lost = feeders.get(component.node_name, frozenset()) & set(news.nodes)
                    if lost:
                        text = f"{', '.join(sorted(lost))}: {news.reason}"
                        executor.create_task(component.on_feeder_lost, text)

            return Ears(listen, answering.take)

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

    def _monitor(self, monitored: Monitored, process: VirtualProcess, life: Life) -> Ears:
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
            *(node, executor, rules, monitored.catalog, start, store, settings, self._asked),
            recording=self._recording,
            memory=self._memory(process) if self._remembers else None,
            channels=Channels(
                _name_of(life),
                {one.node_name: partial(self._send, one.node_name) for one in rules.components},
            ),
        )
        for component in rules.components:  # the last monitor has made handles of them
            object.__setattr__(component, "__class__", self._originals[id(component)])
        monitor.reach_components(rules.components)
        return Ears(
            partial(executor.create_task, monitor.process_changed),
            partial(executor.create_task, monitor.component_answered),
        )

    def _memory(self, process: VirtualProcess) -> Memory:
        """Places, missions, zones and timeline of the folder, as long as the process lives."""
        folder, clock = self._folder, self._world.clock.wall
        assert folder is not None  # whoever is to remember is told where

        def places() -> PlaceStore:
            store = PlaceStore.open(folder, clock=clock)
            process.at_death(store.close)
            return store

        def missions() -> MissionStore:
            store = MissionStore.open(folder, clock=clock)
            process.at_death(store.close)
            return store

        def zones() -> ZoneStore:
            store = ZoneStore.open(folder, clock=clock)
            process.at_death(store.close)
            return store

        def timeline() -> TimelineStore:
            store = TimelineStore.open(folder, clock=clock)
            process.at_death(store.close)
            return store

        return Memory(places, missions, zones, timeline)

    def _simulate(self, process: VirtualProcess, _: Life) -> Ears:
        node = VirtualNode(process, SIMULATOR)
        executor = VirtualExecutor(process)
        Simulator(
            node,
            self._place,
            self._seed,
            self._orders,
            self._faults,
            kind=self._embedded.kind,
            always=self._world.network.ear is not None,
        )
        executor.add_node(node)
        return DEAF

    def _serve_map(self, process: VirtualProcess, _: Life) -> Ears:
        given = self._embedded
        file = str(given.map_file or map_path(self._place.name)) if given.has_map else None
        config = MapServerConfig(map_file_path=file)
        server = MapServer(MAP_SERVER, config=config)
        self._alive(process, server, DesiredState({MAP_SERVER: True}))
        return DEAF

    # -- time ---------------------------------------------------------------------------------

    @property
    def _now(self) -> float:
        return self._world.clock.monotonic()

    def _later(self, seconds: float, function: Callable[..., object], *args: Any) -> None:
        self._world.scheduler.call_later(nanoseconds(seconds), function, *args)


def _halt(
    gates: Sequence[str], topics: Sequence[Any], frame: str, process: VirtualProcess, _: Life
) -> Ears:
    node = VirtualNode(process, HALT_NODE)
    executor = VirtualExecutor(process)
    executor.add_node(node)
    halt = Halt(node, gates, topics, frame)
    node.create_timer(PERIOD, halt.look)

    def listen(line: str) -> None:
        halt.note(line)
        halt.look()

    return Ears(partial(executor.create_task, listen))


def _name_of(life: Life) -> ChannelLife:
    """A life, as who speaks over channels tells it from others."""
    return ChannelLife(life.pid, life.born)
