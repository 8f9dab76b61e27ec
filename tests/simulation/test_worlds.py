"""A world is found by name, and one that nobody could drive in is refused."""

import itertools
import math
from typing import Any

import numpy as np
import pytest

from kompass.simulation.worlds.registry import world, world_names
from kompass.simulation.worlds.shapes import Box, Cylinder
from kompass.simulation.worlds.world import World

SQUARE = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0))


def build(**changes: Any) -> World:
    fields: dict[str, Any] = {
        "name": "test",
        "title": "Test",
        "floor": SQUARE,
        "start": (1.0, 1.0, 0.0),
        "obstacles": (),
    }
    return World(**(fields | changes))


def test_unknown_world_is_refused_with_the_names_there_are() -> None:
    with pytest.raises(ValueError, match=r"'moon'.*hexagon, apartment, warehouse, depot"):
        world("moon")


def test_hexagon_has_nine_pillars_on_a_grid_and_walls_4_8_m_apart() -> None:
    hexagon = world("hexagon")
    pillars = [shape for shape in hexagon.obstacles if isinstance(shape, Cylinder)]
    places = {tuple(round(value, 6) for value in pillar.center) for pillar in pillars}
    assert places == {(x, y) for x in (-1.1, 0.0, 1.1) for y in (-1.1, 0.0, 1.1)}
    assert {pillar.radius for pillar in pillars} == {0.15}
    directions = np.radians(np.arange(30, 360, 60))
    middles = 2.4 * np.stack([np.cos(directions), np.sin(directions)], axis=1)
    walls = np.min([wall.distance(middles) for wall in hexagon.walls], axis=0)
    np.testing.assert_allclose(walls, 0.0, atol=1e-9)


@pytest.mark.parametrize("name", world_names())
def test_outer_wall_has_no_gap(name: str) -> None:
    place = world(name)
    corners = np.array([*place.floor, place.floor[0]])
    share = np.linspace(0.0, 1.0, 2000)[:, None]
    for start, end in itertools.pairwise(corners):
        # Just outside the floor, all along this side and round its corners.
        along = start + share * (end - start)
        normal = np.array([end[1] - start[1], start[0] - end[0]]) / math.dist(start, end)
        assert np.all(place.distance(along + 0.5 * place.wall_thickness * normal) <= 0.0)


def test_wall_of_an_l_shaped_floor_stays_off_the_floor() -> None:
    floor = ((0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 2.0), (2.0, 4.0), (0.0, 4.0))
    place = build(floor=floor)
    inside = np.random.default_rng(1).uniform(0.0, 4.0, (20_000, 2))
    inside = inside[place.on_floor(inside)]
    assert np.all(place.distance(inside) >= 0.0)
    notch = np.array([[3.0, 3.0], [2.05, 2.05]])
    assert not place.on_floor(notch).any()


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"floor": SQUARE[:2]}, "floor has 2 corners; give at least 3"),
        ({"floor": SQUARE[::-1]}, "floor runs clockwise.*anticlockwise"),
        ({"start": (5.0, 1.0, 0.0)}, "start .* is off the floor"),
        ({"start": (0.1, 1.0, 0.0)}, "start .* is 0.100 m from 'wall_3'; keep it 0.15 m away"),
        ({"obstacles": (Cylinder("a", (1.2, 1.0), 0.1),)}, "is 0.100 m from 'a'"),
        (
            {"obstacles": (Cylinder("a", (3.0, 3.0), 0.1), Box("a", (2.0, 3.0), (0.1, 0.1)))},
            "two shapes are called 'a'; rename",
        ),
    ],
)
def test_impossible_world_is_refused_with_the_reason(
    changes: dict[str, Any], complaint: str
) -> None:
    with pytest.raises(ValueError, match=complaint):
        build(**changes)


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_shape_without_extent_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match=r"cylinder 'c': radius is .*above 0"):
        Cylinder("c", (0.0, 0.0), value)
    with pytest.raises(ValueError, match=r"box 'b': size\[1\] is .*above 0"):
        Box("b", (0.0, 0.0), (1.0, value))


def test_distance_to_a_turned_box_is_measured_from_its_faces() -> None:
    box = Box("b", (1.0, 2.0), (2.0, 1.0), yaw=math.pi / 2)
    points = np.array([[1.0, 2.0], [1.0, 3.5], [2.0, 2.0], [2.0, 4.0]])
    expected = [-0.5, 0.5, 0.5, math.hypot(0.5, 1.0)]
    np.testing.assert_allclose(box.distance(points), expected, atol=1e-12)
