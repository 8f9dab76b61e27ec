"""The maps that ship are the worlds that the physics collides with."""

from pathlib import Path

import numpy as np
import pytest

from kompass.algorithms.map_file import load_map
from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.make_maps import ALIASES, MAPS_FOLDER, make_maps
from kompass.simulation.worlds.rasterize import rasterize
from kompass.simulation.worlds.registry import world, world_names

HALF_DIAGONAL = 0.5 * 2**0.5


def test_committed_map_files_are_what_the_geometry_gives(tmp_path: Path) -> None:
    written = make_maps(tmp_path)
    assert {path.stem for path in written} == {*world_names(), *ALIASES}
    for path in written:
        for suffix in (".yaml", ".pgm"):
            fresh, committed = path.with_suffix(suffix), MAPS_FOLDER / f"{path.stem}{suffix}"
            assert fresh.read_bytes() == committed.read_bytes(), (
                f"{committed.name} is out of date: python -m kompass.simulation.worlds.make_maps"
            )


@pytest.mark.parametrize("name", world_names())
def test_saved_map_reads_back_as_the_rasterised_world(name: str) -> None:
    committed, fresh = load_map(MAPS_FOLDER / f"{name}.yaml"), rasterize(world(name))
    np.testing.assert_array_equal(committed.cells, fresh.cells)
    assert committed.resolution == fresh.resolution == 0.05
    assert committed.origin == fresh.origin


def test_recipes_for_the_webots_robot_find_the_hexagon() -> None:
    webots, hexagon = (
        load_map(MAPS_FOLDER / f"{name}.yaml") for name in ("turtlebot3_webots", "hexagon")
    )
    np.testing.assert_array_equal(webots.cells, hexagon.cells)


@pytest.mark.parametrize("resolution", [0.02, 0.05, 0.1])
@pytest.mark.parametrize("name", world_names())
def test_cells_tell_solid_from_free_from_outside(name: str, resolution: float) -> None:
    place = world(name)
    grid = rasterize(place, resolution)
    min_x, min_y, max_x, max_y = place.bounds
    points = np.random.default_rng(5).uniform((min_x, min_y), (max_x, max_y), (50_000, 2))
    column, row = grid.world_to_cell(points).T
    cells = grid.cells[row, column]
    distance, on_floor = place.distance(points), place.on_floor(points)
    # A point may lie half a diagonal from the centre that decides for its cell.
    assert np.all(cells[distance < (0.5 - HALF_DIAGONAL) * resolution] == 100)
    clear = distance > (0.5 + HALF_DIAGONAL) * resolution
    assert np.all(cells[clear & on_floor] == 0)
    assert np.all(cells[clear & ~on_floor] == -1)


@pytest.mark.parametrize("name", world_names())
def test_walls_seen_by_the_lidar_are_on_the_map(name: str) -> None:
    place = world(name)
    grid = rasterize(place)
    robot = SimulatedRobot(place)
    x, y, yaw = robot.truth().pose
    ranges = robot.scan().astype(float)
    bearing = yaw + np.arange(360) * np.radians(1.0)
    seen = np.isfinite(ranges)
    assert seen.sum() > 60
    ends = np.array([x, y]) + (ranges * np.array([np.cos(bearing), np.sin(bearing)])).T[seen]
    occupied = grid.cell_to_world(np.argwhere(grid.occupied())[:, ::-1])
    to_nearest = np.linalg.norm(ends[:, None] - occupied[None], axis=2).min(axis=1)
    assert to_nearest.max() < grid.resolution


@pytest.mark.parametrize("resolution", [0.0, -0.05, float("nan")])
def test_impossible_resolution_is_refused(resolution: float) -> None:
    with pytest.raises(ValueError, match=r"resolution is .*; give a finite length above 0"):
        rasterize(world("hexagon"), resolution)
