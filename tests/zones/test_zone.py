"""What is a zone, and what is none: refused in a sentence that says how to mend it."""

import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from kompass.invalid import first_invalid
from kompass.store.errors import EntryRefused, NoSuchEntry, StaleEntry
from kompass.store.zone_store import ZoneStore
from kompass.zones.change import DeleteZone, EditZone, RestoreZone, SaveZone
from kompass.zones.zone import ZonePlan, area
from tests.zones.zones import MAP, SQUARE, plan


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"corners": SQUARE[:2]}, "at least 3"),
        ({"corners": (SQUARE[0], SQUARE[0], SQUARE[2])}, "is there twice"),
        ({"corners": (SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3])}, "crosses"),
        ({"corners": ((0, 0), (2, 0), (1, 0), (1, 1))}, "crosses"),
        ({"corners": ((0, 0), (0.1, 0), (0, 0.1))}, "less than"),
        ({"corners": ((0, 0), (math.nan, 0), (0, 1))}, "finite"),
        ({"corners": ((0, 0), (900, 0), (900, 900), (0, 900))}, "3600 m long"),
        ({"kind": "speed"}, "no speed"),
        ({"kind": "speed", "speed": 0.0}, "greater than or equal to 0.05"),
        ({"speed": 0.3}, "leave it out"),
        ({"name": " "}, "empty"),
    ],
)
def test_what_is_no_zone_is_refused_in_a_sentence(changed: dict[str, Any], told: str) -> None:
    with pytest.raises(ValidationError) as raised:
        plan(**changed)
    assert told in first_invalid(raised.value).text


@given(
    st.lists(st.floats(0.3, 5.0), min_size=3, max_size=20),
    st.booleans(),
    st.tuples(st.floats(-100, 100), st.floats(-100, 100)),
)
def test_whatever_is_seen_whole_from_its_middle_is_a_zone_either_way_round(
    radii: list[float], clockwise: bool, middle: tuple[float, float]
) -> None:
    turn = math.tau / len(radii)
    corners = [
        (middle[0] + r * math.cos(n * turn), middle[1] + r * math.sin(n * turn))
        for n, r in enumerate(radii)
    ]
    made = plan(corners=tuple(reversed(corners) if clockwise else corners))
    assert (area(made.corners) < 0) == clockwise
    assert ZonePlan.model_validate_json(made.model_dump_json()) == made


def test_zones_are_kept_changed_deleted_and_brought_back(tmp_path: Path) -> None:
    with ZoneStore.open(tmp_path, clock=lambda: 7.0) as store:
        saved = store.change(SaveZone(plan=plan()), "ava", "operator")
        slower = plan(kind="speed", speed=0.3)
        edited = store.change(EditZone(id=1, version=1, plan=slower), "ben", "engineer")
        assert (saved.version, edited.version, edited.author) == (1, 2, "ben")
        with pytest.raises(StaleEntry, match="ben"):
            store.change(DeleteZone(id=1, version=1), "ava", "operator")
        with pytest.raises(EntryRefused, match="another zone of this map"):
            store.change(SaveZone(plan=plan(name="STAIRS")), "ava", "operator")
        elsewhere = MAP.model_copy(update={"id": "1" * 32})
        store.change(SaveZone(plan=plan(map=elsewhere)), "ava", "operator")
        store.change(DeleteZone(id=1, version=2), "ava", "operator")
        with pytest.raises(NoSuchEntry):
            store.change(EditZone(id=1, version=2, plan=plan()), "ava", "operator")
        assert store.change(RestoreZone(id=1), "ava", "operator").speed == 0.3
    with ZoneStore.open(tmp_path) as store:
        assert [(zone.id, zone.version) for zone in store.book().zones] == [(1, 4), (2, 1)]
