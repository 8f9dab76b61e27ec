"""What a table would have done on a recording: the same engine, fed with what it took then.

Where the table fires as the recorded one did, its runs end when the recorded runs ended. A run that
did not happen then is taken to last as long as that rule's runs usually did; what its actions would
have changed in the world nobody knows, and what fires after it is marked as assumed.
"""

from collections.abc import Callable, Iterable, Mapping
from heapq import heappop, heappush
from typing import NamedTuple

from kompass.backtest.event_log import (
    Began,
    Ended,
    Fired,
    Heard,
    LoggedEvent,
    Lost,
    Resumed,
    Swapped,
)
from kompass.backtest.notes import ReplayNotes
from kompass.backtest.recorded_runs import RecordedRuns
from kompass.backtest.report import BacktestFiring, BacktestReport, RuleTally
from kompass.rulebook.schema.status import LeafReading
from kompass.rulebook.views.views import leaf_reading, why_not
from kompass.rules.engine.compiled_table import CompiledTable, RulePlan, compile_table
from kompass.rules.engine.firing import Firing, Input, RunEnded, Sample, Tick
from kompass.rules.engine.migration import migrate_state
from kompass.rules.engine.schedule import next_deadline
from kompass.rules.engine.state import WAITS_FOR_FALSE, EngineState, counters
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.conditions import Absent, Rate, timeout_of
from kompass.rules.schema.table import Table, rule_hash

FIRINGS = 5_000  # in a report; more are counted and not listed
_STRIDE = 2_000  # events between two reports of progress


def backtest(
    table: Table,
    events: Iterable[LoggedEvent],
    recorded: Iterable[LoggedEvent] = (),
    *,
    total: int = 0,
    progress: Callable[[float], None] | None = None,
    clock: Callable[[], float] | None = None,
    limit: int = FIRINGS,
) -> BacktestReport:
    """Replay a recording with a table.

    Parameters
    ----------
    table
        The proposed table.
    events
        The event log, in its order. Without a ``Began`` or ``Resumed`` at its beginning (a
        recording that no monitor made) the engine begins with the first message, whose ``now``
        then counts as seconds since the epoch.
    recorded
        The events of the same time other than ``Heard``, read beforehand: the
        firings to compare with, and how long runs took. Empty when there are none.
    total
        Number of events, for the progress.
    progress
        Called now and then with the share that is done, 0 to 1; may raise to cancel.
    clock
        Seconds of any clock, to tell how long the replay took.
    limit
        How many firings are listed at most.
    """
    begun = clock() if clock else 0.0
    replay = _Replay(table, RecordedRuns(recorded))
    for number, event in enumerate(events):
        replay.take(event)
        if progress and number % _STRIDE == 0 and total:
            progress(min(number / total, 1.0))
    replay.end()
    if progress:
        progress(1.0)
    return replay.report(limit, clock() - begun if clock else 0.0)


class _Found(NamedTuple):
    """A firing of the report before it is one."""

    time: float  # s since the epoch
    order: int
    rule_id: str
    verdict: str
    leaves: tuple[LeafReading, ...]
    text: str
    assumed: bool


