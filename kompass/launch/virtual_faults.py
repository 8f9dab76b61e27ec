"""What breaks on the machine of a stack in virtual time: its processes, its disk, its network."""

from __future__ import annotations

import resource
from collections.abc import Callable, Iterable
from typing import Protocol

from kompass.components.drive.halt import HALT_NODE
from kompass.launch.virtual_program import Program
from kompass.launch.wrong_answers import spoiler
from kompass.monitor.process import NAME as MONITOR
from kompass.simulation.faults.fault_manager import FaultRefused
from kompass.simulation.faults.fault_names import AT_ONCE, SIGNALLED, is_of_machine
from kompass.virtual.network import Conditions
from kompass.virtual.process import VirtualProcess, World
from kompass.virtual.scheduler import nanoseconds

# What no component is: of what the robot's own parts say, other faults make something wrong.
SIMULATOR = "simulator"
NO_COMPONENTS = (MONITOR, HALT_NODE, SIMULATOR)
SLOWNESS = 20.0  # times that a starved process takes longer
# s for which one that flickers is stopped, long enough to be told of, and for which it goes on.
HELD, LET_GO = 0.7, 0.8


class Stack(Protocol):
    """A stack in virtual time, as far as faults reach into it."""

    @property
    def world(self) -> World: ...
    def program(self, name: str) -> Program: ...
    def kill(self, name: str) -> None: ...
    def stop(self, name: str) -> None: ...
    def go_on(self, name: str) -> None: ...


class VirtualFaults:
    """Faults of the machine, and of its processes; a kind of faults of the robot.

    Parameters
    ----------
    stack
        What they strike.
    """

    def __init__(self, stack: Stack) -> None:
        self._stack = stack
        self._on: dict[str, Callable[[], object]] = {}  # how each ends
        self._spoilt: list[str] = []  # what the network suffers from

    def knows(self, name: str) -> bool:
        return name.partition(":")[0] in SIGNALLED or is_of_machine(name)

    def begin(self, name: str) -> bool:
        kind, _, argument = name.partition(":")
        if name.startswith(AT_ONCE):
            self._alive(argument, "killed")
            self._stack.kill(argument)
            return False
        match kind:
            case "stop":
                self._alive(argument, "stopped")
                self._stack.stop(argument)
                self._on[name] = lambda: self._stack.go_on(argument)
            case "starve":
                self._on[name] = self._starve(argument)
            case "hang":
                self._on[name] = self._hang(argument)
            case "flicker":
                self._on[name] = self._flicker(argument)
            case "wrong":
                self._on[name] = self._answer_wrongly(argument)
            case "disk_full":
                self._on[name] = _fill_disk()
            case _:
                self._on[name] = self._spoil_network(name)
        return True

    def end(self, name: str) -> None:
        self._on.pop(name)()

    def ended(self) -> Iterable[str]:
        return ()

    def close(self) -> None:
        """End all, so that none outlasts its drive."""
        for name in list(self._on):
            self.end(name)

    def _alive(self, target: str, done: str) -> VirtualProcess:
        """The process that is to be struck.

        Raises
        ------
        FaultRefused
            There is none, or it is dead.
        """
        process = self._stack.program(target).process
        if process is None:
            raise FaultRefused(f"{target} is dead, and cannot be {done}; have it break earlier")
        return process

    def _working(self, target: str, done: str) -> VirtualProcess:
        """As :meth:`_alive`; one that is only just starting is refused, too."""
        process, life = self._alive(target, done), self._stack.program(target).life
        if life is None or not life.active:
            raise FaultRefused(f"{target} is starting, and cannot be {done}; have it break later")
        return process

    def _starve(self, target: str) -> Callable[[], object]:
        """Until it ends, or another process has taken the place of this one."""
        process = self._alive(target, "starved")
        process.slowness *= SLOWNESS

        def end() -> None:
            process.slowness /= SLOWNESS

        return end

    def _hang(self, target: str) -> Callable[[], object]:
        self._working(target, "hung up")
        executors = list(self._stack.program(target).executors(target))
        for executor in executors:
            executor.hang()

        def end() -> None:
            for executor in executors:
                executor.come_round()

        return end

    def _flicker(self, target: str) -> Callable[[], object]:
        """Whichever process has the name by then."""
        scheduler = self._stack.world.scheduler
        on = True

        def hold() -> None:
            if on:
                self._stack.stop(target)
                scheduler.call_later(nanoseconds(HELD), let_go)

        def let_go() -> None:
            self._stack.go_on(target)
            scheduler.call_later(nanoseconds(LET_GO), hold)

        def end() -> None:
            nonlocal on
            on = False
            self._stack.go_on(target)

        hold()
        return end

    def _answer_wrongly(self, target: str) -> Callable[[], object]:
        """Until it ends, or another process has taken the place of this one."""
        process, program = self._working(target, "wrong"), self._stack.program(target)
        nodes = [target] if target in program.nodes else program.nodes
        spoilt = [
            (writer, made)
            for writer in self._stack.world.network.writers_of(process, nodes)
            if (made := spoiler(writer.name, writer.type_name)) is not None
        ]
        if program.name in NO_COMPONENTS or not spoilt:
            raise FaultRefused(
                f"{target} says nothing that others drive by, and cannot be wrong; name a component"
            )
        for writer, made in spoilt:
            writer.alter = made

        def end() -> None:
            for writer, _ in spoilt:
                writer.alter = None

        return end

    def _spoil_network(self, name: str) -> Callable[[], object]:
        """With all else that spoils it at the time."""
        self._spoilt.append(name)
        self._set_network()

        def end() -> None:
            self._spoilt.remove(name)
            self._set_network()

        return end

    def _set_network(self) -> None:
        late, kept = 0.0, 1.0
        for name in self._spoilt:
            kind, _, amount = name.partition(":")
            if kind == "network_late":
                late += float(amount)
            else:
                kept *= 1.0 - float(amount)
        usual = Conditions()
        spoilt = Conditions(usual.fastest + late, usual.slowest + late, 1.0 - kept)
        self._stack.world.network.set_conditions(spoilt)


def _fill_disk() -> Callable[[], object]:
    """The kernel refuses each write of this process to a file: a drive has a process of its own."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, hard))
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
