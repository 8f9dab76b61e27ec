"""A table compiled to run: every distinct leaf once, indexed by topic, with the rules that use it.

Leaves that are equal in two rules are one leaf; signals that are equal are read once per message.
The verdict of each leaf is kept, and a message re-evaluates only the leaves whose verdict its
values can have changed; only rules with such a leaf, or that are true and want every message, are
evaluated (compare the alpha network of Forgy, "Rete", Artificial Intelligence 19, 1982).
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

from kompass.rules.engine.compiled_rule import CompiledLeaf, Source, compiled_rule
from kompass.rules.engine.leaf_index import LeafIndex
from kompass.rules.engine.predicates import Evaluate, Predicate, tree_of
from kompass.rules.schema.conditions import (
    Absent,
    AllOf,
    CallableCondition,
    Changed,
    Condition,
    Leaf,
    Rate,
    Received,
    TreePath,
    leaves,
    topic_of,
)
from kompass.rules.schema.events import Queued
from kompass.rules.schema.table import Rule, Table, table_hash

LEAST_COUNTED = 1000  # receive times that a topic with a rate remembers, or more


@dataclass(slots=True)
class LeafPlan:
    """One distinct leaf of the table."""

    index: int
    key: str
    condition: Leaf
    topic: int
    probe: int  # -1 for a leaf that reads no value
    text: str
    predicate: Predicate
    rules: tuple[int, ...] = ()  # enabled rules to look at when its verdict changes
    timer: int = -1  # of its silence or its rate


@dataclass(slots=True)
class ProbePlan:
    """One value read from the messages of a topic, and the leaves that look at it."""

    index: int
    key: str
    topic: int
    read: Callable[[Any], Any]
    compares: list[int] = field(default_factory=list)
    changes: list[int] = field(default_factory=list)
    receipts: list[int] = field(default_factory=list)
    watched: bool = False  # whether a leaf asks when it last had a value
    candidates: LeafIndex = field(default_factory=lambda: LeafIndex(()))


@dataclass(slots=True)
class TimerPlan:
    """Something about a topic that time alone can change.

    ``stale``: the values of ``leaves`` have grown older than ``seconds``. ``absent``: silence has
    lasted ``seconds``. ``rate``: fewer (or no longer fewer) than ``need`` messages lie within
    ``seconds``.
    """

    index: int
    key: str
    kind: str
    topic: int
    seconds: float
    leaves: list[int] = field(default_factory=list)
    probe: int = -1
    need: int = 0
    above: bool = False
    from_start: bool = False


@dataclass(slots=True)
class TopicPlan:
    """All that a message of one topic concerns."""

    index: int
    name: str
    probes: list[ProbePlan] = field(default_factory=list)
    timers: list[int] = field(default_factory=list)
    pulses: bool = False  # whether a leaf is true only while a message is handled
    history: int = 0  # receive times to remember, for rates
    rules: list[int] = field(default_factory=list)  # enabled, with the topic in their condition
    always: list[int] = field(default_factory=list)  # rules that a message of it can re-arm
    callable: bool = False


@dataclass(slots=True)
class RulePlan:
    """One rule, compiled."""

    index: int
    rule: Rule
    hash: str
    evaluate: Evaluate
    possible: Evaluate  # the verdict if every pulse were on
    clear: Evaluate | None
    leaves: tuple[tuple[TreePath, int], ...]
    clear_leaves: tuple[tuple[TreePath, int], ...]
    topics: tuple[int, ...]
    message_topics: tuple[int, ...]
    pulses: bool
    changes: tuple[int, ...]  # leaves that tell a change, for trigger 'change'
    # Fields of the event, unpacked for speed.
    trigger: str
    hold: float
    cooldown: float
    queue: int
    listening: bool  # whether it wants every message while it is true
    shadow: bool
    parts: tuple[Evaluate, ...]  # what must all be true, if that is three things or more


@dataclass(slots=True)
class CompiledTable:
    """A table ready for :func:`kompass.rules.engine.step.step`; not to be changed."""

    table: Table
    hash: str
    rules: list[RulePlan]
    leaves: list[LeafPlan]
    probes: list[ProbePlan]
    timers: list[TimerPlan]
    topics: list[TopicPlan]
    by_topic: dict[str, TopicPlan]
    by_id: dict[str, RulePlan]

    def topic_types(self) -> dict[str, set[str]]:
        """Return the message types that the rules expect, by topic; callables are left out."""
        types: dict[str, set[str]] = {p.name: set() for p in self.topics if not p.callable}
        for leaf in self.leaves:
            condition = leaf.condition
            if isinstance(condition, CallableCondition):
                continue
            kind = condition.type if isinstance(condition, Rate) else condition.signal.type
            if kind:
                types[topic_of(condition)].add(kind)
        return types


def compile_table(table: Table) -> CompiledTable:
    """Make a table ready to run; the work is linear in its size."""
    builder = _Builder()
    rules = [builder.rule(index, rule) for index, rule in enumerate(table.rules)]
    return builder.finish(table, rules)


def needed(bound: float, window: float, above: bool) -> int:
    """Return the least number of messages in a window at which the bound is met (or exceeded)."""
    count = max(1, math.floor(bound * window))
    while count / window < bound or (above and count / window <= bound):
        count += 1
    while count > 1 and _meets(count - 1, bound, window, above):
        count -= 1
    return count


def _meets(count: int, bound: float, window: float, above: bool) -> bool:
    return count / window > bound if above else count / window >= bound


class _Builder:
    def __init__(self) -> None:
        self.topics: list[TopicPlan] = []
        self.by_name: dict[str, TopicPlan] = {}
        self.probes: dict[str, ProbePlan] = {}
        self.plans: list[LeafPlan] = []
        self.leaf_index: dict[str, int] = {}
        self.timers: dict[str, TimerPlan] = {}
        self.rules_of_leaf: list[list[int]] = []

    def topic(self, name: str) -> TopicPlan:
        plan = self.by_name.get(name)
        if plan is None:
            plan = self.by_name[name] = TopicPlan(len(self.topics), name)
            self.topics.append(plan)
        return plan

    def leaf(self, leaf: CompiledLeaf) -> int:
        known = self.leaf_index.get(leaf.key)
        if known is not None:
            return known
        condition = leaf.condition
        topic = self.topic(leaf.topic)
        topic.callable = topic.callable or isinstance(condition, CallableCondition)
        probe = None if leaf.source is None else self._probe(topic, leaf.source)
        plan = LeafPlan(
            index=len(self.plans),
            key=leaf.key,
            condition=condition,
            topic=topic.index,
            probe=probe.index if probe else -1,
            text=leaf.text,
            predicate=leaf.predicate,
        )
        self.leaf_index[leaf.key] = plan.index
        self.plans.append(plan)
        self.rules_of_leaf.append([])
        if probe:
            _watch(probe, plan)
        topic.pulses = topic.pulses or leaf.pulses
        self._timer(topic, plan, leaf.timeout)
        return plan.index

    def _probe(self, topic: TopicPlan, source: Source) -> ProbePlan:
        probe = self.probes.get(source.key)
        if probe is None:
            probe = ProbePlan(len(self.probes), source.key, topic.index, source.read)
            self.probes[source.key] = probe
            topic.probes.append(probe)
        return probe

    def _timer(self, topic: TopicPlan, leaf: LeafPlan, timeout: float | None) -> None:
        condition = leaf.condition
        if timeout is not None:
            key = f"stale {topic.name} {timeout!r}"
            timer = self._add_timer(key, "stale", topic, timeout)
            timer.leaves.append(leaf.index)
        elif isinstance(condition, Absent):
            timer = self._add_timer(leaf.key, "absent", topic, condition.seconds)
            timer.leaves.append(leaf.index)
            timer.probe, timer.from_start = leaf.probe, condition.from_start
            leaf.timer = timer.index
        elif isinstance(condition, Rate):
            timer = self._add_timer(leaf.key, "rate", topic, condition.window)
            timer.leaves.append(leaf.index)
            bound = condition.below if condition.below is not None else condition.above
            assert bound is not None
            timer.above = condition.above is not None
            timer.need = needed(bound, condition.window, timer.above)
            # The verdict needs no more than that; people are shown how many there were.
            topic.history = max(topic.history, timer.need, LEAST_COUNTED)
            leaf.timer = timer.index

    def _add_timer(self, key: str, kind: str, topic: TopicPlan, seconds: float) -> TimerPlan:
        timer = self.timers.get(key)
        if timer is None:
            timer = TimerPlan(len(self.timers), key, kind, topic.index, seconds)
            self.timers[key] = timer
            topic.timers.append(timer.index)
        return timer

    def rule(self, index: int, rule: Rule) -> RulePlan:
        event, known = rule.event, compiled_rule(rule)
        tree = tuple((path, self.leaf(leaf)) for path, leaf in known.leaves)
        clear = tuple((path, self.leaf(leaf)) for path, leaf in known.clear)
        pulses = {at for (_, at), (_, leaf) in zip(tree, known.leaves, strict=True) if leaf.pulses}
        topics = _unique(self.plans[leaf].topic for _, leaf in tree)
        if rule.enabled:
            for leaf in _unique(leaf for _, leaf in (*tree, *clear)):
                self.rules_of_leaf[leaf].append(index)
            for topic in topics:
                self.topics[topic].rules.append(index)
            for (_, at), (_, each) in zip(clear, known.clear, strict=True):
                if each.pulses:
                    self.topics[self.plans[at].topic].always.append(index)
        mentioned = [self.topic(name).index for name in known.mentioned]
        places = dict(tree)
        evaluate = possible = tree_of(event.condition, places)
        if pulses:
            possible = tree_of(event.condition, {p: -1 if i in pulses else i for p, i in tree})
        return RulePlan(
            index=index,
            rule=rule,
            hash=known.hash,
            evaluate=evaluate,
            possible=possible,
            clear=None if event.clear is None else tree_of(event.clear, dict(clear)),
            leaves=tree,
            clear_leaves=clear,
            topics=topics,
            message_topics=_unique([*topics, *mentioned]),
            pulses=bool(pulses),
            changes=_unique(map(self.leaf, known.changes)),
            trigger=event.trigger,
            hold=event.hold,
            cooldown=event.cooldown,
            queue=event.mode.size if isinstance(event.mode, Queued) else 0,
            listening=event.trigger != "edge" or bool(pulses),
            shadow=rule.shadow,
            parts=_parts(event.condition, places, pulses),
        )

    def finish(self, table: Table, rules: list[RulePlan]) -> CompiledTable:
        plans = self.plans
        for plan, hanging in zip(plans, self.rules_of_leaf, strict=True):
            plan.rules = tuple(hanging)
        for probe in self.probes.values():
            probe.candidates = LeafIndex((i, plans[i].condition) for i in probe.compares)
        names = dict(self.by_name)
        names.update({f"/{name}": plan for name, plan in self.by_name.items()})
        return CompiledTable(
            table=table,
            hash=table_hash(table),
            rules=rules,
            leaves=plans,
            probes=list(self.probes.values()),
            timers=list(self.timers.values()),
            topics=self.topics,
            by_topic=names,
            by_id={plan.rule.id: plan for plan in rules},
        )


def _watch(probe: ProbePlan, leaf: LeafPlan) -> None:
    if isinstance(leaf.condition, Changed):
        probe.changes.append(leaf.index)
    elif isinstance(leaf.condition, Received):
        probe.receipts.append(leaf.index)
        probe.watched = True
    elif isinstance(leaf.condition, Absent):
        probe.watched = True
    else:
        probe.compares.append(leaf.index)


def _parts(
    condition: Condition, index: dict[TreePath, int], pulses: set[int]
) -> tuple[Evaluate, ...]:
    """Return what a near miss is told by: one of many conditions is wanting."""
    if not isinstance(condition, AllOf):
        return ()
    found = []
    for place, child in enumerate(condition.conditions):
        if not any(index[path] in pulses for path, _ in leaves(child, (place,))):
            found.append(tree_of(child, index, (place,)))
    return tuple(found) if len(found) > 2 else ()


def _unique(items: Iterable[int]) -> tuple[int, ...]:
    return tuple(dict.fromkeys(items))
