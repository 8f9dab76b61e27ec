"""The one thread of a node, in virtual time."""

from __future__ import annotations

import inspect
from collections import deque
from collections.abc import Callable, Coroutine
from typing import Any

from rclpy.task import Future

from kompass.rclpy_ext.executor import Task, TimerQueue
from kompass.virtual.process import SleptTooLong, VirtualProcess
from kompass.virtual.scheduler import SECOND, Event, nanoseconds
from kompass.virtual.waiting import begin_turn, end_turn

# Whoever spins a real executor comes round so often, also when nothing happens (launch/host.py).
LONGEST_WAIT = SECOND // 10  # ns

OnError = Callable[[Exception], object]


class VirtualExecutor:
    """Calls one function after the other; see :class:`kompass.rclpy_ext.executor.TaskExecutor`.

    What a function raises is given to ``on_error``, as the host gives it to a component; without
    that, it comes out of the scheduler's run. What a coroutine raises is raised where it is
    awaited.

    Parameters
    ----------
    process
        Which it is a thread of.
    on_error
        Takes what a callback raises.
    """

    def __init__(self, process: VirtualProcess, on_error: OnError | None = None) -> None:
        self._process, self.on_error = process, on_error
        self._scheduler = process.world.scheduler
        self._ready: deque[tuple[Callable[..., object], tuple[Any, ...]]] = deque()
        self._timers: list[TimerQueue] = []
        self._turn: Event | None = None
        self._began = 0  # with the newest turn
        self._free_at = 0
        self._hangs = self._to_hang = False
        # Kept, so that a coroutine of a process that was killed is not closed: its `finally`
        # blocks would run, in a process that is no more.
        self._tasks: set[Task] = set()
        # Not begun yet; closed when they never will be, which runs nothing of them.
        self._to_begin: dict[Coroutine[Any, Any, Any], None] = {}
        process.add_executor(self)

    @property
    def process(self) -> VirtualProcess:
        """The process that it is a thread of."""
        return self._process

    def add_node(self, node: Any) -> bool:
        """Handle what happens at a node."""
        node.join(self)
        return True

    def remove_node(self, node: Any) -> None:
        """Handle it no more."""
        node.join(None)

    def add_timers(self, timers: TimerQueue) -> None:
        """Fire these whenever they are due."""
        self._timers.append(timers)
        self._arrange(self._scheduler.now)

    def push(self, function: Callable[..., object], *args: Any) -> None:
        """Call a function as soon as all that came before is done; what it raises is an error."""
        if self._process.dead:
            return
        self._ready.append((function, args))
        if self._turn is None or self._timers:
            self._arrange(self._scheduler.now)

    def create_task(self, callback: Any, *args: Any, **kwargs: Any) -> Future:
        """Have a function or a coroutine run; a future of its result."""
        if inspect.iscoroutinefunction(callback):
            callback = callback(*args, **kwargs)
        result = Future(executor=self)
        if not inspect.iscoroutine(callback):

            def call() -> None:
                try:
                    result.set_result(callback(*args, **kwargs))
                except Exception as error:
                    result.set_exception(error)
                    result.exception()  # it is told of: rclpy need not, when nobody awaits it
                    raise

            self.push(call)
            return result

        if self._process.dead:
            callback.close()
            return result
        self._to_begin[callback] = None
        self.push(self._begin, callback, result)
        return result

    def _begin(self, coroutine: Coroutine[Any, Any, Any], result: Future) -> None:
        del self._to_begin[coroutine]

        async def run() -> None:
            result.set_result(await coroutine)

        def ended(error: BaseException | None) -> None:
            self._tasks.difference_update(tasks)
            if error is not None:
                result.set_exception(error)

        tasks: list[Task] = []
        task = Task(run(), ended)
        if not task.done:
            tasks.append(task)
            self._tasks.add(task)

    # -- for the process ----------------------------------------------------------------------

    @property
    def lag(self) -> int:
        now = self._scheduler.now
        return now - self._began if self._hangs or now < self._free_at else 0

    def hang(self) -> None:
        """After what came before, begin with a callback that does not return."""
        self._to_hang = True
        self.push(self._hang)

    def _hang(self) -> None:
        self._hangs = self._to_hang

    def come_round(self) -> None:
        """Have it return, or not even begin."""
        self._to_hang = self._hangs = False
        if self._ready or self._timers:
            self._arrange(self._scheduler.now)

    def pause(self) -> None:
        """Have no more turns until :meth:`go_on`."""
        if self._turn is not None:
            self._turn.cancel()
            self._turn = None

    def go_on(self, missed: int) -> None:
        """Have turns again; what was under way takes so many nanoseconds longer."""
        self._free_at += missed
        if self._ready or self._timers:
            self._arrange(self._scheduler.now)

    def clear(self) -> None:
        """Forget all that was to be done."""
        self.pause()
        self._ready.clear()
        self._timers.clear()
        for coroutine in self._to_begin:
            coroutine.close()
        self._to_begin.clear()

    # -- turns --------------------------------------------------------------------------------

    def _arrange(self, at: int) -> None:
        """Have a turn at that time, or before; never while it is busy."""
        if self._hangs or not self._process.runs:
            return
        at = max(at, self._free_at)
        if self._turn is not None:
            if self._turn.at <= at:
                return
            self._turn.cancel()
        self._turn = self._scheduler.call_at(at, self._take_turn)

    def _take_turn(self) -> None:
        self._turn = None
        process, scheduler = self._process, self._scheduler
        now = self._began = scheduler.now
        wait = LONGEST_WAIT
        cost = process.cost()
        process.sending_delay = cost
        # Before what is called, which may stop or kill the process, or raise.
        self._free_at = now + cost
        begin_turn(process)
        try:
            for timers in self._timers:
                wait = min(wait, max(1, nanoseconds(timers.fire())))
            if self._ready and not process.dead:
                function, args = self._ready.popleft()
                function(*args)
        except Exception as error:
            if self.on_error is None:
                raise
            if not process.dead:
                self.on_error(error)
        except SleptTooLong:
            self._hangs = True
        finally:
            end_turn()
            process.sending_delay = 0
            if process.ahead:
                self._sleep_on(process)
            if self._ready:
                self._arrange(self._free_at)
            elif self._timers:
                self._arrange(now + wait)

    def _sleep_on(self, process: VirtualProcess) -> None:
        """Be busy for as long as what was called has slept."""
        self._free_at += process.ahead
        process.ahead = 0
        if self._turn is not None:
            self._turn.cancel()
            self._turn = None
