"""Ask the recipe's polled functions, each at the rate that the rules want."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from kompass.bus.node import Node
from kompass.monitor.recipe_call import RecipeCall
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rclpy_ext.timers import Timer, Timers
from kompass.rules.engine.compiled_table import CompiledTable
from kompass.rules.schema.conditions import CallableCondition

RATE = 10.0  # Hz, for a condition that states no rate of its own
THREADS = 8
LONGEST = 10.0  # s for an answer
REPEATED = 60.0  # s within which the same failure is the same


class _Asking:
    """A function that has not answered yet."""

    def __init__(self, function: Callable[[], Any], now: float) -> None:
        self.call = RecipeCall(function)
        self.since = now
        self.is_late = False


class PolledFunctions:
    """Asks in threads: a function that is slow holds up neither the engine nor the others.

    Who raises, or gives no answer for :data:`LONGEST`, is unknown, and that is told; an ``async
    def`` is cancelled then. Who is late is not asked again before it has answered.

    Parameters
    ----------
    node
        Has clock and threads.
    timers
        On the executor's thread.
    main
        The executor's thread.
    functions
        Of the recipe, by name.
    answered
        Takes name and answer (None for unknown), on the executor's thread.
    tell
        Takes a sentence about a function that fails, on the executor's thread.
    """

    def __init__(
        self,
        node: Node,
        timers: Timers,
        main: MainThread,
        functions: Mapping[str, Callable[[], Any]],
        answered: Callable[[str, bool | None], None],
        tell: Callable[[str], None],
    ) -> None:
        self._clock, self._scheduler, self._main = node.clock, timers, main
        self._functions, self._answered, self._tell = functions, answered, tell
        self._timers: dict[str, tuple[float, Timer]] = {}
        self._asking: dict[str, _Asking] = {}
        self._told: dict[str, tuple[str, float]] = {}
        self._threads = node.threads(THREADS, "polled")

    def follow(self, table: CompiledTable) -> None:
        """Ask those that a table wants, and no others; of two rates of one, the faster."""
        wanted: dict[str, float] = {}
        for leaf in table.leaves:
            condition = leaf.condition
            if isinstance(condition, CallableCondition) and condition.name in self._functions:
                rate = condition.rate or RATE
                wanted[condition.name] = max(rate, wanted.get(condition.name, rate))
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
        for _, timer in self._timers.values():
            timer.cancel()
        for asking in self._asking.values():
            asking.call.cancel()
        self._threads.shutdown(wait=False, cancel_futures=True)

    def _ask(self, name: str) -> None:
        asking = self._asking.get(name)
        if asking is None:
            self._asking[name] = asking = _Asking(self._functions[name], self._clock.monotonic())
            self._threads.submit(self._run, name, asking)
        elif not asking.is_late and self._clock.monotonic() - asking.since > LONGEST:
            asking.is_late = True
            asking.call.cancel()
            self._fail(name, f"has not answered for {LONGEST:g} s")

    def _run(self, name: str, asking: _Asking) -> None:
        """In a thread."""
        try:
            answer = bool(asking.call.run())
        except BaseException as error:  # noqa: BLE001 - a recipe's function, exit() in it too
            problem = f"raised {type(error).__name__}: {error}"
            self._main.post(lambda: self._take(name, None, problem))
        else:
            self._main.post(lambda: self._take(name, answer, ""))

    def _take(self, name: str, answer: bool | None, problem: str) -> None:
        late = self._asking.pop(name).is_late
        if name not in self._timers:
            return
        if answer is not None:
            self._told.pop(name, None)
            self._answered(name, answer)
        elif not late:  # what was cancelled for being late has been told of
            self._fail(name, problem)

    def _fail(self, name: str, problem: str) -> None:
        text, at = self._told.get(name, ("", 0.0))
        now = self._clock.monotonic()
        if text != problem or now - at > REPEATED:
            self._told[name] = (problem, now)
            self._tell(f"the condition {name!r} {problem}")
        if name in self._timers:
            self._answered(name, None)
