"""The map of a large building: few bytes to a page, however it is drawn."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kompass.algorithms.grid import Grid
from kompass_console.scene.layers.map import map_drawing, whole_picture
from kompass_console.schema.roles import Role
from tests.console.conftest import Served, cookie_of, running_stack, serving
from tests.console.fake_stack import building
from tests.console.scene_client import SceneClient, drawn
from tests.support.processes import wait_until

MOST = 60_000  # bytes


def test_the_flat_map_of_a_large_building_is_small_enough_for_a_tablet() -> None:
    drawing = map_drawing(Grid(building(1674, 1006), 0.05, (0.0, 0.0, 0.0)))
    assert len(whole_picture(drawing, "light")) <= MOST


@contextmanager
def drawn_scene(own: Served, **settings: object) -> Iterator[SceneClient]:
    """A page's scene that is drawn, of a console that nobody else looks at."""
    with own.client(Role.VIEWER) as client:
        view = client.post("/api/views").json()["id"]
        client.patch(f"/api/views/{view}", json=settings)
        with drawn(SceneClient(own.port, view, cookie_of(client))) as scene:
            yield scene


@pytest.mark.ros
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_floor_and_the_walls_of_a_large_building_are_few_bytes_on_the_wire(
    tmp_path: Path, domain: int, theme: str
) -> None:
    layers = {"scan": False, "local_map": False}
    with (
        serving(tmp_path / "audit", domain) as own,
        drawn_scene(own, theme=theme, layers=layers) as scene,
    ):
        before = scene.wire.received - scene.without_map
        with running_stack("--large"):
            wait_until(lambda: "/world/map/walls" in scene.nodes, 30.0, "the walls are drawn")
        received = scene.wire.received - scene.without_map - before
    assert {"/world/map/tile0", "/world/map/tile1"} <= scene.nodes
    assert 20_000 < received <= MOST


@pytest.mark.ros
def test_the_walls_of_a_map_that_grows_stay_and_all_of_them_have_a_colour(
    tmp_path: Path, domain: int
) -> None:
    # A page gives new boxes the colour that it is told with them, and no other.
    of_each_box = {"batched_positions", "batched_scales", "batched_wxyzs", "batched_colors"}
    walls = "/world/map/walls"
    with serving(tmp_path / "audit", domain) as own, drawn_scene(own) as scene:
        with running_stack():
            wait_until(lambda: walls in scene.nodes, 30.0, "the walls are drawn")
        with running_stack("--large"):
            wait_until(lambda: scene.updates.get(walls), 30.0, "other walls are drawn")
    assert of_each_box <= set(scene.updates[walls])
    assert walls not in scene.removed


def test_a_map_that_is_longer_than_any_picture_of_the_usual_kind_has_a_picture() -> None:
    drawing = map_drawing(Grid(np.zeros((1, 20_000), np.int8), 0.05))
    picture = Image.open(io.BytesIO(whole_picture(drawing, "light")))
    assert picture.size == (20_000, 1)
