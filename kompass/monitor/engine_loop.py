"""The engine with its table, its state and its clock: what goes in, and what comes out."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Collection, Iterable, Mapping
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
from kompass.monitor.event_log import EventLog, NoEventLog
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
        Name of this life of the monitor.
    handle
        Takes what the engine puts out, in its order, and the table and its revision that let it:
        at a swap, those that were in force until then.
    wake
        Told when :meth:`tick` is due, in monotonic seconds; None for not at all.
    used
        Ids of ``once`` rules that have fired in an earlier life of the same stack.
    tape
        Takes down all that the engine takes.
    clock, wall
        Monotonic nanoseconds, and seconds since the epoch.
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
        tape: EventLog | None = None,
        clock: Callable[[], int] = time.monotonic_ns,
        wall: Callable[[], float] = time.time,
    ) -> None:
        self.table, self.revision, self.epoch = table, revision, epoch
        self._handle, self._wake, self._clock, self._wall = handle, wake, clock, wall
        self._tape = tape or NoEventLog()
        self._untaped: deque[tuple[Firing, int]] = deque()
        began = clock()
        self.state: EngineState = initial_state(table, began * 1e-9)
        used = tuple(rule_id for rule_id in used if rule_id in table.by_id)
        for rule_id in used:
            self.state.rules[table.by_id[rule_id].index].fired = 1
        now = began * 1e-9
        self._record(Began(now, wall(), epoch, revision, table.table, used), began)

    @property
    def now(self) -> float:
        """Monotonic seconds, as the engine counts them."""
        return self._clock() * 1e-9

    @property
    def wall_offset(self) -> float:
        """Seconds since the epoch at monotonic zero."""
        return self._wall() - self.now

    def begin(self) -> None:
        """Have oneself woken up; once the shell is ready for it."""
        self._schedule()

    def heard(self, topic: str, type_name: str, message: Any, raw: bytes) -> None:
        """Take a message of ROS."""
        self._tape_fired()
        now = self._clock()
        self._tape.message(topic, type_name, raw, now)
        self._step(Sample(topic, message), now)

    def answered(self, topic: str, answer: Any) -> None:
        """Take the answer of a polled function (topic ``callable/<name>``)."""
        now = self._clock()
        self._record(Heard(now * 1e-9, topic, "", _plain(answer)), now)
        self._step(Sample(topic, answer), now)

    def ended(self, rule_id: str, run_id: int, ok: bool, error: str) -> None:
        """Take the end of a run."""
        now = self._clock()
        self._record(Ended(now * 1e-9, rule_id, run_id, ok, error), now)
        self._step(RunEnded(rule_id, run_id, ok, error), now)

    def tick(self) -> None:
        """Take note that time has passed."""
        self._step(Tick(), self._clock())

    def swap(self, way: Migration, revision: int, reset: Collection[str] = ()) -> Swap:
        """Go on with another table: one step was the old table's, the next is the new one's.

        What was due by now is handled by the old table first.

        Parameters
        ----------
        way
            From the table in force to the other one; made beforehand, because that takes long.
        reset
            Ids of the rules that the bridge starts afresh though they are unchanged.
        """
        assert way.old is self.table
        begun = self._clock()
        now, before = begun * 1e-9, self.revision
        self.state, carried, outputs = swap(way, self.state, now)
        self._untaped += [(output, begun) for output in outputs if isinstance(output, Firing)]
        self._tape_fired()
        self.table, self.revision = way.new, revision
        event = Swapped(now, revision, way.new.table, tuple(reset))
        self._tape.text("swapped", swapped_text(event), begun)
        verdicts = {
            plan.rule.id: verdict_of(way.new, self.state, plan, now) for plan, _ in way.fresh
        }
        pause = (self._clock() - begun) * 1e-9
        # Only now, for what follows from it is the new table's; but it was the old one that fired.
        self._handle(outputs, way.old, before)
        self._schedule()
        return Swap(carried, pause, verdicts)

    def _step(self, event: Input, now: int) -> None:
        self.state, outputs = step(self.table, self.state, event, now * 1e-9)
        if outputs:
            # Handled first, logged afterwards: logging takes about as long as all the rest.
            self._untaped += [(output, now) for output in outputs if isinstance(output, Firing)]
            self._handle(outputs, self.table, self.revision)
            self._tape_fired()
        self._schedule()

    def _tape_fired(self) -> None:
        """Take down what has fired, before anything that follows from it."""
        while self._untaped:
            firing, now = self._untaped.popleft()
            kind, data = to_data(fired_event(firing, self.revision))
            self._tape.event(kind, data, now)

    def _record(self, event: LoggedEvent, now: int) -> None:
        self._tape_fired()
        kind, data = to_data(event)
        self._tape.event(kind, data, now)

    def _schedule(self) -> None:
        self._wake(next_deadline(self.table, self.state))


def _plain(answer: Any) -> Any:
    return (
        answer if answer is None or isinstance(answer, bool | int | float | str) else bool(answer)
    )
