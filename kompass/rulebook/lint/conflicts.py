"""Rules that want opposite things at the same time."""

import json
import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple, TypeAlias

from pydantic import JsonValue

from kompass.rulebook.schema.report import Finding
from kompass.rules.schema.actions import Lifecycle, UpdateParameters
from kompass.rules.schema.arguments import is_reference
from kompass.rules.schema.conditions import AllOf, Compare, Condition
from kompass.rules.schema.describe import describe
from kompass.rules.schema.model import Scalar
from kompass.rules.schema.table import Rule
from kompass.rules.schema.values import Kind, kind_of

# Of more rules that set one thing, not every pair is looked at.
_PAIRS = 40
_CONTRARY = {"start": "on", "restart": "on", "stop": "off"}


class _Assignment(NamedTuple):
    """Something set to a value by a rule."""

    rule: Rule
    where: str
    value: JsonValue


def contradictions(rules: Sequence[Rule]) -> Iterator[Finding]:
    """Find pairs of rules that set one thing to different values and may both be true."""
    assignments: dict[str, list[_Assignment]] = {}
    for rule in rules:
        for what, assignment in _assignments(rule):
            assignments.setdefault(what, []).append(assignment)
    said: set[tuple[str, str]] = set()
    for what, found in assignments.items():
        for number, one in enumerate(found[:_PAIRS]):
            for other in found[number + 1 : _PAIRS]:
                pair = (one.rule.id, other.rule.id)
                if one.rule.id == other.rule.id or one.value == other.value or pair in said:
                    continue
                if may_overlap(one.rule.event.condition, other.rule.event.condition):
                    said.add(pair)
                    yield _finding(what, one, other)


def _assignments(rule: Rule) -> Iterator[tuple[str, _Assignment]]:
    """Walk what a rule sets in the end: of two actions on one thing the last one counts."""
    last: dict[str, _Assignment] = {}
    for index, action in enumerate(rule.actions):
        if isinstance(action, UpdateParameters):
            for name, value in action.parameters.items():
                if not is_reference(value):
                    where = f"actions[{index}].parameters.{name}"
                    last[f"{action.component}.{name}"] = _Assignment(rule, where, value)
        elif isinstance(action, Lifecycle) and action.action in _CONTRARY:
            where = f"actions[{index}].action"
            last[action.component] = _Assignment(rule, where, _CONTRARY[action.action])
    yield from last.items()


def _finding(what: str, one: _Assignment, other: _Assignment) -> Finding:
    name = one.rule.name or one.rule.id
    return Finding(
        level="lint",
        code="contradiction",
        rule_id=other.rule.id,
        field=other.where,
        value=other.value,
        text=(
            f"it sets {what} to {json.dumps(other.value)}, and '{name}' sets it to "
            f"{json.dumps(one.value)}; both may be true at once"
        ),
        remedy="make their conditions exclude each other, or leave one of them out",
    )


def may_overlap(one: Condition, other: Condition) -> bool:
    """Whether two conditions that look at the same values can be true together.

    Conditions that share no value are not said to overlap: any two of them could.
    """
    if describe(one) == describe(other):
        return True
    first, second = _ranges(one), _ranges(other)
    if first is None or second is None:
        return False
    shared = first.keys() & second.keys()
    return bool(shared) and all(_both(first[key], second[key]) is not None for key in shared)


# Python takes 1 and True for the same; a rule does not.
_Value: TypeAlias = tuple[Kind, Scalar]


class _Range(NamedTuple):
    """Values for which a comparison is true: an interval, or some single ones."""

    # Whole numbers stay whole: they may lie beyond all floats.
    low: float = -math.inf
    high: float = math.inf
    open_low: bool = False
    open_high: bool = False
    values: frozenset[_Value] | None = None


def _ranges(condition: Condition) -> dict[str, _Range] | None:
    """Return what each signal must be for a conjunction; what is no comparison is left out.

    None for one that no value can fulfil.
    """
    found: dict[str, _Range] = {}
    for part in _conjuncts(condition):
        signal = part.signal
        key = f"{signal.topic} {signal.path!r} {signal.aggregate}"
        made = _range(part)
        if made is not None:
            narrowed = _both(found.get(key, _Range()), made)
            if narrowed is None:
                return None
            found[key] = narrowed
    return found


def _conjuncts(condition: Condition) -> Iterator[Compare]:
    """Walk the comparisons that must all be true."""
    if isinstance(condition, AllOf):
        for part in condition.conditions:
            yield from _conjuncts(part)
    elif isinstance(condition, Compare):
        yield condition


def _range(part: Compare) -> _Range | None:
    value = part.value
    if part.operator == "==" and not isinstance(value, tuple):
        return _Range(values=frozenset({_value(value)}))
    if part.operator == "in" and isinstance(value, tuple):
        return _Range(values=frozenset(map(_value, value)))
    if part.operator == "between":
        assert isinstance(value, tuple)
        low, high = value
        assert not isinstance(low, str)
        assert not isinstance(high, str)
        return _Range(low, high)
    if isinstance(value, (str, tuple)):
        return None
    if part.operator in ("<", "<="):
        return _Range(high=value, open_high=part.operator == "<")
    if part.operator in (">", ">="):
        return _Range(low=value, open_low=part.operator == ">")
    return _Range()


def _value(value: Scalar) -> _Value:
    return kind_of(value), value


def _both(one: _Range, other: _Range) -> _Range | None:
    """What is in both; None when nothing is."""
    if one.values is not None and other.values is not None:
        common = one.values & other.values
        return _Range(values=common) if common else None
    for values, interval in ((one.values, other), (other.values, one)):
        if values is not None:
            within = frozenset(value for value in values if _within(value, interval))
            return _Range(values=within) if within else None
    low, high = max(one.low, other.low), min(one.high, other.high)
    open_low = (one.low == low and one.open_low) or (other.low == low and other.open_low)
    open_high = (one.high == high and one.open_high) or (other.high == high and other.open_high)
    if low > high or (low == high and (open_low or open_high)):
        return None
    return _Range(low, high, open_low, open_high)


def _within(value: _Value, interval: _Range) -> bool:
    kind, number = value
    if kind != "number":
        return True  # a text or a truth value, against a bound: nothing can be said
    assert not isinstance(number, str)
    above = number > interval.low or (number == interval.low and not interval.open_low)
    below = number < interval.high or (number == interval.high and not interval.open_high)
    return above and below
