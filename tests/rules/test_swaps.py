"""However often the table is changed under a stream, nothing is lost, doubled or late."""

import os
import random
from types import SimpleNamespace
from typing import Any

from hypothesis import strategies as st

from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.firing import Firing, Output, RunEnded, Sample, Tick
from kompass.rules.engine.migration import plan_migration, swap
from kompass.rules.engine.state import EngineState, counters
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.table import Rule, Table
from tests.rules.building import Robot, absent, both, compare, received, rule
from tests.rules.strategies import GRID, streams, tables
from tests.rules.test_engine_properties import Run, anonymous, same_run
from tests.support.properties import MANY, property_test

# A few of the many; KOMPASS_RULES_SWAPS=500 for many.
SWAPS = int(os.environ.get("KOMPASS_RULES_SWAPS", "60"))


def cross(run: Run, table: Table, now: float, reset: tuple[str, ...] = ()) -> list[Output]:
    again = compile_table(table)
    run.state, _, out = swap(plan_migration(run.table, again, reset), run.state, now)
    run.table = again
    run.out.extend(out)
    return out


@property_test(
    tables(),
    st.lists(tables(max_rules=2), min_size=1, max_size=4),
    streams,
    st.lists(st.tuples(st.integers(0, 25), st.integers(0, 3), st.booleans()), max_size=10),
    many=MANY // 2,
)
def test_rules_that_stay_never_notice_the_others_come_and_go(
    table: Table, others: list[Table], stream: list[Any], swaps: list[tuple[int, int, bool]]
) -> None:
    """Holds, cooldowns, edges and counters of unchanged rules are exact through any swaps."""
    plain, swapped = Run(table), Run(table)
    for index, (gap, happening) in enumerate(stream):
        now = plain.now + gap * GRID
        for _, which, behind in (s for s in swaps if s[0] == index):
            strangers = tuple(
                r.model_copy(update={"id": f"other-{r.id}"})
                for r in others[which % len(others)].rules
            )
            parts = (table.rules, strangers) if behind else (strangers, table.rules)
            # At the moment of the message: what is due by then is the old table's.
            for output in cross(swapped, Table(rules=parts[0] + parts[1]), now):
                if isinstance(output, Firing):
                    for run in output.cancels:
                        swapped.running.remove((output.rule_id, run))
                    swapped.running.append((output.rule_id, output.run_id))
            plain.feed(Tick(), now)
        event = plain.input(happening)
        plain.feed(event, now)
        if isinstance(event, RunEnded):
            event = same_run(plain, swapped, event)
        swapped.feed(event, now)
    for each in table.rules:
        ours = [anonymous(o) for o in swapped.out if o.rule_id == each.id]
        assert ours == [anonymous(o) for o in plain.out if o.rule_id == each.id]
        kept = counters(swapped.table, swapped.state, each.id)
        assert kept == counters(plain.table, plain.state, each.id)


