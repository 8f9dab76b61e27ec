"""A shell around the engine under a virtual clock, which logs the inputs of the engine."""

from heapq import heappop, heappush
from typing import Any

from kompass.backtest.event_log import Began, Ended, Heard, LoggedEvent, Swapped, fired_event
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.firing import Firing, Input, Output, RunEnded, Sample, Tick
from kompass.rules.engine.migration import plan_migration, swap
from kompass.rules.engine.schedule import next_deadline
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.table import Table

FLOAT = "std_msgs/msg/Float64"
EPOCH_TIME = 1_000_000.0  # s since the epoch at monotonic zero


class Shell:
    """Runs take ``lengths`` seconds in turn; late ticks come ``lag`` seconds after their time."""

    def __init__(
        self, table: Table, lengths: tuple[float, ...] = (0.0,), lag: float = 0.0, now: float = 0.0
    ) -> None:
        self.table = compile_table(table)
        self.state = initial_state(self.table, now)
        self.now = now
        self.lengths, self.lag = lengths, lag
        self.revision = 1
        self.log: list[LoggedEvent] = [Began(now, EPOCH_TIME + now, "life", 1, table)]
        self.firings: list[Firing] = []
        self.ends: list[tuple[float, int, str]] = []
        self.cancelled: set[int] = set()

    def say(self, topic: str, message: Any, at: float) -> None:
        self.pass_time(at)
        self.log.append(Heard(at, topic, "" if topic.startswith("callable") else FLOAT, message))
        self._step(Sample(topic, message), at)

    def pass_time(self, until: float) -> None:
        """Wake up for deadlines and ends of runs, as a monitor does."""
        while True:
            due = next_deadline(self.table, self.state)
            wake = None if due is None else due + self.lag
            end = self.ends[0][0] if self.ends else None
            if end is not None and end <= until and (wake is None or end <= wake):
                when, run, rule_id = heappop(self.ends)
                if run not in self.cancelled:
                    self.log.append(Ended(when, rule_id, run))
                    self._step(RunEnded(rule_id, run), when)
            elif wake is not None and wake <= until:
                self._step(Tick(), wake)
            else:
                break
        self.now = until

    def swap(self, table: Table, at: float, reset: tuple[str, ...] = ()) -> None:
        self.pass_time(at)
        new = compile_table(table)
        self.state, _, outputs = swap(plan_migration(self.table, new, reset), self.state, at)
        self.table = new
        self.revision += 1
        self.log.append(Swapped(at, self.revision, table, reset))
        self._take(outputs)

    def _step(self, event: Input, now: float) -> None:
        self.now = max(self.now, now)
        self.state, outputs = step(self.table, self.state, event, now)
        self._take(outputs)

    def _take(self, outputs: list[Output]) -> None:
        for output in outputs:
            if not isinstance(output, Firing):
                continue
            self.cancelled.update(output.cancels)
            self.log.append(fired_event(output, self.revision))
            self.firings.append(output)
            if not output.shadow:
                length = self.lengths[len(self.firings) % len(self.lengths)]
                heappush(self.ends, (self.now + length, output.run_id, output.rule_id))
