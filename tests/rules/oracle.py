"""What the engine must do, written as plainly as possible and without regard to speed.

It keeps every message ever received, re-evaluates every rule at every moment at which anything
could change, and shares no code with the engine but the rules' data.
"""

import math
from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

from kompass.rules.engine.firing import Input, RunEnded, Sample
from kompass.rules.schema.conditions import (
    Absent,
    AllOf,
    AnyOf,
    CallableCondition,
    Changed,
    Compare,
    Condition,
    Leaf,
    Not,
    Rate,
    Received,
    leaves,
    topic_of,
)
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Table

NOTHING = object()
Verdict = bool | None


class Fired(NamedTuple):
    """What the tests compare of a firing; ``latched`` tells a note from one."""

    rule_id: str
    run_id: int
    at: float
    triggered_at: float
    topic: str | None
    message: Any
    leaves: tuple[Verdict, ...]
    cancels: tuple[int, ...]
    latched: bool = False


def read(signal: Signal, message: Any) -> Any:
    value = message
    for part in signal.path:
        try:
            value = value[part] if isinstance(part, int) else getattr(value, part)
        except (AttributeError, IndexError, TypeError):
            return NOTHING
    if value is None:
        return NOTHING
    if signal.aggregate is None:
        return NOTHING if isinstance(value, float) and math.isnan(value) else value
    if not isinstance(value, list):
        return NOTHING
    finite = [v for v in value if math.isfinite(v)]
    if signal.aggregate == "len":
        return len(value)
    if signal.aggregate == "any":
        return any(finite)
    if not finite:
        return NOTHING
    whole: dict[str, Callable[[list[Any]], Any]] = {"min": min, "max": max, "all": all}
    return whole[signal.aggregate](finite)


def sort(value: Any) -> str:
    if value is NOTHING:
        return "nothing"
    kinds: dict[type, str] = {bool: "bool", int: "number", float: "number", str: "text"}
    return kinds.get(type(value), "list" if isinstance(value, (list, tuple)) else "other")


def alike(a: Any, b: Any, tolerance: float = 0.0) -> bool:
    if sort(a) != sort(b) or sort(a) == "other":
        return False
    if sort(a) == "number":
        return bool(b - tolerance <= a <= b + tolerance)
    if sort(a) == "list":
        return len(a) == len(b) and all(alike(x, y, tolerance) for x, y in zip(a, b, strict=True))
    return bool(a == b)


def judge(leaf: Compare, value: Any) -> Verdict:
    operator, literal, kind = leaf.operator, leaf.value, sort(value)
    if value is NOTHING:
        return None
    if operator.startswith("not_") or operator == "!=":
        positive = "==" if operator == "!=" else operator.removeprefix("not_")
        verdict = judge(leaf.model_copy(update={"operator": positive}), value)
        return None if verdict is None else not verdict
    if operator == "==":
        if kind != sort(literal) or kind == "other":
            return None
        return alike(value, literal, leaf.tolerance)
    if operator in ("<", "<=", ">", ">="):
        if kind != sort(literal) or kind not in ("number", "text"):
            return None
        less, equal = bool(value < literal), bool(value == literal)
        return {"<": less, "<=": less or equal, ">": not less and not equal, ">=": not less}[
            operator
        ]
    if operator == "between":
        assert isinstance(literal, tuple)
        low, high = map(float, literal)
        return low <= float(value) <= high if kind == "number" else None
    if operator == "in":
        if isinstance(literal, str):
            return value in literal if kind == "text" else None
        assert isinstance(literal, tuple)
        if kind not in {sort(option) for option in literal}:
            return None
        return any(alike(value, option) for option in literal)
    wanted = literal if isinstance(literal, tuple) else (literal,)
    if kind == "text":
        if any(sort(w) != "text" for w in wanted):
            return None
        found = [w in value for w in wanted]
    elif kind == "list":
        found = [any(alike(item, w) for item in value) for w in wanted]
    else:
        return None
    return any(found) if operator == "contains_any" else all(found)


class Memory:
    """One rule's own."""

    def __init__(self, rule: Rule) -> None:
        self.verdict: Verdict = None
        self.since: float | None = None
        edge = rule.event.trigger == "edge"
        self.ready = not edge or rule.event.first_true_is_edge
        self.virgin = not self.ready
        self.cool_until = -math.inf
        self.runs: list[int] = []
        self.queue: deque[Fired] = deque()
        self.times: list[float] = []
        self.latched = False
        self.seen: tuple[Verdict, ...] = ()
        self.evaluated = self.true = self.fired = self.dropped = self.failed = 0
        self.hold_done = False


