"""Conditions read like sentences."""

import pytest

from kompass.rules.schema.conditions import CallableCondition, Compare, Condition
from kompass.rules.schema.describe import describe
from tests.rules.building import (
    absent,
    both,
    changed,
    compare,
    either,
    faster,
    opposite,
    received,
    signal,
    slower,
)

NEAR = Compare(signal=signal("scan", "ranges", aggregate="min"), operator="<", value=0.3)
ITEM = Compare(signal=signal("path", "poses", 0, "frame"), operator="==", value="map")


@pytest.mark.parametrize(
    ("condition", "text"),
    [
        (NEAR, "min(scan.ranges) < 0.3"),
        (ITEM, 'path.poses[0].frame == "map"'),
        (compare("a", "between", (1, 2.5)), "1 <= a.x <= 2.5"),
        (compare("a", "not_in", (1, 2)), "a.x not in [1, 2]"),
        (compare("a", "==", 1.5, tolerance=0.1), "a.x == 1.5 (±0.1)"),
        (compare("a", "==", True), "a.x == true"),
        (compare("a", "==", 1234567), "a.x == 1234567"),
        (compare("a", "==", 1234568.5), "a.x == 1234568.5"),
        (compare("a", "==", 10**400), f"a.x == {10**400}"),
        (received("/ns/a"), "ns/a received"),
        (changed("a", 0.5), "a.x changed by more than 0.5"),
        (absent("a", 5), "a absent for 5 s"),
        (slower("a", 5), "rate of a below 5 Hz over 1 s"),
        (faster("a", 5, 2), "rate of a above 5 Hz over 2 s"),
        (CallableCondition(name="ready"), "ready()"),
        (opposite(compare("a", ">", 1)), "not (a.x > 1)"),
        (
            both(compare("a", ">", 1), either(compare("b", ">", 1), compare("c", ">", 1))),
            "a.x > 1 and (b.x > 1 or c.x > 1)",
        ),
        (opposite(both(NEAR, NEAR)), "not (min(scan.ranges) < 0.3 and min(scan.ranges) < 0.3)"),
    ],
)
def test_a_condition_as_a_person_would_write_it(condition: Condition, text: str) -> None:
    assert describe(condition) == text
