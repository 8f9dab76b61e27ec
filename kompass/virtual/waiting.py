"""Functions that sleep and wait, in virtual time: one at a time, and each in a thread of its own.

Who makes time pass hands over to such a thread and stands still until the thread waits or is done.
So never two of them run at once, and in which order they do is a matter of virtual time alone.
A callback cannot wait so: its turn takes as much longer as it sleeps.
While one runs, what it would wait with is exchanged: ``time.sleep``, conditions (with which events,
queues and futures wait) and the event loops that it makes; and the clocks of :mod:`time` are those
of its world. Locks are not, nor sockets, nor threads that it starts itself.
"""

from __future__ import annotations

import asyncio
import queue
import selectors
import sys
import sysconfig
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path
from typing import Any, SupportsIndex

from kompass.virtual.process import VirtualProcess
from kompass.virtual.scheduler import nanoseconds

PATIENCE = 60.0  # s of real time in which a function must sleep, wait or return
_SLICE = 1.0  # s of it that are waited for at once
_CLOCKS = ("monotonic", "monotonic_ns", "perf_counter", "perf_counter_ns", "time", "time_ns")
_real: dict[str, Any] = {name: getattr(time, name) for name in (*_CLOCKS, "sleep")}
_real_wait = threading.Condition.wait
_real_start = threading.Thread.start
_real_loop = asyncio.events.new_event_loop


class NeverReturned(RuntimeError):
    """A function waits for something that virtual time knows nothing of."""


class Blocking:
    """A function that may wait.

    Parameters
    ----------
    process
        Which it is in: it stops and ends with it.
    name
        Of the thread.
    function
        Must not raise.
    done
        Called when it has come to its end, by who makes time pass.
    """

    def __init__(
        self,
        process: VirtualProcess,
        name: str,
        function: Callable[[], None],
        done: Callable[[], object],
    ) -> None:
        self.process, self._name, self._function, self._done = process, name, function, done
        self._scheduler = process.world.scheduler
        # Bare locks: what a condition waits with is exchanged.
        self._turn, self._yielded = threading.Lock(), threading.Lock()
        self._turn.acquire()
        self._yielded.acquire()
        self.ident = 0
        self._over = False
        self._waits = 0
        self._for: object = None  # what it waits for
        self._woken = False

    def begin(self) -> None:
        """Let it run until it first waits; to be called by who makes time pass."""
        # A daemon: one whose process was killed never comes to its end.
        thread = threading.Thread(target=self._run, name=self._name, daemon=True)
        thread.start()
        self.ident = thread.ident or 0
        self._hand_over()

    def wait(self, seconds: float | None, what: object = None) -> bool:
        """In the thread: let time pass until :meth:`wake`; whether that came in time.

        Parameters
        ----------
        seconds
            At most; None for ever.
        what
            Wakes it.
        """
        self._waits += 1
        self._for, self._woken = what, False
        if seconds is not None:
            self.process.later(max(0, nanoseconds(seconds)), self._go_on, self._waits)
        self._yielded.release()
        self._turn.acquire()
        return self._woken

    def wake(self, what: object) -> None:
        """End its waiting, if it waits for that."""
        if self._for is what and what is not None and not self._woken:
            self._woken = True
            self.process.later(0, self._go_on, self._waits)

    def clock(self, name: str) -> float | int:
        """What a function of :mod:`time` tells in its world."""
        clock = self._scheduler
        now = clock.wall if name.startswith("time") else clock.now
        return now if name.endswith("_ns") else now * 1e-9

    def _run(self) -> None:
        self._turn.acquire()
        self._function()
        self._over = True
        self._yielded.release()

    def _go_on(self, wait: int) -> None:
        # A time limit may run out when it was woken already.
        if wait == self._waits and not self._over:
            self._waits += 1
            self._for = None
            self._hand_over()

    def _comes_back(self) -> bool:
        """Whether it waits or is over in time. A while in which all of this process was stopped,
        or did not get the processor, is nobody's fault: it counts as one slice."""
        left = PATIENCE
        while left > 0.0:
            if self._yielded.acquire(timeout=min(_SLICE, left)):
                return True
            left -= _SLICE
        return False

    def _hand_over(self) -> None:
        global _running
        with in_virtual_time():
            _running = self
            try:
                self._turn.release()
                back = self._comes_back()
            finally:  # Ctrl-C comes here, too
                _running = None
        if not back:
            raise NeverReturned(
                f"{_function_in(self.ident)} in the thread {self._name!r} of {self.process.name} "
                f"has neither returned nor slept for {PATIENCE:g} s: in virtual time it may sleep, "
                "await and wait for the stack, but not for locks, sockets or threads of its own"
            )
        if self._over:
            self._done()


# Folders of what is not the recipe's, with their ends: another name may begin with theirs.
_OURS = tuple(f"{folder}/" for folder in (Path(__file__).parents[1], sysconfig.get_path("stdlib")))


def _function_in(thread: int) -> str:
    """What of a recipe a thread is in, and where, for people."""
    frame, found = sys._current_frames().get(thread), None
    while frame is not None:
        if not frame.f_code.co_filename.startswith(_OURS):
            found = frame  # the outermost one is what the recipe gave
        frame = frame.f_back
    if found is None:
        return "a function"
    file = Path(found.f_code.co_filename).name
    return f"{found.f_code.co_name} (now in line {found.f_lineno} of {file})"


