"""What holds for every table and every stream."""

from typing import Any

from hypothesis import strategies as st

from kompass.rules.engine.compiled_table import CompiledTable, compile_table
from kompass.rules.engine.firing import Firing, Input, Output, RunEnded, Sample, Tick
from kompass.rules.engine.migration import migrate_state
from kompass.rules.engine.schedule import next_deadline
from kompass.rules.engine.state import EngineState, counters
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.conditions import AllOf, AnyOf, Condition, Not
from kompass.rules.schema.table import Table, rule_hash, table_hash
from tests.rules.oracle import Fired, Oracle
from tests.rules.strategies import GRID, streams, tables
from tests.support.properties import property_test


class Run:
    """A stream fed to the engine, with what came out of it."""

    def __init__(self, table: Table) -> None:
        self.table: CompiledTable = compile_table(table)
        self.state: EngineState = initial_state(self.table, 0.0)
        self.now = 0.0
        self.running: list[tuple[str, int]] = []
        self.out: list[Output] = []
        self.ends: dict[int, float] = {}

    def input(self, happening: Any) -> Input:
        """Make the engine's input; the end of a run picks one of those in progress."""
        if happening == "tick":
            return Tick()
        first, second = happening
        if isinstance(first, str):
            return Sample(first, second)
        if not self.running:
            return RunEnded("r0", 999)
        rule_id, run_id = self.running[first % len(self.running)]
        return RunEnded(rule_id, run_id, second, "" if second else "failed")

    def feed(self, event: Input, now: float) -> list[Output]:
        self.now = now
        self.state, out = step(self.table, self.state, event, now)
        for o in out:
            if isinstance(o, Firing):
                for run in o.cancels:
                    self.running.remove((o.rule_id, run))
                self.running.append((o.rule_id, o.run_id))
        # What was due before this end may have cancelled the run already: then it is no end.
        if isinstance(event, RunEnded) and (event.rule_id, event.run_id) in self.running:
            self.running.remove((event.rule_id, event.run_id))
            self.ends[event.run_id] = now
        self.out.extend(out)
        return out


def play(table: Table, stream: list[Any]) -> Run:
    run = Run(table)
    for gap, happening in stream:
        run.feed(run.input(happening), run.now + gap * GRID)
    return run


def fired(out: list[Output]) -> list[Fired]:
    return [
        Fired(
            o.rule_id,
            o.run_id,
            o.at,
            o.triggered_at,
            o.topic,
            o.message,
            tuple(leaf.verdict for leaf in o.leaves),
            o.cancels,
        )
        if isinstance(o, Firing)
        else Fired(o.rule_id, 0, o.at, o.at, None, None, (), (), latched=True)
        for o in out
        if isinstance(o, Firing) or o.kind == "rate_latched"
    ]


@property_test(tables(), streams)
def test_the_indexed_engine_does_what_the_plain_one_does(table: Table, stream: list[Any]) -> None:
    run, oracle = Run(table), Oracle(table, 0.0)
    for gap, happening in stream:
        now = run.now + gap * GRID
        event = run.input(happening)
        assert fired(run.feed(event, now)) == oracle.step(event, now)
    for rule in table.rules:
        ours, theirs = counters(run.table, run.state, rule.id), oracle.memory[rule.id]
        assert (ours.evaluated, ours.true) == (theirs.evaluated, theirs.true)
        assert (ours.fired, ours.dropped) == (theirs.fired, theirs.dropped)
        assert (ours.failed, ours.waiting) == (theirs.failed, len(theirs.queue))


def kleene(condition: Condition, verdicts: list[bool | None]) -> bool | None:
    """The verdict of a tree from those of its leaves, taken from the left of the list."""
    if isinstance(condition, Not):
        inner = kleene(condition.condition, verdicts)
        return None if inner is None else not inner
    if isinstance(condition, (AllOf, AnyOf)):
        parts = [kleene(c, verdicts) for c in condition.conditions]
        numbers = [0.5 if p is None else float(p) for p in parts]
        value = min(numbers) if isinstance(condition, AllOf) else max(numbers)
        return None if value == 0.5 else bool(value)
    return verdicts.pop(0)


@property_test(tables(), streams)
def test_no_rule_fires_on_unknown(table: Table, stream: list[Any]) -> None:
    run = play(table, stream)
    for firing in run.out:
        if isinstance(firing, Firing):
            rule = run.table.by_id[firing.rule_id].rule
            verdicts = [leaf.verdict for leaf in firing.leaves]
            assert kleene(rule.event.condition, verdicts) is True


@property_test(tables(), streams)
def test_no_rule_fires_within_its_cooldown_or_more_than_once_if_once(
    table: Table, stream: list[Any]
) -> None:
    run = play(table, stream)
    for rule in table.rules:
        firings = [o for o in run.out if isinstance(o, Firing) and o.rule_id == rule.id]
        if rule.event.once:
            assert len(firings) <= 1
        for firing in firings:
            earlier = [run.ends[f.run_id] for f in firings if f.run_id in run.ends]
            assert not [e for e in earlier if e < firing.at < e + rule.event.cooldown]
        limit = rule.event.max_rate
        if limit:
            times = [f.at for f in firings]
            assert all(sum(t <= u < t + limit.window for u in times) <= limit.count for t in times)


