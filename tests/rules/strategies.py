"""Random tables and streams over a small world, so that everything meets everything.

Times lie on a grid that floats hold exactly: things that are due at the same moment are common.
"""

import math
from itertools import product
from types import SimpleNamespace
from typing import Any

from hypothesis import strategies as st

from kompass.rules.schema.actions import Log
from kompass.rules.schema.conditions import (
    Absent,
    AllOf,
    AnyOf,
    CallableCondition,
    Changed,
    Compare,
    Condition,
    Not,
    Rate,
    Received,
)
from kompass.rules.schema.events import Event, MaxRate, Parallel, Queued, Restart, Single
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Severity, Table

TOPICS = ("a", "b", "c")
GRID = 0.125
NUMBERS = (-1, 0, 0.5, 1, 2, 3.0, 5)
WORDS = ("", "car", "person", "cart")
ITEMS = (0, 1, 2.5, "car", "person", True)

TIMEOUTS = (None, 0.25, 0.5, 1.0)

durations = st.sampled_from([0.125, 0.25, 0.5, 1.0, 1.5])
timeouts = st.sampled_from(TIMEOUTS)


# What has few values is written out and picked with one draw: drawing costs more than the engine.
def signals(path: tuple[str | int, ...], aggregate: Any = None) -> st.SearchStrategy[Signal]:
    made = [
        Signal(
            topic=topic,
            type="std_msgs/msg/Float64",
            path=path,
            aggregate=aggregate,
            timeout=timeout,
        )
        for topic, timeout in product(TOPICS, TIMEOUTS)
    ]
    return st.integers(0, len(made) - 1).map(lambda i: made[i])


any_signal = st.one_of(
    signals(("x",)),
    signals(("x",)),
    signals(("flag",)),
    signals(("name",)),
    signals(("items",)),
    signals(("items", 1)),
    signals(()),
    signals(("ranges",), "min"),
    signals(("ranges",), "len"),
    signals(("ranges",), "any"),
)
plain_signal = st.one_of(signals(("x",)), signals(("name",)), signals(()), signals(("items", 0)))


def compares(signal: Any, operators: tuple[str, ...], value: Any) -> st.SearchStrategy[Compare]:
    return st.builds(Compare, signal=signal, operator=st.sampled_from(operators), value=value)


numbers = st.sampled_from(NUMBERS)
several = st.lists(numbers, min_size=1, max_size=3).map(tuple)
bounds = st.tuples(numbers, numbers).map(lambda pair: tuple(sorted(pair)))
words = st.lists(st.sampled_from(ITEMS), min_size=1, max_size=2).map(tuple)
comparisons = st.one_of(
    compares(signals(("x",)), ("<", "<=", ">", ">=", "==", "!="), numbers),
    compares(signals(("x",)), ("<", "<=", ">", ">=", "==", "!="), numbers),
    compares(signals(("x",)), ("between",), bounds),
    compares(signals(("x",)), ("in", "not_in"), several),
    st.builds(
        Compare,
        signal=signals(("x",)),
        operator=st.sampled_from(("==", "!=")),
        value=numbers,
        tolerance=st.sampled_from((0.5, 1.0)),
    ),
    compares(signals(("flag",)), ("==", "!="), st.booleans()),
    compares(signals(("name",)), ("==", "!=", "<", "contains"), st.sampled_from(WORDS)),
    compares(signals(("name",)), ("in", "not_in"), st.sampled_from(("a person", ("car", "")))),
    compares(signals(("items",)), ("contains", "not_contains"), st.sampled_from(ITEMS)),
    compares(
        signals(("items",)),
        ("contains_any", "contains_all", "not_contains_any", "not_contains_all", "=="),
        words,
    ),
    compares(signals(("ranges",), "min"), ("<", ">="), numbers),
    compares(signals(("ranges",), "len"), ("==",), st.integers(0, 3)),
    # Kinds that do not match: never a verdict.
    compares(any_signal, ("==", "!="), st.sampled_from((1, True, "car"))),
)
steady = st.one_of(
    comparisons,
    comparisons,
    comparisons,
    st.builds(Absent, signal=plain_signal, seconds=durations, from_start=st.booleans()),
    st.builds(
        Rate,
        topic=st.sampled_from(TOPICS),
        below=st.sampled_from((1.0, 2.0, 4.0)),
        window=durations,
    ),
    st.builds(
        Rate,
        topic=st.sampled_from(TOPICS),
        above=st.sampled_from((1.0, 2.0, 4.0)),
        window=durations,
    ),
    st.builds(CallableCondition, name=st.just("f"), timeout=timeouts),
)
pulses = st.one_of(
    st.builds(Received, signal=plain_signal),
    st.builds(Changed, signal=plain_signal, deadband=st.sampled_from((0.0, 1.0))),
)


