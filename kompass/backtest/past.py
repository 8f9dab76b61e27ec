"""The engine before a stretch of a recording: it goes on with the tables that were in force then.

A table that is applied finds what the engine knows at that moment: values, silences, holds,
cooldowns, runs. To apply one to a recording takes the same, so it is worked out in the same way.
"""

from collections.abc import Mapping
from typing import NamedTuple

from kompass.backtest.event_log import Began, Ended, Fired, Heard, LoggedEvent, Resumed, Swapped
from kompass.rules.engine.compiled_table import CompiledTable, compile_table
from kompass.rules.engine.firing import Firing, Input, Output, RunEnded, Sample, Tick
from kompass.rules.engine.migration import MigrationReport, plan_migration, swap
from kompass.rules.engine.schedule import next_deadline
from kompass.rules.engine.state import SPENT, WAITS_FOR_FALSE, EngineState
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.table import Table

# s after which a firing that the log does not have will not be told any more.
_LATE = 1.0


class Untold(NamedTuple):
    """A firing of ours of which the log has not told yet."""

    at: float
    rule_id: str
    run_id: int


class Inherited(NamedTuple):
    """What a table finds that is applied.

    Attributes
    ----------
    state
        Of the engine, with the new table.
    report
        What became of the rules.
    runs
        Our run ids by those of the recording, of what may be running.
    untold
        Firings of the table of before that the log will tell only later.
    since
        Since when the state is known in full; None if from the engine's own beginning.
    """

    state: EngineState
    report: MigrationReport
    runs: dict[int, int]
    untold: tuple[Untold, ...]
    since: float | None


class Past:
    """Follows the event log of one session of the monitor.

    Parameters
    ----------
    event
        The first of the session. After :class:`Resumed`, the newest values may follow as messages
        that were received before (``again``).

    Attributes
    ----------
    epoch
        Name of the session.
    """

    def __init__(self, event: Began | Resumed) -> None:
        self.epoch = event.epoch
        self._since: float | None = None
        self._runs: dict[int, int] = {}
        self._untold: list[Untold] = []
        self._put(event.table)
        self._state = initial_state(self._compiled, event.now, event.used)
        if isinstance(event, Resumed):
            self._since = event.now
            self._recall(event)

    def _put(self, table: Table) -> None:
        self._compiled: CompiledTable = compile_table(table)
        self._types: Mapping[str, set[str]] = self._compiled.topic_types()

    def _recall(self, event: Resumed) -> None:
        """Let rules cool down and run as they did.

        One whose condition is true at first may have been true for long: that is no edge.
        """
        for plan in self._compiled.rules:
            rule, rule_id = self._state.rules[plan.index], plan.rule.id
            if plan.trigger == "edge" and plan.evaluate(self._state.verdicts) is not False:
                rule.armed = WAITS_FOR_FALSE
            if rule_id in event.ended:
                rule.cooldown_end = event.ended[rule_id] + plan.cooldown
            for run, began in event.running.get(rule_id, {}).items():
                rule.runs[self._state.next_run] = began
                self._runs[int(run)] = self._state.next_run
                self._state.next_run += 1

    def take(self, event: LoggedEvent) -> None:
        """Take the next event of the same session."""
        if isinstance(event, Heard):
            self._catch_up(event.now)
            self._hear(event)
        elif isinstance(event, Fired):
            self._catch_up(event.now)
            self._fired(event)
        elif isinstance(event, Ended):
            self._catch_up(event.now)
            run = self._runs.pop(event.run_id, None)
            if run is not None:
                self._feed(RunEnded(event.rule_id, run, event.ok, event.error), event.now)
        elif isinstance(event, Swapped):
            self._catch_up(event.now)
            plan = plan_migration(self._compiled, compile_table(event.table), event.reset)
            self._state, _, outputs = swap(plan, self._state, event.now)
            self._keep(outputs)
            self._put(event.table)

    def apply(self, table: CompiledTable, now: float) -> Inherited:
        """Put a table in force; nothing is taken any more after that."""
        self._catch_up(now)
        plan = plan_migration(self._compiled, table)
        state, report, outputs = swap(plan, self._state, now)
        self._keep(outputs)
        return Inherited(state, report, self._runs, tuple(self._untold), self._since)

    def _hear(self, event: Heard) -> None:
        expected = self._types.get(event.topic.removeprefix("/"))
        if event.type and expected and event.type not in expected:
            return  # the rules ask for another type: the monitor did not hear it
        if event.again:
            remind(self._compiled, self._state, event)
        else:
            self._feed(Sample(event.topic, event.message), event.now)

    def _fired(self, event: Fired) -> None:
        """Take note of what has fired, be it that we knew or not."""
        plan = self._compiled.by_id.get(event.rule_id)
        if event.shadow or plan is None or plan.hash != event.rule_hash:
            return
        for number, ours in enumerate(self._untold):
            if ours.rule_id == event.rule_id:
                self._runs[event.run_id] = ours.run_id
                del self._untold[number]
                return
        # What was before the log began made it fire.
        rule = self._state.rules[plan.index]
        rule.armed = SPENT
        rule.fired += 1
        rule.last_fired = event.now
        rule.runs[self._state.next_run] = event.now
        self._runs[event.run_id] = self._state.next_run
        self._state.next_run += 1

    def _catch_up(self, now: float) -> None:
        while True:
            due = next_deadline(self._compiled, self._state)
            if due is None or due > now:
                break
            self._state, outputs = step(self._compiled, self._state, Tick(), due)
            self._keep(outputs)
        # What did not happen has nothing that could end.
        for ours in [each for each in self._untold if each.at < now - _LATE]:
            self._untold.remove(ours)
            self._feed(RunEnded(ours.rule_id, ours.run_id), now)

    def _feed(self, event: Input, now: float) -> None:
        self._state, outputs = step(self._compiled, self._state, event, now)
        self._keep(outputs)

    def _keep(self, outputs: list[Output]) -> None:
        self._untold += [
            Untold(output.at, output.rule_id, output.run_id)
            for output in outputs
            if isinstance(output, Firing) and not output.shadow
        ]


def remind(table: CompiledTable, state: EngineState, event: Heard) -> None:
    """Let an engine know a message that was handled before: nothing fires on it again."""
    ends = [rule.cooldown_end for rule in state.rules]
    for rule in state.rules:
        rule.cooldown_end = float("inf")
    step(table, state, Sample(event.topic, event.message), event.now)
    for rule, end in zip(state.rules, ends, strict=True):
        rule.cooldown_end = end
