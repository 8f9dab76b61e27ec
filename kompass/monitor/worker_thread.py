"""A thread for what must not hold up the engine."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from rclpy.impl.rcutils_logger import RcutilsLogger


class WorkerThread(ThreadPoolExecutor):
    """One thread, which does one thing after another.

    Parameters
    ----------
    name
        Of the thread.
    log
        Where errors are told that nobody waits for.
    """

    def __init__(self, name: str, log: RcutilsLogger) -> None:
        super().__init__(1, thread_name_prefix=name)
        self._log = log

    def post(self, work: Callable[[], None]) -> None:
        """Have something done that nobody waits for; what it raises is logged."""

        def do() -> None:
            try:
                work()
            except Exception as error:  # noqa: BLE001 - a worker's future tells nobody
                self._log.error(f"{type(error).__name__}: {error}")

        self.submit(do)

    def close(self) -> None:
        """Begin nothing more; what is under way ends first."""
        self.shutdown(wait=True, cancel_futures=True)