class _Replay:
    def __init__(self, table: Table, recorded: RecordedRuns) -> None:
        self._table = table
        self._recorded = recorded
        self._compiled: CompiledTable = compile_table(table)
        self._types = self._compiled.topic_types()
        self._notes = ReplayNotes(self._compiled)
        self._state: EngineState | None = None
        self._live: dict[str, str] = {}  # rule hashes of the table in force in the recording
        self._epoch = ""
        self._offset = 0.0
        self._runs: dict[int, int] = {}  # recorded run id -> ours
        self._ends: list[
            tuple[float, int, str]
        ] = []  # of runs that did not happen: when, run, rule
        self._assumed: set[str] = set()
        self._unsure: dict[str, float] = {}  # until when what was before may still matter, by rule
        self._reasons: dict[tuple[str, int], str] = {}  # why recorded firings do not happen
        self._found: list[_Found] = []
        self._first: float | None = None
        self._last = 0.0  # s since the epoch
        self._reached = 0.0  # s of the engine's clock
        self._messages = 0
        self._warm_up = 0.0
        self._totals: dict[str, tuple[int, int]] = {}  # evaluated and true, of ended sessions

    # -- the event log ------------------------------------------------------------------------

    def take(self, event: LoggedEvent) -> None:
        """Take the next event."""
        if isinstance(event, (Began, Resumed)):
            self._begin(event)
            return
        if isinstance(event, Lost):
            return
        if isinstance(event, Fired):
            self._compare(event)
            if self._state is not None:
                # It may be the last event of the log, and time alone its cause.
                self._catch_up(event.now)
                self._reach(event.now)
            return
        if self._state is None:
            self._start(event.now, 0.0, "", ())
        self._catch_up(event.now)
        if isinstance(event, Heard):
            self._hear(event)
        elif isinstance(event, Ended):
            run = self._runs.pop(event.run_id, None)
            if run is not None:
                self._feed(RunEnded(event.rule_id, run, event.ok, event.error), event.now)
        elif isinstance(event, Swapped):
            self._swap(event)
        self._reach(event.now)

    def _reach(self, now: float) -> None:
        # Kept in the engine's time too: on the way to the wall's and back it loses its last digits.
        self._reached = max(self._reached, now)
        self._last = self._reached + self._offset

    def _begin(self, event: Began | Resumed) -> None:
        hashes = {rule.id: rule_hash(rule) for rule in event.table.rules}
        if isinstance(event, Resumed) and self._state is not None and event.epoch == self._epoch:
            return  # the next file of the same session
        self._close()
        self._start(event.now, event.wall - event.now, event.epoch, event.used)
        if isinstance(event, Resumed):
            self._midway(event.now)
            self._recall(event, hashes)
        self._live = hashes

    def _start(self, now: float, offset: float, epoch: str, used: tuple[str, ...]) -> None:
        self._state = initial_state(self._compiled, now, used)
        self._offset, self._epoch = offset, epoch
        self._unsure.clear()
        self._notes.begin(now)
        if self._first is None:
            self._first = now + offset
            if not epoch:
                self._midway(now)
        self._reached = now
        self._last = now + offset

    def _midway(self, now: float) -> None:
        """Take note that something was before of which nothing is known."""
        lasts = {plan.rule.id: _memory(self._compiled, plan) for plan in self._compiled.rules}
        self._unsure = {rule_id: now + seconds for rule_id, seconds in lasts.items()}
        self._warm_up = max(self._warm_up, *lasts.values(), 0.0)

    def _recall(self, event: Resumed, hashes: Mapping[str, str]) -> None:
        """Let rules that were in force then cool down and run as they did.

        One whose condition is true at first may have been true for long: that is no edge.
        """
        state = self._state
        assert state is not None
        for plan in self._compiled.rules:
            rule, rule_id = state.rules[plan.index], plan.rule.id
            if plan.trigger == "edge" and plan.evaluate(state.verdicts) is not False:
                rule.armed = WAITS_FOR_FALSE
            if hashes.get(rule_id) != plan.hash:
                continue
            if rule_id in event.ended:
                rule.cooldown_end = event.ended[rule_id] + plan.cooldown
            for run, began in event.running.get(rule_id, {}).items():
                rule.runs[state.next_run] = began
                self._runs[int(run)] = state.next_run
                state.next_run += 1

    def _hear(self, event: Heard) -> None:
        self._messages += 1
        topic = event.topic.removeprefix("/")
        expected = self._types.get(topic)
        if event.type and expected and event.type not in expected:
            return  # the rules ask for another type: the monitor would not have heard it
        if event.again:
            self._remind(event)
        else:
            self._feed(Sample(event.topic, event.message), event.now)
        assert self._state is not None
        self._notes.heard(self._state, topic)

    def _remind(self, event: Heard) -> None:
        """Let the engine know a message that it has handled before: nothing fires on it again."""
        state = self._state
        assert state is not None
        ends = [rule.cooldown_end for rule in state.rules]
        for rule in state.rules:
            rule.cooldown_end = float("inf")
        step(self._compiled, state, Sample(event.topic, event.message), event.now)
        for rule, end in zip(state.rules, ends, strict=True):
            rule.cooldown_end = end
        self._notes.passed(state, event.now)

    def _swap(self, event: Swapped) -> None:
        """Have rules start afresh where they did: on request, and where they came into force."""
        assert self._state is not None
        self._feed(Tick(), event.now)
        hashes = {rule.id: rule_hash(rule) for rule in event.table.rules}
        afresh = {
            plan.rule.id
            for plan in self._compiled.rules
            if hashes.get(plan.rule.id) == plan.hash
            and (plan.rule.id in event.reset or self._live.get(plan.rule.id) != plan.hash)
        }
        self._live = hashes
        if afresh:
            for rule_id in afresh:
                self._count(rule_id)
            self._state, _ = migrate_state(
                self._compiled, self._state, self._compiled, event.now, tuple(afresh)
            )

    def end(self) -> None:
        """Take note that nothing follows."""
        self._close()

    def _close(self) -> None:
        """End a session of the engine."""
        if self._state is None:
            return
        self._catch_up(self._reached)
        self._notes.end(self._state)
        for plan in self._compiled.rules:
            self._count(plan.rule.id)
        for rule_id, gone in self._recorded.unmatched(self._epoch):
            self._add(gone.now, rule_id, "gone", gone.leaves, self._why_gone(gone), False)
        self._runs.clear()
        self._ends.clear()
        self._assumed.clear()
        self._reasons.clear()
        self._state = None

    def _count(self, rule_id: str) -> None:
        """Keep the counts of a rule that is about to lose them."""
        assert self._state is not None
        numbers = counters(self._compiled, self._state, rule_id)
        evaluated, true = self._totals.get(rule_id, (0, 0))
        self._totals[rule_id] = (evaluated + numbers.evaluated, true + numbers.true)

    # -- the engine ---------------------------------------------------------------------------

    def _catch_up(self, now: float) -> None:
        """Handle what time brings before ``now``: deadlines, and ends of runs that are assumed."""
        while True:
            assert self._state is not None
            due = next_deadline(self._compiled, self._state)
            end = self._ends[0][0] if self._ends else None
            if end is not None and end <= now and (due is None or end <= due):
                when, run, rule_id = heappop(self._ends)
                self._feed(RunEnded(rule_id, run), when)
            elif due is not None and due <= now:
                # One at a time: what fires may end, as is assumed, before the next is due.
                self._feed(Tick(), due)
            else:
                return

    def _feed(self, event: Input, now: float) -> None:
        assert self._state is not None
        self._state, outputs = step(self._compiled, self._state, event, now)
        for output in outputs:
            if isinstance(output, Firing):
                self._fire(output)
            else:
                self._notes.noted(output)
        self._notes.passed(self._state, now)

    def _fire(self, firing: Firing) -> None:
        twin = self._recorded.match(self._epoch, firing.rule_id, firing.at)
        leaves = tuple(map(leaf_reading, firing.leaves))
        assumed = firing.rule_id in self._assumed
        verdict = "new" if twin is None else "same"
        text = ", ".join(leaf.text for leaf in firing.leaves if leaf.verdict) if not twin else ""
        self._add(firing.at, firing.rule_id, verdict, leaves, text, assumed)
        if firing.shadow:
            return
        if twin is not None and self._recorded.did(self._epoch, twin, firing.actions):
            self._runs[twin.run_id] = firing.run_id
            return
        seconds = self._recorded.length(firing.rule_id, firing.actions)
        heappush(self._ends, (firing.at + seconds, firing.run_id, firing.rule_id))
        self._assumed.add(firing.rule_id)

    def _add(
        self,
        at: float,
        rule_id: str,
        verdict: str,
        leaves: tuple[LeafReading, ...],
        text: str,
        assumed: bool,
    ) -> None:
        assumed = assumed or (verdict != "same" and at < self._unsure.get(rule_id, at))
        time = at + self._offset
        self._found.append(_Found(time, len(self._found), rule_id, verdict, leaves, text, assumed))

    def _compare(self, recorded: Fired) -> None:
        """Keep the reason why a recorded firing does not happen, while it can be told."""
        known = recorded.rule_id in self._compiled.by_id
        if known and self._state is not None and not self._recorded.matched(self._epoch, recorded):
            self._reasons[recorded.rule_id, recorded.run_id] = why_not(
                self._compiled, self._state, recorded.rule_id, recorded.now
            )

    def _why_gone(self, gone: Fired) -> str:
        if gone.rule_id not in self._compiled.by_id:
            return "the table has no such rule"
        return self._reasons.get((gone.rule_id, gone.run_id), "")

    # -- the report ---------------------------------------------------------------------------

    def report(self, limit: int, seconds: float) -> BacktestReport:
        """Return what was found."""
        start = self._first or 0.0
        found = sorted(self._found)
        tally = {"same": 0, "new": 0, "gone": 0}
        proposed: dict[str, int] = {}
        before: dict[str, int] = {}
        for each in found:
            tally[each.verdict] += 1
            if each.verdict != "gone":
                proposed[each.rule_id] = proposed.get(each.rule_id, 0) + 1
            if each.verdict != "new":
                before[each.rule_id] = before.get(each.rule_id, 0) + 1
        ids = [rule.id for rule in self._table.rules]
        ids += [rule_id for rule_id in before if rule_id not in self._compiled.by_id]
        return BacktestReport(
            start=start,
            end=self._last if self._first is not None else 0.0,
            messages=self._messages,
            seconds=seconds,
            firings=tuple(_listed(each, start) for each in found[:limit]),
            tallies=tuple(
                self._tally(rule_id, before.get(rule_id, 0), proposed.get(rule_id, 0))
                for rule_id in ids
            ),
            same=tally["same"],
            new=tally["new"],
            gone=tally["gone"],
            missing_topics=self._notes.missing(),
            warm_up=self._warm_up,
            truncated=len(found) > limit,
        )

    def _tally(self, rule_id: str, recorded: int, proposed: int) -> RuleTally:
        evaluated, true = self._totals.get(rule_id, (0, 0))
        text = "" if proposed else self._notes.why_never(rule_id, evaluated, true)
        return RuleTally(
            rule_id=rule_id,
            recorded=recorded,
            proposed=proposed,
            evaluated=evaluated,
            true=true,
            unknown_time=self._notes.unknown_time(rule_id),
            text=text,
        )


def _listed(found: _Found, start: float) -> BacktestFiring:
    return BacktestFiring(
        rule_id=found.rule_id,
        time=found.time,
        at=found.time - start,
        verdict=found.verdict,  # type: ignore[arg-type]
        leaves=found.leaves,
        text=found.text,
        assumed=found.assumed,
    )


def _memory(compiled: CompiledTable, plan: RulePlan) -> float:
    """Return for how many seconds messages and firings before a recording may matter to a rule."""
    event = plan.rule.event
    longest = max(event.hold, event.cooldown, event.max_rate.window if event.max_rate else 0.0)
    for _, index in (*plan.leaves, *plan.clear_leaves):
        condition = compiled.leaves[index].condition
        if isinstance(condition, Absent):
            longest = max(longest, condition.seconds)
        elif isinstance(condition, Rate):
            longest = max(longest, condition.window)
        else:
            longest = max(longest, timeout_of(condition) or 0.0)
    return longest
