"""The event log survives JSON, and says what is wrong with what is none."""

import json

import pytest

from kompass.backtest.event_log import (
    Began,
    Ended,
    Fired,
    Heard,
    LoggedEvent,
    Lost,
    Resumed,
    Swapped,
    from_data,
    swapped_text,
    to_data,
)
from kompass.rulebook.schema.status import LeafReading
from kompass.rules.schema.table import Table
from tests.rules.building import received, rule

TABLE = Table(rules=(rule(received("a")),))
LEAF = LeafReading(path=(0,), text="a.x < 1", value=0.1 + 0.2, age=None, verdict=True)


@pytest.mark.parametrize(
    "event",
    [
        Began(0.1 + 0.2, 1e9, "life", 3, TABLE, ("a", "b")),
        Resumed(1.0, 1e9, "life", 3, TABLE),
        Heard(1.0, "callable/f", "", True),
        Ended(1.0, "r", 2, False, "no server"),
        Fired(1 / 3, "r", 2, 1.0, 3, "hash", "a", True, (LEAF,)),
        Swapped(1.0, 4, TABLE, ("r",)),
        Lost(1.0, 12, "too slow"),
    ],
)
def test_an_event_is_the_same_again_to_the_last_bit(event: LoggedEvent) -> None:
    kind, data = to_data(event)
    assert from_data(kind, json.loads(json.dumps(data))) == event


def test_a_swap_is_the_same_as_text_that_is_put_together_from_what_is_known() -> None:
    event = Swapped(0.1 + 0.2, 4, TABLE, ("r",))
    kind, data = to_data(event)
    assert json.loads(swapped_text(event)) == data
    assert from_data(kind, json.loads(swapped_text(event))) == event


def test_fields_of_a_later_version_are_left_out_and_later_fields_have_defaults() -> None:
    event = from_data("ended", {"now": 1.0, "rule_id": "r", "run_id": 1, "mood": "good"})
    assert event == Ended(1.0, "r", 1)


@pytest.mark.parametrize(
    ("kind", "data", "complaint"),
    [
        ("begun", {}, "'begun' is no event of an event log; known are: began"),
        ("ended", {"now": 1.0}, "lacks rule_id, run_id"),
        ("swapped", {"now": 1.0, "revision": 1, "table": {"rules": [{}]}}, "rules.0.id"),
    ],
)
def test_what_is_no_event_is_refused(kind: str, data: dict[str, object], complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        from_data(kind, data)
