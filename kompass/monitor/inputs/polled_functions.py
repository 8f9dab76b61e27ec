"""Ask the recipe's polled functions, each at the rate that the rules want."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

from rclpy.impl.rcutils_logger import RcutilsLogger as Log

from kompass.rclpy_ext.main_thread import MainThread
from kompass.rclpy_ext.timers import Timer, Timers
from kompass.rules.engine.compiled_table import CompiledTable
from kompass.rules.schema.conditions import CallableCondition

RATE = 10.0  # Hz, for a condition that states no rate of its own
THREADS = 8


class PolledFunctions:
    """Asks in threads: a function that is slow holds up neither the engine nor the others.

    Parameters
    ----------
    timers
        On the executor's thread.
    log
        Where a function that raises is told of.
    main
        The executor's thread.
    functions
        Of the recipe, by name.
    answered
        Takes name and answer, on the executor's thread.
    """

    def __init__(
        self,
        timers: Timers,
        log: Log,
        main: MainThread,
        functions: Mapping[str, Callable[[], Any]],
        answered: Callable[[str, Any], None],
    ) -> None:
        self._scheduler, self._log, self._main = timers, log, main
        self._functions, self._answered = functions, answered
        self._timers: dict[str, tuple[float, Timer]] = {}
        self._asked: set[str] = set()
        self._threads = ThreadPoolExecutor(THREADS, thread_name_prefix="polled")

    def follow(self, table: CompiledTable) -> None:
        """Ask those that a table wants, and no others."""
        wanted = {
            leaf.condition.name: leaf.condition.rate or RATE
            for leaf in table.leaves
            if isinstance(leaf.condition, CallableCondition)
            and leaf.condition.name in self._functions
        }
        for name, (rate, timer) in list(self._timers.items()):
            if wanted.get(name) != rate:
                timer.cancel()
                del self._timers[name]
        for name, rate in wanted.items():
            if name not in self._timers:
                timer = self._scheduler.every(1.0 / rate, partial(self._ask, name))
                self._timers[name] = (rate, timer)

    def close(self) -> None:
        """Ask no more."""
        self._threads.shutdown(wait=False, cancel_futures=True)

    def _ask(self, name: str) -> None:
        if name not in self._asked:
            self._asked.add(name)
            self._threads.submit(self._call, name)

    def _call(self, name: str) -> None:
        try:
            answer = self._functions[name]()
        except Exception as error:  # noqa: BLE001 - a recipe's function; unknown, and said so
            self._log.error(
                f"the condition {name!r} raised {type(error).__name__}: {error}",
                throttle_duration_sec=5.0,
            )
            self._asked.discard(name)
            return
        self._main.post(lambda: self._tell(name, answer))

    def _tell(self, name: str, answer: Any) -> None:
        self._asked.discard(name)
        if name in self._timers:
            self._answered(name, answer)
