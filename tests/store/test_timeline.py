"""The timeline on disk: found again, searched, counted, bounded."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from kompass.store.errors import StoreBusy
from kompass.store.timeline_store import Shelf, TimelineStore
from kompass.timeline.entry import Kind, Level, TimelineEntry
from kompass.timeline.query import TimelineQuery


def entry(number: int, kind: Kind = "goal", level: Level = "info", **more: object) -> TimelineEntry:
    given = {"time": float(number), "ended": float(number), "title": f"entry {number}"}
    return TimelineEntry.model_validate(
        {"number": number, "kind": kind, "level": level, **given, **more}
    )


@pytest.fixture
def store(tmp_path: Path) -> Iterator[TimelineStore]:
    with TimelineStore.open(tmp_path, clock=lambda: 100.0) as opened:
        yield opened


def numbers(store: TimelineStore, **query: object) -> list[int]:
    return [each.number for each in store.page(TimelineQuery.model_validate(query)).entries]


def test_entries_outlive_the_process_and_a_changed_one_takes_the_place_of_itself(
    tmp_path: Path,
) -> None:
    with TimelineStore.open(tmp_path) as store:
        store.put([entry(1), entry(2, ended=None, lasts=True)])
        with pytest.raises(StoreBusy):
            TimelineStore.open(tmp_path)
    with TimelineStore.open(tmp_path) as store:
        assert store.newest() == 2
        assert [each.number for each in store.lasting()] == [2]
        store.put([entry(2, ended=9.0)])
        assert store.lasting() == []
        assert numbers(store) == [2, 1]


def test_pages_go_back_from_the_newest(store: TimelineStore) -> None:
    store.put(entry(number) for number in range(1, 8))
    page = store.page(TimelineQuery(count=3))
    assert ([each.number for each in page.entries], page.more) == ([7, 6, 5], True)
    page = store.page(TimelineQuery(before=5, count=4))
    assert ([each.number for each in page.entries], page.more) == ([4, 3, 2, 1], False)
    assert page.oldest == 1.0


def test_they_are_found_by_kind_level_words_and_time(store: TimelineStore) -> None:
    store.put(
        [
            entry(1, "stop", "warning", who="Åsa", time=10.0, ended=20.0),
            entry(2, "fault", "error", source="planner", time=30.0, ended=None, lasts=True),
            entry(3, "edit", text="100 % slower_now", time=40.0, ended=40.0),
        ]
    )
    assert numbers(store, kinds=["stop", "edit"]) == [3, 1]
    assert numbers(store, level="warning") == [2, 1]
    assert numbers(store, text="åsa") == [1]
    assert numbers(store, text="PLAN") == [2]
    assert numbers(store, text="0 % slower_") == [3], "no sign has a meaning of its own"
    assert numbers(store, since=15.0, until=25.0) == [1], "it was there at that time"
    assert numbers(store, since=35.0) == [3, 2], "what lasts is there still"
    assert numbers(store, until=35.0) == [2, 1]


def test_they_are_counted_over_the_time_that_is_looked_at(store: TimelineStore) -> None:
    store.put([entry(1, time=0.5), entry(2, time=0.7), entry(3, "fault", "error", time=3.9)])
    page = store.page(TimelineQuery(until=4.0, since=0.0, slots=4))
    found = [(each.kind, each.slot, each.count, each.level) for each in page.slots]
    assert found == [("fault", 3, 1, "error"), ("goal", 0, 2, "info")]


def test_a_flood_of_one_kind_pushes_out_no_other(tmp_path: Path) -> None:
    with TimelineStore(tmp_path, lambda: 0.0, most_of_kind=100) as store:
        store.put([entry(1, "edit")])
        for first in range(2, 1002, 50):
            store.put(entry(number, "rule") for number in range(first, first + 50))
        kept = numbers(store, kinds=["rule"], count=500)
        assert 50 <= len(kept) <= 100
        assert kept[0] == 1001
        assert numbers(store, kinds=["edit"]) == [1]


def test_a_shelf_is_found_again_until_its_time_is_over(tmp_path: Path) -> None:
    now = [100.0]
    with TimelineStore.open(tmp_path, clock=lambda: now[0]) as store:
        store.shelve(Shelf("bell", 160.0, "ava"))
        store.shelve(Shelf("dust", 120.0, "ben"))
        store.shelve(Shelf("dust", 0.0, "ben"))
    with TimelineStore.open(tmp_path, clock=lambda: now[0]) as store:
        assert store.shelves() == [Shelf("bell", 160.0, "ava")]
        now[0] = 161.0
        assert store.shelves() == []