class Oracle:
    """The reference engine."""

    def __init__(self, table: Table, now: float) -> None:
        self.rules = table.rules
        self.start = self.now = now
        self.history: dict[str, list[tuple[float, Any]]] = {}
        self.memory = {rule.id: Memory(rule) for rule in table.rules}
        self.next_run = 1
        self.out: list[Fired] = []
        for rule in self.rules:
            self.memory[rule.id].seen = self.snapshot(rule, None)
            if rule.enabled:
                self.rest(rule, self.verdict(rule.event.condition, None))

    def step(self, event: Input, now: float) -> list[Fired]:
        self.out = []
        while (moment := self.next_moment()) <= now:
            self.now = moment
            self.time_passes()
        self.now = now
        if isinstance(event, Sample):
            self.sample(event.topic.removeprefix("/"), event.message)
        elif isinstance(event, RunEnded) and event.rule_id in self.memory:
            self.done(event)
        return self.out

    def next_moment(self) -> float:
        """The next moment at which time alone could change anything."""
        found: set[float] = set()
        for rule in self.rules:
            memory, event = self.memory[rule.id], rule.event
            if memory.since is not None:
                found.add(memory.since + event.hold)
            found.add(memory.cool_until)
            conditions = [event.condition] + ([event.clear] if event.clear else [])
            for _, leaf in (pair for c in conditions for pair in leaves(c)):
                found.update(self.changes(leaf))
        return min((t for t in found if t > self.now), default=math.inf)

    def changes(self, leaf: Leaf) -> list[float]:
        times = [t for t, _ in self.history.get(topic_of(leaf), [])]
        if isinstance(leaf, Absent):
            return [t + leaf.seconds for t in [self.start, *times]]
        if isinstance(leaf, Rate):
            return [t + leaf.window for t in times]
        timeout = leaf.timeout if isinstance(leaf, CallableCondition) else leaf.signal.timeout
        return [] if timeout is None else [math.nextafter(t + timeout, math.inf) for t in times]

    # -- verdicts

    def verdict(self, condition: Condition, current: str | None) -> Verdict:
        if isinstance(condition, Not):
            inner = self.verdict(condition.condition, current)
            return None if inner is None else not inner
        if isinstance(condition, (AllOf, AnyOf)):
            parts = [self.verdict(c, current) for c in condition.conditions]
            decisive = isinstance(condition, AnyOf)
            return decisive if decisive in parts else None if None in parts else not decisive
        return self.leaf(condition, current)

    def leaf(self, leaf: Leaf, current: str | None) -> Verdict:
        topic, now = topic_of(leaf), self.now
        history = self.history.get(topic, [])
        if isinstance(leaf, Rate):
            if not history or now < history[0][0] + leaf.window:
                return None
            rate = sum(now < t + leaf.window for t, _ in history) / leaf.window
            return rate < leaf.below if leaf.below is not None else rate > (leaf.above or 0)
        if isinstance(leaf, Absent):
            heard = [t for t, m in history if read(leaf.signal, m) is not NOTHING]
            if not heard and not leaf.from_start:
                return None
            return now >= (heard[-1] if heard else self.start) + leaf.seconds
        timeout = leaf.timeout if isinstance(leaf, CallableCondition) else leaf.signal.timeout
        if not history or (timeout is not None and now > history[-1][0] + timeout):
            return None
        if isinstance(leaf, CallableCondition):
            return None if history[-1][1] is None else bool(history[-1][1])
        values = [read(leaf.signal, m) for _, m in history]
        if isinstance(leaf, Compare):
            return judge(leaf, values[-1])
        if all(value is NOTHING for value in values):
            return None
        if isinstance(leaf, Received):
            return topic == current and values[-1] is not NOTHING
        return topic == current and self.moved(leaf, values)

    def moved(self, leaf: Changed, values: list[Any]) -> bool:
        reference, moved = NOTHING, False
        for value in values:
            moved = False
            if value is NOTHING:
                continue
            if reference is not NOTHING:
                if sort(value) == sort(reference) == "number" and leaf.deadband:
                    moved = abs(value - reference) > leaf.deadband
                else:
                    moved = not alike(value, reference) and not (
                        sort(value) == "other" and value == reference
                    )
            if moved or reference is NOTHING:
                reference = value
        return moved

    def snapshot(self, rule: Rule, current: str | None) -> tuple[Verdict, ...]:
        found = [self.leaf(leaf, current) for _, leaf in leaves(rule.event.condition)]
        if rule.event.clear:
            found += [self.leaf(leaf, current) for _, leaf in leaves(rule.event.clear)]
        return tuple(found)

    def topics(self, rule: Rule) -> list[str]:
        return list(dict.fromkeys(topic_of(leaf) for _, leaf in leaves(rule.event.condition)))

    # -- what happens

    def time_passes(self) -> None:
        for rule in self.rules:
            if rule.enabled and self.snapshot(rule, None) != self.memory[rule.id].seen:
                self.look(rule, None)
        for rule in self.rules:
            memory, hold = self.memory[rule.id], rule.event.hold
            if not hold or memory.since is None or memory.hold_done:
                continue
            if self.now >= memory.since + hold:
                memory.hold_done = True
                self.trigger(rule, None)
        for rule in self.rules:
            memory = self.memory[rule.id]
            if memory.queue and not memory.runs and self.now == memory.cool_until:
                self.dequeue(rule)

    def sample(self, topic: str, message: Any) -> None:
        self.history.setdefault(topic, []).append((self.now, message))
        for rule in self.rules:
            if not rule.enabled:
                continue
            own = topic in self.topics(rule)
            self.memory[rule.id].evaluated += own
            if own or self.snapshot(rule, topic) != self.memory[rule.id].seen:
                self.look(rule, topic)
        for rule in self.rules:
            if rule.enabled:
                self.rest(rule, self.verdict(rule.event.condition, None))
                self.memory[rule.id].seen = self.snapshot(rule, None)

    def look(self, rule: Rule, topic: str | None) -> None:
        memory, event = self.memory[rule.id], rule.event
        before = memory.verdict
        verdict = self.verdict(event.condition, topic)
        memory.seen = self.snapshot(rule, topic)
        sampled = topic in self.topics(rule)
        memory.true += sampled and verdict is True
        if verdict is not True:
            self.rest(rule, verdict, topic)
            return
        memory.verdict = True
        if before is not True:
            memory.since, memory.hold_done = self.now, False
        assert memory.since is not None
        if event.hold and self.now < memory.since + event.hold:
            return
        changes = [
            Changed(signal=leaf.signal)
            for _, leaf in leaves(event.condition)
            if isinstance(leaf, (Compare, Changed, Received))
        ]
        occasion = {
            "edge": True,
            "level": sampled or before is not True,
            "change": any(self.leaf(c, topic) is True for c in changes),
        }
        if occasion[event.trigger]:
            self.trigger(rule, topic if sampled else None)

    def rest(self, rule: Rule, verdict: Verdict, topic: str | None = None) -> None:
        memory, event = self.memory[rule.id], rule.event
        if verdict is True:
            return
        memory.verdict, memory.since = verdict, None
        if event.clear is None or memory.virgin:
            if verdict is False:
                memory.ready, memory.virgin = True, False
        elif self.verdict(event.clear, topic) is True:
            memory.ready = True

    def trigger(self, rule: Rule, topic: str | None) -> None:
        memory, event = self.memory[rule.id], rule.event
        if memory.latched or (event.once and memory.fired):
            return
        needs_arming = event.trigger == "edge" or event.clear is not None
        if needs_arming and not memory.ready:
            return
        if event.trigger == "edge":
            memory.ready = False
        if self.now < memory.cool_until:
            memory.dropped += 1
            return
        cause = self.cause(rule, topic)
        cancels: list[int] = []
        if memory.runs:
            if event.mode.kind == "restart":
                cancels = list(memory.runs)
            elif event.mode.kind == "queued" and len(memory.queue) < event.mode.size:
                memory.queue.append(cause)
                memory.ready = False
                return
            elif event.mode.kind != "parallel" or len(memory.runs) >= event.mode.size:
                memory.dropped += 1
                return
        if self.run(rule, cause, cancels):
            memory.ready = False

    def cause(self, rule: Rule, topic: str | None) -> Fired:
        if topic is None:
            heard = [t for t in self.topics(rule) if self.history.get(t)]
            for name in heard:
                if topic is None or self.history[name][-1][0] >= self.history[topic][-1][0]:
                    topic = name
        message = self.history[topic][-1][1] if topic else None
        size = len(list(leaves(rule.event.condition)))
        seen = self.memory[rule.id].seen[:size]
        return Fired(rule.id, 0, self.now, self.now, topic, message, seen, ())

    def run(self, rule: Rule, cause: Fired, cancels: list[int]) -> bool:
        memory, limit = self.memory[rule.id], rule.event.max_rate
        if limit:
            recent = [t for t in memory.times[-limit.count :] if self.now < t + limit.window]
            if len(recent) >= limit.count:
                memory.latched = True
                self.out.append(
                    Fired(rule.id, 0, self.now, self.now, None, None, (), (), latched=True)
                )
                return False
        memory.times.append(self.now)
        memory.runs = [r for r in memory.runs if r not in cancels] + [self.next_run]
        memory.fired += 1
        self.out.append(cause._replace(run_id=self.next_run, at=self.now, cancels=tuple(cancels)))
        self.next_run += 1
        return True

    def done(self, event: RunEnded) -> None:
        rule = next(r for r in self.rules if r.id == event.rule_id)
        memory = self.memory[rule.id]
        if event.run_id not in memory.runs:
            return
        memory.runs.remove(event.run_id)
        memory.failed += not event.ok
        memory.cool_until = self.now + rule.event.cooldown
        if memory.queue and not rule.event.cooldown:
            self.dequeue(rule)

    def dequeue(self, rule: Rule) -> None:
        memory = self.memory[rule.id]
        if memory.latched or not self.run(rule, memory.queue.popleft(), []):
            memory.queue.clear()
