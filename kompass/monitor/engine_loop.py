"""The engine with its table, its state and its clock: what goes in, and what comes out."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import partial
from typing import Any, NamedTuple

from kompass.backtest.event_log import (
    Began,
    Ended,
    Heard,
    LoggedEvent,
    Swapped,
    fired_event,
    swapped_text,
    to_data,
)
from kompass.bus.clock import SYSTEM, Clock
from kompass.monitor.recording import EventLog
from kompass.rules.engine.compiled_table import CompiledTable
from kompass.rules.engine.explain import verdict_of
from kompass.rules.engine.firing import Firing, Input, Output, RunEnded, Sample, Tick
from kompass.rules.engine.migration import Migration, MigrationReport, swap
from kompass.rules.engine.schedule import next_deadline
from kompass.rules.engine.state import EngineState
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.values import Verdict


class Swap(NamedTuple):
    """A table went into force.

    Attributes
    ----------
    carried
        What became of each rule, and of the runs in progress.
    pause
        Seconds for which no message was taken.
    verdicts
        What the conditions of new and changed rules said right after it, by rule id.
    """

    carried: MigrationReport
    pause: float
    verdicts: Mapping[str, Verdict] = {}


class EngineLoop:
    """Feeds the pure engine; not thread-safe, everything happens on one thread.

    Parameters
    ----------
    table, revision
        In force at first.
    epoch
        Name of this session of the monitor.
    handle
        Takes what the engine puts out, in its order, and the table and its revision that let it:
        at a swap, those that were in force until then.
    wake
        Told when :meth:`tick` is due, in monotonic seconds; None for not at all.
    used
        Ids of ``once`` rules that have fired in an earlier session of the same stack.
    recipe
        Tells recipes apart, for who reads the event log.
    event_log
        Takes down all that the engine takes; None for nothing.
    clock
        Of the node.
    """

    def __init__(
        self,
        table: CompiledTable,
        revision: int,
        epoch: str,
        *,
        handle: Callable[[list[Output], CompiledTable, int], None],
        wake: Callable[[float | None], None],
        used: Iterable[str] = (),
        recipe: str = "",
        event_log: EventLog | None = None,
        clock: Clock = SYSTEM,
    ) -> None:
        self.table, self.revision, self.epoch = table, revision, epoch
        self._handle, self._wake, self._clock = handle, wake, clock
        self._event_log = event_log
        self._unlogged: deque[Callable[[], None]] = deque()  # in the order in which it happened
        began = clock.monotonic_ns()
        self.state: EngineState = initial_state(table, began * 1e-9)
        used = tuple(rule_id for rule_id in used if rule_id in table.by_id)
        for rule_id in used:
            self.state.rules[table.by_id[rule_id].index].fired = 1
        now = began * 1e-9
        self._log(Began(now, clock.wall(), epoch, revision, table.table, used, recipe), began)

    @property
    def now(self) -> float:
        """Monotonic seconds, as the engine counts them."""
        return self._clock.monotonic_ns() * 1e-9

    @property
    def wall_offset(self) -> float:
        """Seconds since the epoch at monotonic zero."""
        return self._clock.wall() - self.now

    def begin(self) -> None:
        """Let time pass for the engine; called once, when firings can be carried out."""
        self._schedule()

    def heard(self, topic: str, type_name: str, message: Any, raw: bytes) -> None:
        """Take a message of ROS."""
        self._catch_up_log()
        now = self._clock.monotonic_ns()
        if self._event_log is not None:
            self._unlogged.append(partial(self._event_log.message, topic, type_name, raw, now))
        self._step(Sample(topic, message), now)

    def answered(self, topic: str, answer: Any) -> None:
        """Take the answer of a polled function (topic ``callable/<name>``)."""
        now = self._clock.monotonic_ns()
        self._catch_up_log()
        self._log(Heard(now * 1e-9, topic, "", _plain(answer)), now)
        self._step(Sample(topic, answer), now)

    def ended(self, rule_id: str, run_id: int, ok: bool, error: str) -> None:
        """Take the end of a run."""
        now = self._clock.monotonic_ns()
        self._catch_up_log()
        self._log(Ended(now * 1e-9, rule_id, run_id, ok, error), now)
        self._step(RunEnded(rule_id, run_id, ok, error), now)

    def tick(self) -> None:
        """Take note that time has passed."""
        self._step(Tick(), self._clock.monotonic_ns())

    def swap(self, plan: Migration, revision: int, reset: Collection[str] = ()) -> Swap:
        """Go on with another table: one step was the old table's, the next is the new one's.

        What was due by now is handled by the old table first.

        Parameters
        ----------
        plan
            From the table in force to the other one; made beforehand, because that takes long.
        reset
            Ids of the rules that the plan starts afresh though they are unchanged.
        """
        assert plan.old is self.table
        begun = self._clock.monotonic_ns()
        now, before = begun * 1e-9, self.revision
        self.state, carried, outputs = swap(plan, self.state, now)
        self._to_log(outputs, begun)
        self._catch_up_log()
        self.table, self.revision = plan.new, revision
        if self._event_log is not None:
            event = Swapped(now, revision, plan.new.table, tuple(reset))
            self._event_log.text("swapped", swapped_text(event), begun)
        verdicts = {
            rule.rule.id: verdict_of(plan.new, self.state, rule, now) for rule, _ in plan.fresh
        }
        pause = (self._clock.monotonic_ns() - begun) * 1e-9
        # Only now, for what follows from it is the new table's; but it was the old one that fired.
        self._handle(outputs, plan.old, before)
        self._schedule()
        return Swap(carried, pause, verdicts)

    def _step(self, event: Input, now: int) -> None:
        self.state, outputs = step(self.table, self.state, event, now * 1e-9)
        if outputs:
            # Handled first, logged afterwards: logging takes about as long as all the rest.
            self._to_log(outputs, now)
            self._handle(outputs, self.table, self.revision)
        self._catch_up_log()
        self._schedule()

    def _to_log(self, outputs: Iterable[Output], now: int) -> None:
        self._unlogged += [
            partial(self._log_firing, output, now)
            for output in outputs
            if isinstance(output, Firing)
        ]

    def _log_firing(self, firing: Firing, now: int) -> None:
        self._log(fired_event(firing, self.revision), now)

    def _catch_up_log(self) -> None:
        """Log what came and what has fired, before anything that follows from it."""
        while self._unlogged:
            self._unlogged.popleft()()

    def _log(self, event: LoggedEvent, now: int) -> None:
        if self._event_log is not None:
            kind, data = to_data(event)
            self._event_log.event(kind, data, now)

    def _schedule(self) -> None:
        self._wake(next_deadline(self.table, self.state))


def _plain(answer: Any) -> Any:
    return (
        answer if answer is None or isinstance(answer, bool | int | float | str) else bool(answer)
    )
