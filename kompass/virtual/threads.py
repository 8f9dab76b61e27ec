"""Threads, as far as virtual time has any."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any, ParamSpec, TypeVar

from kompass.virtual.process import VirtualProcess
from kompass.virtual.waiting import Blocking, waiting

HOP = 100_000  # ns until a thread begins with what it is given

P = ParamSpec("P")
T = TypeVar("T")


class VirtualFuture(Future[T]):
    """Of what a thread does. Another such thread can wait for it; what has to go on cannot."""

    def result(self, timeout: float | None = None) -> T:
        self._check()
        return super().result(timeout)

    def exception(self, timeout: float | None = None) -> BaseException | None:
        self._check()
        return super().exception(timeout)

    def _check(self) -> None:
        if not self.done() and waiting() is None:
            raise RuntimeError(
                "in virtual time nobody can stand still for a future: it would never be done; use "
                "add_done_callback"
            )


class VirtualThreads(Executor):
    """A pool of threads; see :meth:`kompass.bus.node.Node.threads`.

    Each function begins in an event of its own, a hop after it was handed over, as soon as one of
    the threads is free. It takes no time but what it sleeps and waits
    (:mod:`kompass.virtual.waiting`).

    Parameters
    ----------
    process
        Which they are threads of.
    count
        How many.
    name
        For people.
    """

    def __init__(self, process: VirtualProcess, count: int, name: str) -> None:
        if count < 1:
            raise ValueError(f"threads {name!r}: count = {count!r} must be at least 1")
        self._process, self._name = process, name
        self._free = count
        self._waiting: deque[tuple[Callable[[], None], Future[Any]]] = deque()
        self._closed = False

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Have a function run; a future of its result."""
        if self._closed:
            raise RuntimeError("cannot schedule new futures after shutdown")
        future: Future[T] = VirtualFuture()

        def run() -> None:
            if not future.set_running_or_notify_cancel():
                return
            try:
                result = fn(*args, **kwargs)
            except BaseException as error:  # noqa: BLE001 - raised where it is waited for
                future.set_exception(error)
            else:
                future.set_result(result)

        self._waiting.append((run, future))
        self._process.later(HOP, self._next)
        return future

    def map(self, fn: Any, *iterables: Any, timeout: Any = None, chunksize: int = 1) -> Any:
        """Refused, as waiting for a future is."""
        raise RuntimeError("in virtual time nobody can stand still for a result; use submit")

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Take no more; what was handed over is still done, unless it is cancelled."""
        self._closed = True
        if cancel_futures:
            left, self._waiting = self._waiting, deque()
            for _, future in left:
                future.cancel()

    def _next(self) -> None:
        if self._waiting and self._free:
            run, _ = self._waiting.popleft()
            self._free -= 1
            Blocking(self._process, self._name, run, self._done).begin()

    def _done(self) -> None:
        self._free += 1
        self._next()