_running: Blocking | None = None


def waiting() -> Blocking | None:
    """The function that runs now, for who is in its thread; else None."""
    found = _running
    return found if found is not None and found.ident == threading.get_ident() else None


_turning: tuple[VirtualProcess, int] | None = None  # and the thread in which it does


def begin_turn(process: VirtualProcess) -> None:
    """Have ``time.sleep`` in this thread make the turn of an executor longer, until it ends."""
    global _turning
    _turning = process, threading.get_ident()
    time.sleep = sleep


def end_turn() -> None:
    """The turn is over."""
    global _turning
    _turning = None
    time.sleep = _real["sleep"]


def sleep(seconds: float | SupportsIndex) -> None:
    """As :func:`time.sleep`: in virtual time where that passes, and else in real time."""
    seconds = float(seconds)
    found = waiting()
    turning = None
    if found is None and _turning is not None and _turning[1] == threading.get_ident():
        turning = _turning[0]
    if found is None and turning is None:
        _real["sleep"](seconds)
    elif seconds < 0:
        raise ValueError("sleep length must be non-negative")
    elif found is not None:
        found.wait(seconds)
    elif turning is not None:
        turning.sleep(nanoseconds(seconds))


def _clock(name: str) -> Callable[[], float | int]:
    real = _real[name]

    def tell() -> float | int:
        found = waiting()
        return real() if found is None else found.clock(name)

    return tell


class _Waiter:
    """What a condition wakes."""

    def __init__(self, blocking: Blocking) -> None:
        self._blocking, self.came = blocking, False

    def release(self) -> None:
        self.came = True
        self._blocking.wake(self)


def _wait(self: Any, timeout: float | None = None) -> bool:
    """As :meth:`threading.Condition.wait`."""
    found = waiting()
    if found is None:
        return _real_wait(self, timeout)
    if not self._is_owned():
        raise RuntimeError("cannot wait on un-acquired lock")
    waiter = _Waiter(found)
    self._waiters.append(waiter)
    saved = self._release_save()
    try:
        if timeout is None or timeout > 0:
            found.wait(timeout, waiter)
    finally:
        self._acquire_restore(saved)
        if not waiter.came:
            self._waiters.remove(waiter)
    return waiter.came


class _Selector(selectors.SelectSelector):
    """Looks at what there is, and otherwise lets virtual time pass."""

    def __init__(self, blocking: Blocking) -> None:
        super().__init__()
        self._blocking = blocking

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        found = super().select(0)
        if not found and (timeout is None or timeout > 0):
            self._blocking.wait(timeout, self)
            found = super().select(0)
        return found


class VirtualLoop(asyncio.SelectorEventLoop):
    """An event loop whose time is virtual, as long as it runs in one thread."""

    def __init__(self, blocking: Blocking) -> None:
        self._blocking, self._looks = blocking, _Selector(blocking)
        super().__init__(self._looks)

    def time(self) -> float:
        return float(self._blocking.clock("monotonic"))

    def run_in_executor(  # type: ignore[override]
        self, executor: Any, func: Callable[..., Any], *args: Any
    ) -> Any:
        """Have a function run in a thread; without an executor, in one of virtual time."""
        if executor is not None:
            return super().run_in_executor(executor, func, *args)
        made: Future[Any] = Future()

        def run() -> None:
            try:
                made.set_result(func(*args))
            except BaseException as error:  # noqa: BLE001 - raised where it is awaited
                made.set_exception(error)

        process = self._blocking.process
        process.later(0, Blocking(process, "executor", run, lambda: None).begin)
        return asyncio.wrap_future(made, loop=self)

    def _write_to_self(self) -> None:
        super()._write_to_self()  # type: ignore[misc]
        self._blocking.wake(self._looks)


def _new_event_loop() -> asyncio.AbstractEventLoop:
    found = waiting()
    return _real_loop() if found is None else VirtualLoop(found)


def _start(self: threading.Thread) -> None:
    """A thread of the function's own is a real one, and begins in real time."""
    global _running
    before, _running = _running, None
    try:
        _real_start(self)
    finally:
        _running = before


_VIRTUAL: Mapping[tuple[Any, str], Any] = {
    **{(time, name): _clock(name) for name in _CLOCKS},
    (time, "sleep"): sleep,
    (threading.Condition, "wait"): _wait,
    (threading.Thread, "start"): _start,
    # Their own names for the clock.
    (threading, "_time"): _clock("monotonic"),
    (queue, "time"): _clock("monotonic"),
    (asyncio.events, "new_event_loop"): _new_event_loop,
    (asyncio, "new_event_loop"): _new_event_loop,
}


@contextmanager
def in_virtual_time() -> Iterator[None]:
    """Exchange what waits, and the clocks of :mod:`time`, while it lasts.

    They go by virtual time in the threads of this module, and as always in all others. What is
    imported meanwhile (``from time import sleep``) stays so.
    """
    before = {key: getattr(*key) for key in _VIRTUAL}
    for (place, name), function in _VIRTUAL.items():
        setattr(place, name, function)
    try:
        yield
    finally:
        for (place, name), function in before.items():
            setattr(place, name, function)
