"""What a console knows of places: the newest book, and which of them are on the map of now."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest

from kompass.algorithms.grid import Grid
from kompass.monitor.client import MonitorClient
from kompass.places.map_identity import identify
from kompass.places.place import Place, PlaceBook, PlacePose
from kompass_console.link.places import PlacesWatch
from kompass_console.schema.world import WorldModel

LOWER, UPPER = (Grid(np.full((20, 30), cell, np.int8), 0.05) for cell in (0, 100))


class Told:
    """A monitor whose places are told by hand."""

    def __init__(self) -> None:
        self.tell: Callable[[str], None] = lambda _: None

    def watch_places(self, heard: Callable[[str], None]) -> None:
        self.tell = heard


@pytest.fixture
def world() -> WorldModel:
    return WorldModel()


@pytest.fixture
def told() -> Told:
    return Told()


@pytest.fixture
def changes() -> list[None]:
    return []


@pytest.fixture
def watch(world: WorldModel, told: Told, changes: list[None]) -> PlacesWatch:
    watch = PlacesWatch(world, lambda: changes.append(None))
    watch.follow(cast(MonitorClient, told))
    return watch


def book(**of: Any) -> str:
    places = tuple(
        Place(
            id=number,
            version=1,
            name=name,
            note="",
            author="ava",
            time=0.0,
            pose=PlacePose(x=0.5, y=0.5),
            map=identify(grid),
        )
        for number, (name, grid) in enumerate(of.items(), 1)
    )
    return PlaceBook(revision=len(places), places=places).model_dump_json()


def drawn(world: WorldModel) -> list[str]:
    stamped = world.places.get()
    return [] if stamped is None else [mark.name for mark in stamped.value]


def test_the_places_of_the_map_of_now_are_drawn_and_no_others(
    world: WorldModel, watch: PlacesWatch, told: Told, changes: list[None]
) -> None:
    told.tell(book(dock=LOWER, attic=UPPER))
    assert (drawn(world), watch.info().map) == ([], None)  # no map is known yet
    for grid, expected in ((LOWER, "dock"), (UPPER, "attic")):
        before = len(changes)
        world.map.set(grid)
        watch.here()  # somebody asks before the watch has looked
        watch.refresh()
        assert drawn(world) == [expected]
        assert watch.info().map == identify(grid).id
        assert len(changes) == before + 1
    world.map.clear()
    watch.refresh()
    assert (drawn(world), watch.info().map) == ([], None)


def test_the_same_map_once_more_changes_nothing(
    world: WorldModel, watch: PlacesWatch, changes: list[None]
) -> None:
    world.map.set(LOWER)
    watch.refresh()
    before = len(changes)
    world.map.set(Grid(LOWER.cells.copy(), 0.05))
    watch.refresh()
    assert len(changes) == before


@pytest.mark.parametrize("text", ["", "[]", '{"places": [{"id": 1}]}', '{"revision": "no"}'])
def test_what_cannot_be_read_leaves_what_was_known(
    watch: PlacesWatch, told: Told, text: str
) -> None:
    told.tell(book(dock=LOWER))
    told.tell(text)
    found = watch.find(1)
    assert found is not None
    assert found.name == "dock"
    assert watch.info().revision == 1


def test_nobody_floods_the_page_with_places(watch: PlacesWatch, told: Told) -> None:
    told.tell(book(dock=LOWER))
    told.tell(book(**{f"p{number}": LOWER for number in range(300)}))
    assert watch.info().revision == 300
    with pytest.raises(ValueError, match="at most 300"):
        book(**{f"p{number}": LOWER for number in range(301)})
