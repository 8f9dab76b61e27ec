"""What a place may be called, and which map it is on."""

import numpy as np
import pytest
from pydantic import ValidationError

from kompass.algorithms.grid import Grid
from kompass.invalid import first_invalid
from kompass.places.change import PLACE_CHANGE, SavePlace
from kompass.places.map_identity import identify
from kompass.places.place import LONGEST_NAME, MapIdentity, PlacePose, same_name

HERE = MapIdentity(id="0" * 32, label="4.0 × 3.0 m")


def saved(name: str, note: str = "") -> SavePlace:
    return SavePlace(name=name, note=note, pose=PlacePose(x=1.0, y=2.0), map=HERE)


@pytest.mark.parametrize("name", ["Dock", "Halle 3, Tor B", "倉庫", "Küche", "<b>Dock</b>", "🔋"])
def test_a_place_has_any_name_that_people_can_read(name: str) -> None:
    assert saved(name).name == name


def test_a_name_is_one_line_without_blanks_around_it() -> None:
    assert saved("  Dock \n left ").name == "Dock left"


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("", "it is empty; give the place a name"),
        (" \t ", "it is empty; give the place a name"),
        ("x" * (LONGEST_NAME + 1), f"use at most {LONGEST_NAME}"),
        ("Do\u202eck", "cannot be seen"),
        ("Do\u200bck", "cannot be seen"),
        ("Dock\x1b[31m", "cannot be seen"),
        ("x" * 100_000, "at most"),
    ],
)
def test_another_name_is_refused_with_the_remedy(name: str, why: str) -> None:
    with pytest.raises(ValidationError) as refused:
        saved(name)
    wrong = first_invalid(refused.value)
    assert wrong.where == "name"
    assert why in wrong.text


@pytest.mark.parametrize("value", ["NaN", "Infinity", "1e300"])
def test_a_place_is_somewhere(value: str) -> None:
    text = saved("Dock").model_dump_json().replace("1.0", value, 1)
    with pytest.raises(ValidationError):
        PLACE_CHANGE.validate_json(text)


def test_names_that_people_take_for_one_are_one() -> None:
    assert same_name("DOCK") == same_name("Dock") == same_name("Ｄｏｃｋ")
    assert same_name("Straße") == same_name("STRASSE")
    assert same_name("Dock 1") != same_name("Dock 2")


def grid(resolution: float = 0.05, x: float = -4.0) -> Grid:
    return Grid(np.zeros((60, 80), np.int8), resolution, (x, -3.0, 0.0))


def test_the_same_map_is_the_same_whoever_sends_it() -> None:
    assert identify(grid()) == identify(grid())
    as_in_a_message = float(np.float32(0.05))
    assert identify(grid(as_in_a_message)).id == identify(grid()).id
    assert identify(grid()).label == "4.0 × 3.0 m"


def test_a_map_of_the_same_size_is_another_map() -> None:
    wall = Grid(np.zeros((60, 80), np.int8), 0.05, (-4.0, -3.0, 0.0))
    wall.cells[10, 10] = 100
    turned = Grid(np.zeros((80, 60), np.int8), 0.05, (-4.0, -3.0, 0.0))
    ids = {identify(each).id for each in (grid(), wall, turned, grid(0.1), grid(x=-3.0))}
    assert len(ids) == 5
