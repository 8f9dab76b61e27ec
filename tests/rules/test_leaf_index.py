"""A thousand rules on one field cost what the few that can change cost."""

import sys
from types import FrameType
from typing import Any

import pytest
from hypothesis import strategies as st

from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.leaf_index import LeafIndex
from kompass.rules.engine.predicates import predicate_of
from kompass.rules.schema.conditions import Compare
from kompass.rules.schema.table import Table
from tests.rules.building import Robot, both, changed, compare, received, rule
from tests.rules.strategies import ITEMS, NUMBERS, WORDS, comparisons
from tests.support.properties import property_test

numbers = st.sampled_from((*NUMBERS, float("nan"), float("inf")))
kinds = st.sampled_from(
    (
        numbers,
        numbers,
        st.sampled_from(WORDS),
        st.booleans(),
        st.lists(st.sampled_from(ITEMS), max_size=3),
    )
)
# Mostly two values of one kind: between kinds, all leaves are candidates.
pairs = st.one_of(
    kinds.flatmap(lambda kind: st.tuples(kind, kind)),
    st.tuples(kinds, kinds).flatmap(lambda two: st.tuples(*two)),
)


@property_test(st.lists(comparisons, min_size=7, max_size=20), pairs)
def test_every_leaf_that_changes_is_a_candidate(
    leaves: list[Compare], pair: tuple[Any, Any]
) -> None:
    old, new = pair
    index = LeafIndex(enumerate(leaves))
    found = set(index.candidates(old, new))
    predicates = [predicate_of(leaf) for leaf in leaves]
    changed_ones = {i for i, verdict in enumerate(predicates) if verdict(old) is not verdict(new)}
    assert changed_ones <= found


@pytest.mark.parametrize(
    ("make", "old", "new"),
    [
        (lambda i: compare("t", ">", 100.0 + i), 1.0, 5.0),
        (lambda i: compare("t", "==", float(i)), 0.0, 900.0),
        (lambda i: compare("t", "!=", float(i)), 0.0, 900.0),
        (lambda i: compare("t", "in", (i, i + 0.5)), 3, 700),
        (lambda i: compare("t", "==", f"state-{i}"), "state-1", "state-900"),
        (lambda i: compare("t", "contains_any", (f"label-{i}",)), ["label-1"], ["label-5"]),
        (lambda i: compare("t", "between", (10 * i, 10 * i + 5)), 3.0, 9003.0),
        (lambda i: compare("t", "==", float(10 * i), tolerance=1.0), 0.5, 9000.5),
    ],
)
def test_of_a_thousand_leaves_few_are_candidates(make: Any, old: Any, new: Any) -> None:
    index = LeafIndex(enumerate(make(i) for i in range(1000)))
    assert len(index.candidates(old, new)) <= 6


@pytest.mark.parametrize(
    "make",
    [
        lambda i: compare("t", ">", 100.0 + i),
        lambda i: both(changed("t"), compare("t", "==", 100.0 + i)),
        lambda i: both(received("t"), compare("t", "==", 100.0 + i)),
    ],
)
@pytest.mark.parametrize("trigger", ["level", "edge", "change"])
def test_a_message_looks_at_no_rule_that_it_cannot_make_true(make: Any, trigger: str) -> None:
    robot = Robot(*(rule(make(i), f"r{i}", trigger=trigger) for i in range(200)))
    looks = 0
    for plan in robot.table.rules:
        evaluate = plan.evaluate

        def counted(verdicts: Any, evaluate: Any = evaluate) -> bool | None:
            nonlocal looks
            looks += 1
            verdict: bool | None = evaluate(verdicts)
            return verdict

        plan.evaluate = counted
    robot.say("t", 1.0)
    looks = 0
    for x in range(50):
        robot.say("t", float(x % 7))
    assert looks == 0


def test_the_work_to_compile_a_table_grows_with_its_rules_and_no_faster() -> None:
    def lines_run(count: int) -> int:
        table = Table(rules=tuple(rule(compare("t", ">", i), f"r{i}") for i in range(count)))
        lines = 0

        def trace(frame: FrameType, event: str, argument: Any) -> Any:
            nonlocal lines
            lines += event == "line"
            return trace

        before = sys.gettrace()  # that of a coverage, or of a debugger
        sys.settrace(trace)
        try:
            compile_table(table)
        finally:
            sys.settrace(before)
        return lines

    # Four times as many rules: a little more than four times the work where something is sorted.
    assert lines_run(400) < 5 * lines_run(100)


def test_equal_leaves_of_many_rules_are_one() -> None:
    table = compile_table(Table(rules=tuple(rule(compare("t", ">", 1), f"r{i}") for i in range(9))))
    assert (len(table.leaves), len(table.probes)) == (1, 1)
    robot = Robot(*(plan.rule for plan in table.rules))
    assert len(robot.say("t", 2)) == 9
