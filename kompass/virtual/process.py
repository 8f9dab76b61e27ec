"""A process that can be killed, stopped and starved, and a world of several."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from typing import Any, Protocol, Self

from kompass.virtual.log import LogEntry
from kompass.virtual.network import GID_PREFIX, Conditions, Endpoint, Network, NodeEntry
from kompass.virtual.scheduler import EPOCH, Event, Scheduler, VirtualClock, nanoseconds

LONGEST_SLEEP = (
    60_000_000_000  # ns in one turn; whoever oversees processes has lost patience before
)
COST = 20e-6  # s that a callback takes; more than 0, so that none can go on for ever at one moment

# Says how long a callback takes [s], given chance.
CostModel = Callable[[random.Random], float]


class SleptTooLong(BaseException):
    """A callback sleeps for longer than anybody waits for it."""


class Thread(Protocol):
    """What happens in a process, one after the other."""

    @property
    def lag(self) -> int:
        """For how long it has not come round [ns]; 0 when there is nothing that holds it up."""

    def hang(self) -> None:
        """Begin with something that does not return until :meth:`come_round`."""

    def come_round(self) -> None:
        """Have what hangs return; nothing where nothing does."""

    def pause(self) -> None:
        """Have nothing happen until :meth:`go_on`."""

    def go_on(self, missed: int) -> None:
        """Go on; what was under way takes so many nanoseconds longer."""

    def clear(self) -> None:
        """Forget all that was to be done."""


class Member(Protocol):
    """A node of a process."""

    @property
    def entry(self) -> NodeEntry: ...
    def destroy_node(self) -> None: ...
    def die(self) -> Sequence[Endpoint]:
        """Have nothing come in or go out any more; the ends that others still believe in."""


class World:
    """Time, a network and the processes on it; as a context, they are killed at its end.

    Parameters
    ----------
    seed
        Of all that is left to chance.
    epoch
        Wall time of the first moment [ns since 1970].
    conditions, discovery, lease
        As of :class:`kompass.virtual.network.Network`; the lease of DDS when left out.

    Attributes
    ----------
    log
        What the nodes have written.
    """

    def __init__(
        self,
        seed: int = 0,
        *,
        epoch: int = EPOCH,
        conditions: Conditions | None = None,
        **options: float,
    ) -> None:
        self.scheduler = Scheduler(seed, epoch)
        self.clock = VirtualClock(self.scheduler)
        self.network = Network(self.scheduler, conditions=conditions, **options)
        self.log: list[LogEntry] = []
        self._started = 0
        self._processes: list[VirtualProcess] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for process in self._processes:
            process.kill()

    def process(self, name: str, cost: float | CostModel = COST) -> VirtualProcess:
        """Start a process; one of a name that has died may be started again."""
        self._started += 1
        process = VirtualProcess(self, name, self._started, cost)
        self._processes.append(process)
        return process


class VirtualProcess:
    """Nodes and executors that live and die together.

    Parameters
    ----------
    world
        Which it is in.
    name
        For conditions of the network.
    serial
        No other process of this world has it.
    cost
        Virtual time that each turn of an executor takes [s]; what is sent leaves at its end.

    Attributes
    ----------
    sending_delay
        How much later than now leaves what it sends [ns].
    slowness
        How many times longer everything takes than it should: 1, and more for one that is starved.
    ahead
        By how much the time of the callback that runs now is ahead of all others' [ns]: it slept.
    """

    def __init__(self, world: World, name: str, serial: int, cost: float | CostModel) -> None:
        self.world, self._name = world, name
        self.prefix = b"\x01\x0f" + serial.to_bytes(GID_PREFIX - 2, "big")
        self.sending_delay = 0
        self.slowness = 1.0
        self.ahead = 0
        self.clock = ProcessClock(self)
        self._cost = cost
        self._fixed = None if callable(cost) else nanoseconds(cost)
        self._chance = world.scheduler.random(f"process {serial}")
        self._dead = False
        self._stopped_at: int | None = None
        self._executors: list[Thread] = []
        self._waiting: list[Callable[[], None]] = []
        self._nodes: list[Member] = []
        self._at_death: list[Callable[[], object]] = []

    @property
    def name(self) -> str:
        return self._name

    @property
    def dead(self) -> bool:
        """Whether it was killed, or has ended."""
        return self._dead

    @property
    def stopped(self) -> bool:
        """Whether a signal holds it."""
        return self._stopped_at is not None

    @property
    def runs(self) -> bool:
        """Whether it is neither dead nor held."""
        return not self._dead and self._stopped_at is None

    @property
    def answers(self) -> bool:
        return self.runs

    @property
    def executors(self) -> Sequence[Thread]:
        """What happens in it, in the order in which they were made."""
        return self._executors

    @property
    def chance(self) -> random.Random:
        """Its own."""
        return self._chance

    def cost(self) -> int:
        """What a turn takes by now [ns]."""
        cost = self._fixed
        if cost is None:
            assert callable(self._cost)
            cost = nanoseconds(self._cost(self._chance))
        return cost if self.slowness == 1.0 else round(cost * self.slowness)

    def later(self, delay: int, function: Callable[..., object], *args: Any) -> Event:
        """Call a function in so many nanoseconds, unless the process is dead by then.

        One that is held then calls it when it goes on.
        """

        def call() -> None:
            if self._stopped_at is not None:
                self._waiting.append(call)
            elif not self._dead:
                function(*args)

        return self.world.scheduler.call_later(delay + self.ahead, call)

    def sleep(self, duration: int) -> None:
        """Have the callback that runs now take so many nanoseconds longer.

        Raises
        ------
        SleptTooLong
            When it has slept for too long; it is not to be caught.
        """
        self.ahead += duration
        self.sending_delay += duration
        if self.ahead > LONGEST_SLEEP:
            raise SleptTooLong

    # -- its fate -----------------------------------------------------------------------------

    def kill(self) -> None:
        """End it as SIGKILL does: nothing of it happens any more, and nobody is told."""
        if self._dead:
            return
        self._dead = True
        for executor in self._executors:
            executor.clear()
        for let_go in self._at_death:
            let_go()
        endpoints = [endpoint for node in self._nodes for endpoint in node.die()]
        self.world.network.forget_later(endpoints, [node.entry for node in self._nodes])

    def end(self) -> None:
        """End it in order: its nodes say good-bye."""
        for node in list(self._nodes):
            node.destroy_node()
        self.kill()

    def stop(self) -> None:
        """Hold it as SIGSTOP does: nothing of it happens, and what comes in waits."""
        if self.runs:
            self._stopped_at = self.world.scheduler.now
            for executor in self._executors:
                executor.pause()

    def go_on(self) -> None:
        """Let it go on, as SIGCONT does."""
        if self._stopped_at is None:
            return
        missed = self.world.scheduler.now - self._stopped_at
        self._stopped_at = None
        if self._dead:
            return
        for executor in self._executors:
            executor.go_on(missed)
        waiting, self._waiting = self._waiting, []
        for call in waiting:
            self.world.scheduler.call_later(0, call)

    # -- for what is in it --------------------------------------------------------------------

    def at_death(self, let_go: Callable[[], object]) -> None:
        """Have something let go of when it dies, as the kernel does with files and their locks."""
        self._at_death.append(let_go)

    def add_executor(self, executor: Thread) -> None:
        """Have it stop and die with the process."""
        self._executors.append(executor)

    def add_node(self, node: Member) -> None:
        """As :meth:`add_executor`."""
        self._nodes.append(node)

    def remove_node(self, node: Member) -> None:
        """One that was destroyed."""
        self._nodes.remove(node)


class ProcessClock:
    """Time as the callbacks of a process see it; see :class:`kompass.bus.clock.Clock`."""

    def __init__(self, process: VirtualProcess) -> None:
        self._process, self._scheduler = process, process.world.scheduler

    def monotonic(self) -> float:
        return (self._scheduler.now + self._process.ahead) * 1e-9

    def monotonic_ns(self) -> int:
        return self._scheduler.now + self._process.ahead

    def wall(self) -> float:
        return (self._scheduler.wall + self._process.ahead) * 1e-9
