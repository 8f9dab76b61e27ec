"""Short ways to write rules, messages and a virtual clock in tests."""

from types import SimpleNamespace
from typing import Any

from kompass.rules.engine.compiled_table import CompiledTable, compile_table
from kompass.rules.engine.explain import Explanation, explain
from kompass.rules.engine.firing import Firing, Input, Note, RunEnded, Sample, Tick
from kompass.rules.engine.migration import MigrationReport, migrate_state
from kompass.rules.engine.schedule import next_deadline
from kompass.rules.engine.state import Counters, counters
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.actions import Log
from kompass.rules.schema.conditions import (
    Absent,
    AllOf,
    AnyOf,
    Changed,
    Compare,
    Condition,
    Not,
    Operator,
    Rate,
    Received,
)
from kompass.rules.schema.signals import Aggregate, Signal
from kompass.rules.schema.table import Rule, Table

FLOAT = "std_msgs/msg/Float64"


def signal(
    topic: str,
    *path: str | int,
    aggregate: Aggregate | None = None,
    timeout: float | None = 1.0,
) -> Signal:
    return Signal(topic=topic, type=FLOAT, path=path, aggregate=aggregate, timeout=timeout)


def compare(
    topic: str,
    operator: Operator,
    value: Any,
    *,
    timeout: float | None = 1.0,
    tolerance: float = 0.0,
) -> Compare:
    """Compare the field ``x`` of a topic."""
    return Compare(
        signal=signal(topic, "x", timeout=timeout),
        operator=operator,
        value=value,
        tolerance=tolerance,
    )


def received(topic: str) -> Received:
    return Received(signal=signal(topic))


def changed(topic: str, deadband: float = 0.0) -> Changed:
    return Changed(signal=signal(topic, "x"), deadband=deadband)


def absent(topic: str, seconds: float, *path: str | int, from_start: bool = True) -> Absent:
    return Absent(signal=signal(topic, *path), seconds=seconds, from_start=from_start)


def slower(topic: str, hz: float, window: float = 1.0) -> Rate:
    return Rate(topic=topic, below=hz, window=window)


def faster(topic: str, hz: float, window: float = 1.0) -> Rate:
    return Rate(topic=topic, above=hz, window=window)


def both(*conditions: Condition) -> AllOf:
    return AllOf(conditions=conditions)


def either(*conditions: Condition) -> AnyOf:
    return AnyOf(conditions=conditions)


def opposite(condition: Condition) -> Not:
    return Not(condition=condition)


def rule(condition: Condition, rule_id: str = "r", **fields: Any) -> Rule:
    """Make a rule; fields of the rule itself by their name, all others go to its event."""
    own = {k: fields.pop(k) for k in list(fields) if k in Rule.model_fields}
    event = {"condition": condition, **fields}
    return Rule.model_validate({"id": rule_id, "event": event, "actions": (Log(text="!"),), **own})


class Robot:
    """A table under a virtual clock; its actions finish at once unless told otherwise."""

    def __init__(self, *rules: Rule, finish: bool = True) -> None:
        self.table: CompiledTable = compile_table(Table(rules=rules))
        self.now = 0.0
        self.state = initial_state(self.table, self.now)
        self.finish = finish
        self.firings: list[Firing] = []
        self.notes: list[Note] = []

    def feed(self, event: Input, at: float | None = None) -> list[str]:
        """Feed an input, at a time or now; return the ids of the rules that fired."""
        self.now = self.now if at is None else at
        self.state, out = step(self.table, self.state, event, self.now)
        fired = [o for o in out if isinstance(o, Firing)]
        self.firings.extend(fired)
        self.notes.extend(o for o in out if isinstance(o, Note))
        ids = [f.rule_id for f in fired]
        for firing in fired if self.finish else ():
            ids += self.feed(RunEnded(firing.rule_id, firing.run_id))
        return ids

    def say(self, topic: str, x: Any = None, at: float | None = None, **fields: Any) -> list[str]:
        """Feed a message with the field ``x`` and others."""
        return self.feed(Sample(topic, SimpleNamespace(x=x, **fields)), at)

    def wait(self, until: float) -> list[str]:
        return self.feed(Tick(), until)

    def done(self, firing: Firing, at: float | None = None, *, ok: bool = True) -> list[str]:
        return self.feed(RunEnded(firing.rule_id, firing.run_id, ok, "" if ok else "broken"), at)

    def deadline(self) -> float | None:
        return next_deadline(self.table, self.state)

    def counters(self, rule_id: str = "r") -> Counters:
        return counters(self.table, self.state, rule_id)

    def explain(self, rule_id: str = "r", at: float | None = None) -> Explanation:
        return explain(self.table, self.state, rule_id, self.now if at is None else at)

    def swap(
        self, *rules: Rule, at: float | None = None, reset: tuple[str, ...] = ()
    ) -> MigrationReport:
        """Go on with another table."""
        self.now = self.now if at is None else at
        table = compile_table(Table(rules=rules))
        self.state, result = migrate_state(self.table, self.state, table, self.now, reset)
        self.table = table
        return result