@property_test(tables(), tables(), streams, st.integers(0, 25), many=MANY // 2)
def test_a_swap_there_and_back_resets_what_was_away_and_nothing_else(
    table: Table, other: Table, stream: list[Any], cut: int
) -> None:
    run = Run(table)
    for index, (gap, happening) in enumerate(stream):
        now = run.now + gap * GRID
        if index == cut:
            cross(run, other, now)
            cross(run, table, now)
            ours = {(r.id, r.model_dump_json()) for r in table.rules}
            away = {r[0] for r in ours} - {
                r.id for r in other.rules if (r.id, r.model_dump_json()) in ours
            }
            for rule_id in away:
                assert counters(run.table, run.state, rule_id).fired == 0
        run.feed(run.input(happening), now)


class Walk:
    """A random walk of tables over a steady stream, each message with a number of its own."""

    def __init__(self, seed: int) -> None:
        self.chance = random.Random(seed)
        self.extra: dict[str, Rule] = {}
        self.table = compile_table(self.next_table())
        self.state: EngineState = initial_state(self.table, 0.0)
        self.out: list[Firing] = []

    def next_table(self) -> Table:
        """Three rules for ever, and others that come, change and go around them."""
        number = self.chance.randrange(1_000)
        name = f"extra-{number % 7}"
        if name in self.extra and self.chance.random() < 0.5:
            del self.extra[name]
        else:
            self.extra[name] = rule(both(received("n"), compare("x", "<", number)), name)
        witness = rule(received("n"), "witness", mode={"kind": "parallel", "size": 1000})
        held = rule(compare("x", "<", 1, timeout=None), "held", trigger="edge", hold=0.3)
        own = list(self.extra.values())
        self.chance.shuffle(own)
        place = self.chance.randrange(len(own) + 1)
        silent = rule(absent("n", 0.05), "silent")
        return Table(rules=(*own[:place], held, witness, silent, *own[place:]))

    def feed(self, event: Any, now: float) -> None:
        self.state, out = step(self.table, self.state, event, now)
        self.take(out, now)

    def take(self, out: list[Output], now: float) -> None:
        for output in out:
            if isinstance(output, Firing):
                self.out.append(output)
                self.feed(RunEnded(output.rule_id, output.run_id), now)

    def swap(self, now: float) -> None:
        new = compile_table(self.next_table())
        self.state, _, out = swap(plan_migration(self.table, new), self.state, now)
        self.table = new
        self.take(out, now)


def test_over_many_random_swaps_every_message_is_evaluated_by_exactly_one_table() -> None:
    robot, message = Walk(seed=4), 0
    for _ in range(SWAPS):
        for _ in range(robot.chance.randrange(6)):
            now = message * GRID
            robot.feed(Sample("x", SimpleNamespace(x=5 if message % 10 == 0 else 0)), now)
            robot.feed(Sample("n", SimpleNamespace(number=message)), now)
            message += 1
        robot.swap((message - robot.chance.choice((1, 0.5, 0.25))) * GRID if message else 0.0)
    heard = [f.message.number for f in robot.out if f.rule_id == "witness"]
    assert heard == list(range(message))
    assert counters(robot.table, robot.state, "witness").evaluated == message
    # Between two messages, 0.3 s after every tenth and one; and in each pause between two.
    held = [f.at for f in robot.out if f.rule_id == "held"]
    assert held == [n * GRID + 0.3 for n in range(1, message - 3, 10)]
    silent = [f.at for f in robot.out if f.rule_id == "silent"]
    assert silent == [n * GRID + 0.05 for n in range(len(silent))]
    assert len(silent) >= message - 2


def test_the_same_swaps_give_the_same_firings() -> None:
    found = []
    for _ in range(2):
        robot = Walk(seed=9)
        for number in range(40):
            robot.feed(Sample("n", number), number * GRID)
            robot.feed(Sample("x", number), number * GRID)
            robot.swap(number * GRID)
        found.append([(f.rule_id, f.run_id, f.at) for f in robot.out])
    assert found[0] == found[1]


def test_silence_is_counted_from_the_last_message_though_nobody_asked_for_it_then() -> None:
    """The field is looked at from the start, its silence only after two more swaps."""
    value = rule(compare("a", "<", 1, timeout=None), "value")
    robot = Robot(value)
    robot.say("a", 5, at=0.0)
    robot.swap(value, rule(received("b"), "other"), at=1.0)
    robot.say("a", 5, at=8.0)
    silent = rule(absent("a", 5.0, "x"), "silent")
    robot.swap(value, silent, at=9.0)
    assert robot.wait(12.9) == []
    assert robot.wait(13.0) == ["silent"]


def test_a_rule_that_begins_true_is_looked_at_though_the_table_changes_again_at_once() -> None:
    first = rule(received("a"), "first")
    silent = rule(absent("a", 1.0), "silent")
    robot = Robot(first)
    robot.say("a", at=0.0)
    robot.swap(first, rule(absent("a", 0.5), "begins"), at=3.0)
    robot.swap(first, rule(absent("a", 0.5), "begins"), silent, at=3.0)
    assert robot.wait(3.0) == ["begins", "silent"]