def _trees(leaf: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    def join(inner: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
        parts = st.lists(inner, min_size=1, max_size=3).map(tuple)
        return st.one_of(
            st.builds(AllOf, conditions=parts),
            st.builds(AnyOf, conditions=parts),
        )

    return st.recursive(leaf, join, max_leaves=4)


negated = st.builds(Not, condition=_trees(steady))
lasting: st.SearchStrategy[Condition] = _trees(st.one_of(steady, steady, negated))
conditions: st.SearchStrategy[Condition] = _trees(st.one_of(steady, steady, negated, pulses))

modes = st.one_of(
    st.just(Single()),
    st.just(Single()),
    st.builds(Queued, size=st.integers(1, 2)),
    st.just(Restart()),
    st.builds(Parallel, size=st.integers(1, 2)),
)


@st.composite
def events(draw: st.DrawFn) -> Event:
    fields: dict[str, Any] = {
        "trigger": draw(st.sampled_from(("level", "level", "edge", "edge", "change"))),
        "cooldown": draw(st.sampled_from((0.0, 0.0, 0.25, 1.0))),
        "once": draw(st.sampled_from((False, False, False, True))),
        "mode": draw(modes),
        "clear": draw(st.one_of(st.none(), st.none(), conditions)),
        "first_true_is_edge": draw(st.booleans()),
        "max_rate": draw(
            st.one_of(
                st.none(),
                st.none(),
                st.builds(MaxRate, count=st.integers(1, 3), window=durations),
            )
        ),
    }
    if fields["trigger"] == "change":
        fields["condition"] = AllOf(conditions=(draw(comparisons), draw(conditions)))
        if draw(st.booleans()):
            fields["condition"] = draw(comparisons)
    elif draw(st.booleans()):
        fields["hold"] = draw(durations)
        fields["condition"] = draw(lasting)
    else:
        fields["condition"] = draw(conditions)
    return Event.model_validate(fields)


@st.composite
def tables(draw: st.DrawFn, max_rules: int = 4) -> Table:
    found = draw(st.lists(events(), min_size=1, max_size=max_rules))
    rules = tuple(
        Rule(
            id=f"r{i}",
            event=event,
            actions=(Log(text="!"),),
            enabled=draw(st.sampled_from((True, True, True, True, False))),
            severity=draw(st.sampled_from(Severity)),
            lane=draw(st.sampled_from(("safety", "normal"))),
        )
        for i, event in enumerate(found)
    )
    return Table(rules=rules)


def _message(fields: dict[str, Any], left_out: str) -> Any:
    fields.pop(left_out, None)
    return SimpleNamespace(**fields)


messages = st.builds(
    _message,
    st.fixed_dictionaries(
        {
            "x": st.sampled_from((*NUMBERS, math.nan, math.inf)),
            "flag": st.booleans(),
            "name": st.sampled_from(WORDS),
            "items": st.lists(st.sampled_from(ITEMS), max_size=3),
            "ranges": st.lists(st.sampled_from((0.0, 0.5, 2.0, math.inf, math.nan)), max_size=3),
        }
    ),
    st.sampled_from(("", "", "", "", "x", "items")),
)

# What happens: how much later, and a sample, a tick, or the end of the n-th run in progress.
samples = st.tuples(st.sampled_from(("a", "/a", "b", "/b", "c", "unheard")), messages)
callable_samples = st.tuples(st.just("callable/f"), st.sampled_from((True, False, 1, None)))
happenings = st.one_of(
    samples,
    samples,
    samples,
    callable_samples,
    st.just("tick"),
    st.tuples(st.integers(0, 3), st.booleans()),
)
steps = st.tuples(st.sampled_from((0, 0, 1, 1, 2, 2, 3, 4, 8, 13)), happenings)
streams = st.lists(steps, min_size=1, max_size=25)
