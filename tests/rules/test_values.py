"""Comparisons with three answers, and values read from messages."""

import array
import math
from types import SimpleNamespace as Message
from typing import Any

import numpy as np
import pytest

from kompass.rules.schema.signals import reader
from kompass.rules.schema.values import MISSING, compare, plain, same


@pytest.mark.parametrize(
    ("operator", "value", "reference", "verdict"),
    [
        ("==", 1, 1.0, True),
        ("==", 1.0, 2, False),
        ("<", 1, 1.5, True),
        ("==", True, 1, None),
        ("==", 1, True, None),
        ("==", "1", 1, None),
        ("!=", "1", 1, None),
        ("<", "a", 1, None),
        ("<", "a", "b", True),
        ("<", math.nan, 1, None),
        ("!=", math.nan, 1, None),
        ("<", math.inf, 0.3, False),
        (">=", True, 0, None),
        ("==", MISSING, 1, None),
        ("not_in", MISSING, [1], None),
        ("in", 2, [1, 2.0], True),
        ("in", True, [1, 2], None),
        ("in", "a", [1, "b"], False),
        ("not_in", 3, [1, 2], True),
        ("in", "car", "a car", True),
        ("in", 1, "1", None),
        ("between", 2, [1, 2], True),
        ("between", 2.1, [1, 2], False),
        ("between", "2", [1, 2], None),
        ("==", [1, 2], [1.0, 2], True),
        ("==", [1, 2], [1], False),
        ("contains", ["car", "dog"], "dog", True),
        ("contains", "hotdog", "dog", True),
        ("contains", ["car"], ["car", "dog"], False),
        ("contains_any", ["car"], ["car", "dog"], True),
        ("contains_all", ["dog", "car"], ["car", "dog"], True),
        ("contains_any", [], ["car"], False),
        ("not_contains", ["car"], "dog", True),
        ("not_contains_any", ["car"], ["car", "dog"], False),
        ("not_contains_all", ["car"], ["car", "dog"], True),
        ("contains", 5, 5, None),
        ("contains", "5", 5, None),
        ("contains", [True], 1, False),
    ],
)
def test_a_comparison_is_true_false_or_has_no_answer(
    operator: str, value: Any, reference: Any, verdict: bool | None
) -> None:
    assert compare(operator, value, reference) is verdict


def test_numbers_within_the_tolerance_are_equal() -> None:
    assert compare("==", 0.30000001192092896, 0.3, 1e-6) is True
    assert compare("!=", 0.31, 0.3, 1e-6) is True
    assert compare("==", [1.0, 2.0], [1.0, 2.05], 0.1) is True


def test_nothing_is_the_same_as_nothing_and_one_is_not_true() -> None:
    assert same(math.nan, math.nan)
    assert same([math.nan, "a"], [math.nan, "a"])
    assert not same(1, True)
    assert same(1, 1.0)


@pytest.mark.parametrize(
    ("aggregate", "ranges", "value"),
    [
        ("min", [math.inf, 0.5, math.nan, 2.0], 0.5),
        ("max", [math.inf, 0.5, math.nan, 2.0], 2.0),
        ("mean", [math.inf, 0.5, math.nan, 1.5], 1.0),
        ("len", [math.inf, 0.5], 2),
        ("any", [0.0, math.nan], False),
        ("any", [], False),
        ("all", [1.0, math.inf, 2.0], True),
        ("all", [1.0, 0.0], False),
        ("min", [math.inf], MISSING),
        ("mean", [], MISSING),
        ("all", [], MISSING),
        ("min", 5.0, MISSING),
        ("len", 5.0, MISSING),
    ],
)
def test_aggregates_are_over_finite_values(aggregate: str, ranges: Any, value: Any) -> None:
    read = reader(("ranges",), aggregate)
    assert read(Message(ranges=ranges)) == value
    if isinstance(ranges, list):
        assert read(Message(ranges=array.array("f", ranges))) == value
        assert read(Message(ranges=np.array(ranges, dtype=np.float32))) == value


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("pose", "x"), 1.0),
        (("poses", 1, "x"), 3.0),
        (("poses", -1, "x"), 3.0),
        (("poses", 2, "x"), MISSING),
        (("pose", "z"), MISSING),
        (("pose", 0), MISSING),
        (("none",), MISSING),
    ],
)
def test_a_path_leads_to_a_value_or_to_none(path: tuple[str | int, ...], value: Any) -> None:
    message = Message(pose=Message(x=1.0), poses=[Message(x=2.0), Message(x=3.0)], none=None)
    assert reader(path, None)(message) == value


@pytest.mark.parametrize(
    ("value", "as_plain"),
    [
        (np.float64(1.5), 1.5),
        (np.bool_(True), True),
        (np.zeros(3), [0.0, 0.0, 0.0]),
        (array.array("h", [1, 2]), [1, 2]),
        (b"\x01", [1]),
        ((1, "a"), [1, "a"]),
    ],
)
def test_values_of_any_origin_become_plain(value: Any, as_plain: Any) -> None:
    found = plain(value)
    assert (found, type(found)) == (as_plain, type(as_plain))


@pytest.mark.parametrize(
    ("value", "aggregate", "found"),
    [
        (b"\x02", None, 2),
        ([b"\x01", b"2"], None, [1, 50]),
        ([b"\x01", b"2"], "max", 50.0),
        ([b"\x00"], "any", False),
        ([b"\x01", b"2"], "len", 2),
        ([], None, []),
    ],
)
def test_a_byte_of_a_message_is_a_number(value: Any, aggregate: Any, found: Any) -> None:
    assert reader(("level",), aggregate)(Message(level=value)) == found
    assert (
        reader(("status", 0, "level"), aggregate)(Message(status=[Message(level=value)])) == found
    )