@property_test(tables(), streams)
def test_the_same_input_gives_the_same_firings(table: Table, stream: list[Any]) -> None:
    assert play(table, stream).out == play(table, stream).out


@property_test(tables(), streams, st.data())
def test_a_copy_of_the_state_goes_its_own_way(
    table: Table, stream: list[Any], data: st.DataObject
) -> None:
    cut = data.draw(st.integers(0, len(stream)))
    run = play(table, stream[:cut])
    twin = run.state.copy()
    first, now = [], run.now
    events = [(gap, run.input(happening)) for gap, happening in stream[cut:]]
    for state in (run.state, twin):
        out: list[Output] = []
        at = now
        for gap, event in events:
            at += gap * GRID
            out += step(run.table, state, event, at)[1]
        first.append(out)
    assert first[0] == first[1]


@property_test(tables(), streams)
def test_ticks_only_wake(table: Table, stream: list[Any]) -> None:
    """Ticks at every deadline, or none at all, make no difference to what fires and when."""
    plain, woken = Run(table), Run(table)
    for gap, happening in stream:
        now = plain.now + gap * GRID
        event = plain.input(happening)
        while (due := next_deadline(woken.table, woken.state)) is not None and due <= now:
            woken.feed(Tick(), due)
        if happening != "tick":
            plain.feed(event, now)
            woken.feed(event, now)
        else:
            plain.now = woken.now = now
    end = plain.now + 10.0
    plain.feed(Tick(), end)
    woken.feed(Tick(), end)
    assert plain.out == woken.out


@property_test(tables(), streams)
def test_nothing_happens_before_the_next_deadline(table: Table, stream: list[Any]) -> None:
    run = Run(table)
    for gap, happening in stream:
        run.feed(run.input(happening), run.now + gap * GRID)
        due = next_deadline(run.table, run.state)
        probe = run.state.copy()
        until = run.now + 100.0 if due is None else (run.now + due) / 2
        if due is None or due > run.now:
            assert step(run.table, probe, Tick(), until)[1] == []


@property_test(tables(), streams, st.sets(st.integers(0, 24)))
def test_an_unchanged_table_is_carried_without_a_trace(
    table: Table, stream: list[Any], cuts: set[int]
) -> None:
    plain, swapped = Run(table), Run(table)
    for index, (gap, happening) in enumerate(stream):
        now = plain.now + gap * GRID
        event = plain.input(happening)
        plain.feed(event, now)
        if index in cuts:
            again = compile_table(table)
            swapped.state, result = migrate_state(swapped.table, swapped.state, again, swapped.now)
            swapped.table = again
            assert set(result.carried) == {rule.id for rule in table.rules}
        swapped.feed(event, now)
        assert plain.out == swapped.out
    for rule in table.rules:
        assert counters(plain.table, plain.state, rule.id) == counters(
            swapped.table, swapped.state, rule.id
        )


@property_test(tables(), tables(), streams, st.integers(0, 25))
def test_what_is_carried_is_undisturbed_by_what_is_added(
    table: Table, other: Table, stream: list[Any], cut: int
) -> None:
    """Rules that stay fire as if nothing had been added before, between and behind them."""
    strangers = [r.model_copy(update={"id": f"new-{r.id}"}) for r in other.rules]
    mixed = Table(rules=(*strangers[:1], *reversed(table.rules), *strangers[1:]))
    plain, swapped = Run(table), Run(table)
    for index, (gap, happening) in enumerate(stream):
        now = plain.now + gap * GRID
        if index == cut:
            again = compile_table(mixed)
            swapped.state, _ = migrate_state(swapped.table, swapped.state, again, swapped.now)
            swapped.table = again
        event = plain.input(happening)
        plain.feed(event, now)
        if isinstance(event, RunEnded):
            event = same_run(plain, swapped, event)
        swapped.feed(event, now)
    for rule in table.rules:
        ours = [f for f in swapped.out if f.rule_id == rule.id]
        theirs = [f for f in plain.out if f.rule_id == rule.id]
        assert [anonymous(f) for f in ours] == [anonymous(f) for f in theirs]


def same_run(plain: Run, swapped: Run, event: RunEnded) -> RunEnded:
    """The run of the other engine that is the same firing; run ids are shared by all rules."""
    mine = [f.run_id for f in plain.out if isinstance(f, Firing) and f.rule_id == event.rule_id]
    others = [f.run_id for f in swapped.out if isinstance(f, Firing) and f.rule_id == event.rule_id]
    if event.run_id not in mine:
        return event
    return event._replace(run_id=others[mine.index(event.run_id)])


def anonymous(output: Output) -> Any:
    if not isinstance(output, Firing):
        return output
    return output._replace(run_id=0, cancels=(len(output.cancels),))


@property_test(tables())
def test_everything_survives_a_round_trip_through_json(table: Table) -> None:
    again = Table.model_validate_json(table.model_dump_json())
    assert again == table
    assert table_hash(again) == table_hash(table)
    assert [rule_hash(r) for r in again.rules] == [rule_hash(r) for r in table.rules]
