"""Let other threads have something done on the thread of an executor."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

from rclpy.task import Future as RosFuture

from kompass.bus.node import Executor

T = TypeVar("T")
_ENDED = "the executor has ended"


class MainThread:
    """The thread that spins an executor.

    Parameters
    ----------
    executor
        Spun by the thread that makes this object.
    """

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._own = threading.get_ident()
        self._pending: set[Future[object]] = set()
        self._closed = False

    def call(self, function: Callable[[], T]) -> T:
        """Have a function called there, and wait for what it returns or raises.

        Called on that thread itself, it calls the function at once.

        Raises
        ------
        RuntimeError
            When :meth:`close` comes before its turn.
        """
        if threading.get_ident() == self._own:
            return function()
        done: Future[T] = Future()

        def run() -> None:
            try:
                result = function()
            except Exception as error:  # noqa: BLE001 - raised again where it is waited for
                done.set_exception(error)
            else:
                done.set_result(result)

        self._pending.add(done)  # type: ignore[arg-type]
        try:
            if self._closed:
                raise RuntimeError(_ENDED)
            self._executor.create_task(run)
            return done.result()
        finally:
            self._pending.discard(done)

    def post(self, function: Callable[[], None]) -> None:
        """Have a function called there some time soon; what it raises comes out of the spin."""
        self._executor.create_task(function)

    def future(self) -> RosFuture:
        """A future to be awaited there; any thread may set its result."""
        return RosFuture(executor=self._executor)

    def close(self) -> None:
        """End all waiting in :meth:`call`, with an error."""
        self._closed = True
        for done in list(self._pending):
            if not done.done():
                done.set_exception(RuntimeError(_ENDED))
