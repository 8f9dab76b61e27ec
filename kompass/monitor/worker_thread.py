"""A thread for what must not hold up the engine."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from kompass.bus.node import Node


class WorkerThread:
    """One thread, which does one thing after another.

    Parameters
    ----------
    node
        Has threads, and logs errors that nobody waits for.
    name
        Of the thread.
    """

    def __init__(self, node: Node, name: str) -> None:
        self._threads = node.threads(1, name)
        self._log = node.get_logger()

    def submit(self, work: Callable[[], Any]) -> Future[Any]:
        """Have something done; what comes of it is in the future."""
        return self._threads.submit(work)

    def post(self, work: Callable[[], None]) -> None:
        """Have something done that nobody waits for; what it raises is logged."""

        def do() -> None:
            try:
                work()
            except Exception as error:  # noqa: BLE001 - a worker's future tells nobody
                self._log.error(f"{type(error).__name__}: {error}")

        self._threads.submit(do)

    def close(self) -> None:
        """Begin nothing more; what is under way ends first."""
        self._threads.shutdown(wait=True, cancel_futures=True)
