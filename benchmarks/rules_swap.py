"""The pause that a change of the rule table makes in the stream of messages, with no ROS.

The new table is compiled beforehand, beside the running engine; only `swap` lies between two
messages. Tables have topics, fields, holds, cooldowns and silences as real ones do; each swap
changes one rule, and every tenth adds or removes one.

Run: python benchmarks/rules_swap.py [swaps]
"""

import gc
import random
import sys
import time
from types import SimpleNamespace
from typing import NamedTuple

from benchmarks.common import percentile
from kompass.rules.engine.compiled_table import CompiledTable, compile_table
from kompass.rules.engine.firing import Firing, RunEnded, Sample
from kompass.rules.engine.migration import plan_migration, swap
from kompass.rules.engine.state import EngineState
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.actions import Log
from kompass.rules.schema.conditions import Absent, AllOf, Compare, Condition, Rate
from kompass.rules.schema.events import Event
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Table

SIZES = (10, 100, 1000)
AIM = 1e-3  # s
STREAM = 200  # messages between two swaps
FLOAT = "std_msgs/msg/Float64"


def rule(index: int, bound: float) -> Rule:
    topic = f"topic_{index % 25}"
    value = Compare(
        signal=Signal(topic=topic, type=FLOAT, path=("data",)), operator="<", value=bound
    )
    condition: Condition = value
    if index % 5 == 1:
        condition = Absent(signal=Signal(topic=topic, type=FLOAT), seconds=1.0 + index % 3)
    elif index % 5 == 2:
        condition = AllOf(conditions=(value, Rate(topic=topic, above=2.0)))
    elif index % 5 == 3:
        other = Signal(topic=f"topic_{(index + 1) % 25}", type=FLOAT, path=("mode",), timeout=5.0)
        condition = AllOf(conditions=(value, Compare(signal=other, operator="==", value=1)))
    event = Event(
        condition=condition,
        trigger="edge" if index % 2 else "level",
        hold=0.2 if index % 3 == 0 else 0.0,
        cooldown=1.0 + index % 7,
    )
    return Rule(id=f"rule-{index}", event=event, actions=(Log(text="!"),))


def change(rules: dict[int, Rule], number: int, chance: random.Random) -> Table:
    index = chance.choice(list(rules))
    rules[index] = rule(index, chance.uniform(0.0, 10.0))
    if number % 10 == 0:
        new = max(rules) + 1
        rules[new] = rule(new, chance.uniform(0.0, 10.0))
        del rules[chance.choice(list(rules))]
    return Table(rules=tuple(rules.values()))


def stream(
    table: CompiledTable, state: EngineState, now: float, chance: random.Random
) -> tuple[EngineState, float]:
    for _ in range(STREAM):
        now += 0.002
        message = SimpleNamespace(data=chance.uniform(0.0, 10.0), mode=chance.randrange(3))
        state, out = step(table, state, Sample(f"topic_{chance.randrange(25)}", message), now)
        for output in out:
            if isinstance(output, Firing):
                step(table, state, RunEnded(output.rule_id, output.run_id), now)
    return state, now


class Times(NamedTuple):
    """Of each swap; s."""

    pauses: list[float]
    busy: list[float]
    bridging: list[float]
    compiling: list[float]


def measure(size: int, swaps: int) -> Times:
    chance = random.Random(7)
    rules = {index: rule(index, chance.uniform(0.0, 10.0)) for index in range(size)}
    table = compile_table(Table(rules=tuple(rules.values())))
    state, now = initial_state(table, 0.0), 0.0
    pauses, busy, bridging, compiling = found = Times([], [], [], [])
    for number in range(swaps):
        state, now = stream(table, state, now, chance)
        begin = time.thread_time()
        new = compile_table(change(rules, number, chance))
        compiling.append(time.thread_time() - begin)
        begin = time.thread_time()
        way = plan_migration(table, new)
        bridging.append(time.thread_time() - begin)
        gc.disable()
        began = time.perf_counter(), time.thread_time()
        state, _, _ = swap(way, state, now)
        pauses.append(time.perf_counter() - began[0])
        busy.append(time.thread_time() - began[1])
        gc.enable()
        table = new
    return found


def main() -> None:
    swaps = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    for size in SIZES:
        times = measure(size, swaps)
        print(
            f"{size:5d} rules: pause p50 {percentile(times.pauses, 0.5) * 1e3:7.3f} ms, "
            f"p99 {percentile(times.pauses, 0.99) * 1e3:7.3f} ms (aim: {AIM * 1e3:g}); "
            f"of it at work p99 {percentile(times.busy, 0.99) * 1e3:7.3f} ms; beforehand "
            f"{percentile(times.compiling, 0.5) * 1e3:6.1f} ms to compile, "
            f"{percentile(times.bridging, 0.5) * 1e3:5.2f} ms to plan_migration"
        )


if __name__ == "__main__":
    main()
