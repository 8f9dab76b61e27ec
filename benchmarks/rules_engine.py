"""Cost of the rule engine alone, on one core, with no ROS.

Three figures, each from the best of several repetitions (the machine has other work to do), each
beside the floor: the same loop with a function that only reads the field and compares it.

Run: python benchmarks/rules_engine.py
"""

import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.firing import Sample
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.actions import Log
from kompass.rules.schema.conditions import AllOf, Changed, Compare, Condition, Operator
from kompass.rules.schema.events import Event
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Table

REPETITIONS = 7
SAMPLES = 20_000


def signal(topic: str, field: str = "data") -> Signal:
    return Signal(topic=topic, type="std_msgs/msg/Float64", path=(field,))


def rule(name: str, condition: Condition, trigger: str = "level") -> Rule:
    event = Event.model_validate({"condition": condition, "trigger": trigger, "once": True})
    return Rule(id=name, event=event, actions=(Log(text="fired"),))


def compare(topic: str, operator: Operator, value: float, field: str = "data") -> Compare:
    return Compare(signal=signal(topic, field), operator=operator, value=value)


def seconds_per_sample(rules: list[Rule], samples: list[Sample]) -> float:
    """Time of one step: the least over the repetitions of its mean."""
    table = compile_table(Table(rules=tuple(rules)))
    best = float("inf")
    for _ in range(REPETITIONS):
        state = initial_state(table, 0.0)
        now = 0.0
        begin = time.perf_counter()
        for sample in samples:
            now += 0.001
            step(table, state, sample, now)
        best = min(best, (time.perf_counter() - begin) / len(samples))
    return best


def floor(samples: list[Sample], judge: Callable[[Any], bool]) -> float:
    best = float("inf")
    for _ in range(REPETITIONS):
        begin = time.perf_counter()
        for sample in samples:
            judge(sample.message)
        best = min(best, (time.perf_counter() - begin) / len(samples))
    return best


def fifty_rules() -> float:
    """50 rules over 25 topics; every value differs from the one before, and some rules are true."""
    rules = []
    for i in range(25):
        rules.append(rule(f"low-{i}", compare(f"t{i}", "<", 0.1), "edge"))
        rules.append(rule(f"high-{i}", compare(f"t{i}", ">", 0.9)))
    samples = [
        Sample(f"/t{n % 25}", SimpleNamespace(data=(n * 0.618034) % 1.0)) for n in range(SAMPLES)
    ]
    return seconds_per_sample(rules, samples)


def crowd(make: Callable[[int], Condition], trigger: str = "level") -> tuple[float, float]:
    """Seconds per sample with 1 rule and with 1,000 on one topic, of which 1 can match."""
    samples = [
        Sample("/t", SimpleNamespace(data=float(n % 7), mode=n % 5, wide=n * 2711.0 % 10_000))
        for n in range(SAMPLES)
    ]
    one = seconds_per_sample([rule("r0", make(0), trigger)], samples)
    many = [rule(f"r{i}", make(i), trigger) for i in range(1000)]
    return one, seconds_per_sample(many, samples)


CROWDS: dict[str, tuple[Callable[[int], Condition], str]] = {
    "threshold, level": (lambda i: compare("t", ">", 3.5 if i == 0 else 100.0 + i), "level"),
    "threshold, edge": (lambda i: compare("t", ">", 3.5 if i == 0 else 100.0 + i), "edge"),
    "equality": (lambda i: compare("t", "==", 3.0 + 10 * i), "level"),
    "inequality with a bound": (
        lambda i: AllOf(
            conditions=(
                compare("t", ">", 3.5 if i == 0 else 100.0 + i),
                compare("t", "!=", 1000.0 + i, "mode"),
            )
        ),
        "level",
    ),
    "bands, value all over them": (
        lambda i: Compare(
            signal=signal("t", "wide"), operator="between", value=(10.0 * i, 10.0 * i + 0.5)
        ),
        "level",
    ),
    "changed to a value": (
        lambda i: AllOf(conditions=(Changed(signal=signal("t")), compare("t", "==", 3.0 + 10 * i))),
        "level",
    ),
}


def main() -> None:
    message_floor = floor(
        [Sample("/t", SimpleNamespace(data=float(n))) for n in range(SAMPLES)],
        lambda message: bool(message.data > 3.5),
    )
    print(f"floor: read a field and compare it      {message_floor * 1e6:8.2f} us/sample")
    fifty = fifty_rules()
    print(
        f"50 rules over 25 topics                 {fifty * 1e6:8.2f} us/sample "
        f"{1 / fifty:10,.0f} samples/s (aim: 100,000)"
    )
    for name, (make, trigger) in CROWDS.items():
        one, thousand = crowd(make, trigger)
        print(
            f"1,000 rules on one topic: {name:27s}{thousand * 1e6:8.2f} us/sample "
            f"{1 / thousand:10,.0f} samples/s (aim: 5,000), {thousand / one:5.2f} x one rule "
            f"({one * 1e6:.2f} us; aim: 3)"
        )


if __name__ == "__main__":
    main()
