"""Let other threads have something done on the thread of an executor."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

from rclpy.executors import Executor

T = TypeVar("T")


class MainThread:
    """The thread that spins an executor; to be made on it."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._own = threading.get_ident()
        self._pending: set[Future[object]] = set()
        self._closed = False

    def call(self, function: Callable[[], T]) -> T:
        """Have a function called there, and wait for what it returns or raises.

        Raises
        ------
        RuntimeError
            When the executor ends before its turn comes.
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
                raise RuntimeError("the monitor ends")
            self._executor.create_task(run)
            return done.result()
        finally:
            self._pending.discard(done)

    def post(self, function: Callable[[], None]) -> None:
        """Have a function called there some time soon."""
        self._executor.create_task(function)

    def close(self) -> None:
        """Nobody is waited for any more."""
        self._closed = True
        for done in list(self._pending):
            if not done.done():
                done.set_exception(RuntimeError("the monitor ends"))
