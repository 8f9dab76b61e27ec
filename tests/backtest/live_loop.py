"""The monitor's own engine loop under a virtual clock, with what it puts into its event log."""

import json
from heapq import heappop, heappush
from typing import Any

from kompass.backtest.event_log import Heard, LoggedEvent, from_data
from kompass.monitor.engine_loop import EngineLoop
from kompass.rules.engine.compiled_table import CompiledTable, compile_table
from kompass.rules.engine.firing import Firing, Output
from kompass.rules.engine.migration import plan_migration
from kompass.rules.schema.table import Table
from tests.support.clock import SetClock

FLOAT = "std_msgs/msg/Float64"
EPOCH_TIME = 1_000_000.0  # s since the epoch at monotonic zero
NS = 1_000_000_000


class LiveLoop:
    """A monitor whose runs take ``length`` seconds.

    ``log`` has what its recorder takes: the event log, and the messages on topics that no rule
    asks for. ``fired`` has what fired, with the revision that let it.
    """

    def __init__(self, table: Table, length: float = 0.0) -> None:
        self.now_ns = NS
        self.length_ns = round(length * NS)
        self.log: list[LoggedEvent] = []
        self.fired: list[tuple[Firing, int]] = []
        self._ends: list[tuple[int, int, str]] = []
        self._wake: float | None = None
        self.loop = EngineLoop(
            compile_table(table),
            1,
            "life",
            handle=self._take,
            wake=self._be_woken,
            event_log=self,
            clock=SetClock(lambda: self.now_ns, EPOCH_TIME),
        )
        self.loop.begin()

    def message(self, topic: str, type_name: str, raw: Any, now_ns: int) -> None:
        self.log.append(Heard(now_ns * 1e-9, topic, type_name, raw))

    def event(self, kind: str, data: dict[str, Any], now_ns: int) -> None:
        self.log.append(from_data(kind, data))

    def text(self, kind: str, text: str, now_ns: int) -> None:
        self.log.append(from_data(kind, json.loads(text)))

    def say(self, topic: str, message: Any, after: float) -> None:
        """Let a message arrive some seconds after what was last."""
        # No monitor reads the same time twice.
        self.pass_time(self.now_ns + max(round(after * NS), NS // 100_000))
        if topic.startswith("callable/"):
            self.loop.answered(topic, message)
        elif topic in self.loop.table.by_topic:
            self.loop.heard(topic, FLOAT, message, message)
        else:
            self.message(topic, FLOAT, message, self.now_ns)

    def apply(self, table: Table, reset: tuple[str, ...] = ()) -> None:
        """Put a table in force now, as the monitor does."""
        compiled: CompiledTable = compile_table(table)
        plan = plan_migration(self.loop.table, compiled, reset)
        self.loop.swap(plan, self.loop.revision + 1, reset)

    def pass_time(self, until_ns: int) -> None:
        """Wake up for what is due, and let runs end, as a monitor does."""
        while True:
            # The first nanosecond at which it is due.
            wake = None if self._wake is None else max(_first_ns(self._wake), self.now_ns)
            end = self._ends[0][0] if self._ends else None
            if end is not None and end <= until_ns and (wake is None or end <= wake):
                self.now_ns, run, rule_id = heappop(self._ends)
                self.loop.ended(rule_id, run, True, "")
            elif wake is not None and wake <= until_ns:
                self.now_ns = wake
                self.loop.tick()
            else:
                break
        self.now_ns = until_ns

    def _be_woken(self, when: float | None) -> None:
        self._wake = when

    def _take(self, outputs: list[Output], table: CompiledTable, revision: int) -> None:
        for output in outputs:
            if isinstance(output, Firing):
                self.fired.append((output, revision))
                if not output.shadow:
                    end = self.now_ns + self.length_ns
                    heappush(self._ends, (end, output.run_id, output.rule_id))


def _first_ns(seconds: float) -> int:
    ns = int(seconds * NS) - 1
    while ns * 1e-9 < seconds:
        ns += 1
    return ns
