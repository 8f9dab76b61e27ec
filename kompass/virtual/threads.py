"""Threads, as far as virtual time has any."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any, ParamSpec, TypeVar

from kompass.virtual.process import VirtualProcess

HOP = 100_000  # ns until a thread begins with what it is given

P = ParamSpec("P")
T = TypeVar("T")


class VirtualFuture(Future[T]):
    """Of what a thread does. Nobody can wait for it: there is one thread, and it waits for all."""

    def result(self, timeout: float | None = None) -> T:
        self._check()
        return super().result(timeout)

    def exception(self, timeout: float | None = None) -> BaseException | None:
        self._check()
        return super().exception(timeout)

    def _check(self) -> None:
        if not self.done():
            raise RuntimeError(
                "in virtual time nobody can stand still for a future: it would never be done; use "
                "add_done_callback"
            )


class VirtualThreads(Executor):
    """A pool of threads; see :meth:`kompass.bus.node.Node.threads`.

    Each function is an event of its own, a hop after it was handed over, and takes no time; so
    they come one after the other, in their order, however many threads there are.

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
        self._process = process
        self._waiting: deque[Callable[[], None]] = deque()
        self._closed = False

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Have a function run; a future of its result."""
        if self._closed:
            raise RuntimeError("cannot schedule new futures after shutdown")
        future: Future[T] = VirtualFuture()

        # A function that has to block would run in a real thread here, which has its turn, and
        # gives it back where it would block.
        def run() -> None:
            if not future.set_running_or_notify_cancel():
                return
            try:
                result = fn(*args, **kwargs)
            except BaseException as error:  # noqa: BLE001 - raised where it is waited for
                future.set_exception(error)
            else:
                future.set_result(result)

        run.cancel = future.cancel  # type: ignore[attr-defined]
        self._waiting.append(run)
        self._process.later(HOP, self._next)
        return future

    def map(self, fn: Any, *iterables: Any, timeout: Any = None, chunksize: int = 1) -> Any:
        """Refused, as waiting for a future is."""
        raise RuntimeError("in virtual time nobody can stand still for a result; use submit")

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Take no more; what was handed over is still done, unless it is cancelled."""
        self._closed = True
        if cancel_futures:
            waiting, self._waiting = self._waiting, deque()
            for run in waiting:
                run.cancel()  # type: ignore[attr-defined]

    def _next(self) -> None:
        if self._waiting:
            self._waiting.popleft()()
