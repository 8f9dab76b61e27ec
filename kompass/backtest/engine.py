"""What a table would have done, had it been applied at the start of a recorded stretch.

The same engine is fed with what it took then. Up to the start it goes on with the tables that were
in force; there the proposed one is applied, as the monitor applies one: what is unchanged goes on,
what is new or changed begins afresh with the values of that moment. It stays to the end of the
stretch, whatever else was applied meanwhile.

Where the table fires as the recorded one did, its runs end when the recorded runs ended. A run that
did not happen then is taken to last as long as that rule's runs usually did; what its actions would
have changed in the world nobody knows, and what fires after it is marked as assumed.
"""

from collections.abc import Callable, Iterable
from heapq import heappop, heappush
from itertools import chain
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
from kompass.backtest.past import Inherited, Past, remind
from kompass.backtest.recorded_runs import RecordedRuns
from kompass.backtest.report import BacktestFiring, BacktestReport, RuleTally
from kompass.rulebook.schema.status import LeafReading
from kompass.rulebook.views.views import leaf_reading, why_not
from kompass.rules.engine.compiled_table import CompiledTable, RulePlan, compile_table
from kompass.rules.engine.firing import Firing, Input, RunEnded, Sample, Tick
from kompass.rules.engine.migration import migrate_state
from kompass.rules.engine.schedule import next_deadline
from kompass.rules.engine.state import EngineState, counters
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
    before: Iterable[LoggedEvent] = (),
    total: int = 0,
    progress: Callable[[float], None] | None = None,
    clock: Callable[[], float] | None = None,
    limit: int = FIRINGS,
) -> BacktestReport:
    """Tell what a table would have done, had it been applied at the start of a stretch.

    Parameters
    ----------
    table
        The proposed table.
    events
        The event log of the stretch, in its order. Where it begins with ``Resumed``, the table is
        applied at that moment; where the engine itself begins (``Began``), it begins with the
        table. Without either (a recording that no monitor made) the engine begins with the first
        message, whose ``now`` then counts as seconds since the epoch.
    recorded
        The events of the same time other than ``Heard``, read beforehand: the
        firings to compare with, and how long runs took. Empty when there are none.
    before
        The event log of the same session up to the stretch, as far back as there is: what the
        engine knew when the table is applied is worked out of it. Without it, that is the newest
        values and what :class:`~kompass.backtest.event_log.Resumed` tells.
    total
        Number of events, those before the stretch included, for the progress.
    progress
        Called now and then with the share that is done, 0 to 1; may raise to cancel.
    clock
        Seconds of any clock, to tell how long the replay took.
    limit
        How many firings are listed at most.
    """
    begun = clock() if clock else 0.0
    replay = _Replay(table, RecordedRuns(recorded))
    steps = chain(
        ((replay.take_before, event) for event in before),
        ((replay.take, event) for event in events),
    )
    for number, (take, event) in enumerate(steps):
        take(event)
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
        self._past: Past | None = None  # until the table is applied
        self._resumed: Resumed | None = None  # where it is to be applied
        self._waiting: list[Heard] = []  # of that very moment, for the new table
        self._known: list[str] = []  # topics that had a value then
        self._applied = 0.0  # s of the engine's clock
        self._epoch = ""
        self._offset = 0.0
        self._is_known = False  # whether the past tells more than the newest values
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

    def take_before(self, event: LoggedEvent) -> None:
        """Take the next event of before the stretch."""
        if isinstance(event, Began | Resumed):
            if self._past is None or isinstance(event, Began) or event.epoch != self._past.epoch:
                self._past = Past(event)
        elif self._past is not None:
            self._past.take(event)

    def take(self, event: LoggedEvent) -> None:
        """Take the next event of the stretch."""
        if isinstance(event, (Began, Resumed)):
            self._begin(event)
            return
        if isinstance(event, Lost):
            return
        if self._resumed is not None:
            if isinstance(event, Heard) and event.now <= self._resumed.now:
                self._meanwhile(event)
                return
            self._apply()
        if isinstance(event, Fired):
            self._compare(event)
            if self._state is not None:
                # It may be the last event of the log, and time alone its cause.
                self._catch_up(event.now)
                self._reach(event.now)
            return
        if self._state is None:
            self._start_foreign(event.now)
        self._catch_up(event.now)
        if isinstance(event, Heard):
            self._hear(event)
        elif isinstance(event, Ended):
            run = self._runs.pop(event.run_id, None)
            if run is not None:
                self._feed(RunEnded(event.rule_id, run, event.ok, event.error), event.now)
        elif isinstance(event, Swapped):
            self._reset(event)
        self._reach(event.now)

    def _reach(self, now: float) -> None:
        # Kept in the engine's time too: on the way to the wall's and back it loses its last digits.
        self._reached = max(self._reached, now)
        self._last = self._reached + self._offset

    def _begin(self, event: Began | Resumed) -> None:
        if isinstance(event, Resumed) and self._is_same(event.epoch):
            return  # the next file of the same session
        self._close()
        if isinstance(event, Began):
            self._past = None
            state = initial_state(self._compiled, event.now, event.used)
            self._start(state, event.now, event.wall - event.now, event.epoch)
            return
        if self._past is None or self._past.epoch != event.epoch:
            self._past, self._is_known = Past(event), False
        else:
            self._is_known = True
        self._resumed = event

    def _is_same(self, epoch: str) -> bool:
        begun = self._state is not None and epoch == self._epoch
        return begun or (self._resumed is not None and epoch == self._resumed.epoch)

    def _meanwhile(self, event: Heard) -> None:
        """Take what was heard before the stretch, or at its very start."""
        if not event.again:
            self._waiting.append(event)
            return
        self._messages += 1
        self._known.append(event.topic.removeprefix("/"))
        if not self._is_known and self._past is not None:
            self._past.take(event)

    def _apply(self) -> None:
        """Put the table in force as the monitor would have done then."""
        assert self._resumed is not None
        assert self._past is not None
        event, self._resumed = self._resumed, None
        inherited, self._past = self._past.apply(self._compiled, event.now), None
        self._start(inherited.state, event.now, event.wall - event.now, event.epoch)
        self._applied = event.now
        self._runs = inherited.runs
        for untold in inherited.untold:
            twin = self._recorded.match(self._epoch, untold.rule_id, untold.at)
            if twin is not None:
                self._runs[twin.run_id] = untold.run_id
        # What carried rules have counted was before the stretch.
        for plan in self._compiled.rules:
            numbers = counters(self._compiled, inherited.state, plan.rule.id)
            evaluated, true = self._totals.get(plan.rule.id, (0, 0))
            self._totals[plan.rule.id] = (evaluated - numbers.evaluated, true - numbers.true)
        self._doubt(inherited)
        for topic in self._known:
            self._notes.heard(inherited.state, topic)
        self._known.clear()
        waiting, self._waiting = self._waiting, []
        for heard in waiting:
            self._catch_up(heard.now)
            self._hear(heard)

    def _start(self, state: EngineState, now: float, offset: float, epoch: str) -> None:
        self._state = state
        self._offset, self._epoch = offset, epoch
        self._applied = now
        self._unsure.clear()
        self._notes.begin(now)
        if self._first is None:
            self._first = now + offset
        self._reached = now
        self._last = now + offset

    def _doubt(self, inherited: Inherited) -> None:
        """Take note of rules for which something may matter that was before all that is known."""
        if inherited.since is None:
            return
        carried = frozenset(inherited.report.carried)
        for plan in self._compiled.rules:
            seconds = _memory(self._compiled, plan, carried=plan.rule.id in carried)
            left = inherited.since + seconds - self._applied
            if left > 0:
                self._unsure[plan.rule.id] = self._applied + left
                self._warm_up = max(self._warm_up, left)

    def _start_foreign(self, now: float) -> None:
        """Begin with a message of a recording that no monitor made."""
        self._start(initial_state(self._compiled, now), now, 0.0, "")
        for plan in self._compiled.rules:
            seconds = _memory(self._compiled, plan, carried=False)
            self._unsure[plan.rule.id] = now + seconds
            self._warm_up = max(self._warm_up, seconds)

    def _hear(self, event: Heard) -> None:
        self._messages += 1
        topic = event.topic.removeprefix("/")
        expected = self._types.get(topic)
        if event.type and expected and event.type not in expected:
            return  # the rules ask for another type: the monitor would not have heard it
        if event.again:
            assert self._state is not None
            remind(self._compiled, self._state, event)
            self._notes.passed(self._state, event.now)
        else:
            self._feed(Sample(event.topic, event.message), event.now)
        assert self._state is not None
        self._notes.heard(self._state, topic)

    def _reset(self, event: Swapped) -> None:
        """Have rules start afresh that a person let start afresh.

        What else was changed then makes no difference: the proposed table has been in force from
        the start.
        """
        assert self._state is not None
        self._feed(Tick(), event.now)
        hashes = {rule.id: rule_hash(rule) for rule in event.table.rules}
        afresh = tuple(
            rule_id
            for rule_id in event.reset
            if rule_id in self._compiled.by_id
            and hashes.get(rule_id) == self._compiled.by_id[rule_id].hash
        )
        if afresh:
            for rule_id in afresh:
                self._count(rule_id)
            self._state, _ = migrate_state(
                self._compiled, self._state, self._compiled, event.now, afresh
            )

    def end(self) -> None:
        """Take note that nothing follows."""
        self._close()

    def _close(self) -> None:
        """End a session of the engine."""
        if self._resumed is not None:
            self._apply()
        if self._state is None:
            return
        self._catch_up(self._reached)
        self._notes.end(self._state)
        for plan in self._compiled.rules:
            self._count(plan.rule.id)
        for rule_id, gone in self._recorded.unmatched(self._epoch):
            if gone.now < self._applied:
                continue  # of the table of before, and told late
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


def _memory(compiled: CompiledTable, plan: RulePlan, *, carried: bool) -> float:
    """Return for how many seconds messages and firings of before may matter to a rule.

    Its own hold, cooldown and firings do so only for a rule that is carried on.
    """
    event = plan.rule.event
    longest = 0.0
    if carried:
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
