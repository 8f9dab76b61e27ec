"""A rule compiled alone: once for each rule, and used by every table that has it."""

from collections.abc import Callable
from typing import Any, NamedTuple

from kompass.rules.engine.predicates import Predicate, predicate_of
from kompass.rules.schema.actions import topics_in
from kompass.rules.schema.conditions import (
    Absent,
    CallableCondition,
    Changed,
    Compare,
    Condition,
    Leaf,
    Rate,
    Received,
    TreePath,
    leaves,
    timeout_of,
    topic_of,
)
from kompass.rules.schema.describe import describe
from kompass.rules.schema.identity_cache import IdentityCache
from kompass.rules.schema.signals import reader
from kompass.rules.schema.table import Rule, rule_hash
from kompass.rules.schema.values import MISSING


class Source(NamedTuple):
    """Where a leaf reads its value; equal keys are read once per message."""

    key: str
    read: Callable[[Any], Any]


class CompiledLeaf(NamedTuple):
    """A leaf; those of equal keys are one.

    Attributes
    ----------
    source
        None for a leaf that reads no value.
    pulses
        Whether it is true only while a message is handled.
    timeout
        Seconds for which its value counts; None for ever.
    """

    key: str
    condition: Leaf
    topic: str
    text: str
    predicate: Predicate
    source: Source | None
    pulses: bool
    timeout: float | None


class CompiledRule(NamedTuple):
    """A rule.

    Attributes
    ----------
    leaves, clear
        Of the condition and of what re-arms the rule, each with its place in the tree.
    changes
        Leaves that tell a change, for trigger 'change'.
    mentioned
        Topics from which arguments of the actions are taken.
    """

    hash: str
    leaves: tuple[tuple[TreePath, CompiledLeaf], ...]
    clear: tuple[tuple[TreePath, CompiledLeaf], ...]
    changes: tuple[CompiledLeaf, ...]
    mentioned: tuple[str, ...]


def _rule(rule: Rule) -> CompiledRule:
    event = rule.event
    return CompiledRule(
        hash=rule_hash(rule),
        leaves=_tree(event.condition),
        clear=() if event.clear is None else _tree(event.clear),
        changes=_changes(event.condition) if event.trigger == "change" else (),
        mentioned=tuple(name for action in rule.actions for name in topics_in(action)),
    )


compiled_rule = IdentityCache[Rule, CompiledRule](_rule)


def _tree(condition: Condition) -> tuple[tuple[TreePath, CompiledLeaf], ...]:
    return tuple((path, _leaf(leaf)) for path, leaf in leaves(condition))


def _changes(condition: Condition) -> tuple[CompiledLeaf, ...]:
    return tuple(
        _leaf(Changed(signal=leaf.signal))
        for _, leaf in leaves(condition)
        if isinstance(leaf, (Compare, Changed, Received))
    )


def _leaf(condition: Leaf) -> CompiledLeaf:
    return CompiledLeaf(
        key=condition.model_dump_json(),
        condition=condition,
        topic=topic_of(condition),
        text=describe(condition),
        predicate=_predicate(condition),
        source=_source(condition),
        pulses=isinstance(condition, (Changed, Received)),
        timeout=timeout_of(condition),
    )


def _source(condition: Leaf) -> Source | None:
    if isinstance(condition, Rate):
        return None
    path: tuple[str | int, ...] = ()
    aggregate: str | None = None
    if not isinstance(condition, CallableCondition):
        path, aggregate = condition.signal.path, condition.signal.aggregate
    if isinstance(condition, Absent) and not path and not aggregate:
        return None
    return Source(f"{topic_of(condition)} {path!r} {aggregate}", reader(path, aggregate))


def _predicate(condition: Leaf) -> Predicate:
    if isinstance(condition, Compare):
        return predicate_of(condition)
    if isinstance(condition, CallableCondition):
        return lambda value: None if value is MISSING else bool(value)
    return lambda value: None
