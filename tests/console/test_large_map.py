"""The map of a large building: few bytes to a page, however it is drawn."""

from __future__ import annotations

from pathlib import Path

import pytest

from kompass.algorithms.grid import Grid
from kompass_console.scene.layers.map import map_drawing, whole_picture
from kompass_console.schema.roles import Role
from tests.console.conftest import cookie_of, running_stack, serving
from tests.console.fake_stack import building
from tests.console.scene_client import SceneClient
from tests.support.processes import wait_until

MOST = 60_000  # bytes


def test_the_flat_map_of_a_large_building_is_small_enough_for_a_tablet() -> None:
    drawing = map_drawing(Grid(building(1674, 1006), 0.05, (0.0, 0.0, 0.0)))
    assert len(whole_picture(drawing, "light")) <= MOST


@pytest.mark.ros
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_floor_and_the_walls_of_a_large_building_are_few_bytes_on_the_wire(
    tmp_path: Path, domain: int, theme: str
) -> None:
    with serving(tmp_path / "audit", domain) as own, own.client(Role.VIEWER) as client:
        view = client.post("/api/views").json()["id"]
        only = {"scan": False, "local_map": False}
        client.patch(f"/api/views/{view}", json={"theme": theme, "layers": only})
        scene = SceneClient(own.port, view, cookie_of(client))
        try:
            scene.look()
            wait_until(lambda: "/world/robot" in scene.nodes, 5.0, "the scene is drawn")
            before = scene.wire.received
            with running_stack("--large"):
                wait_until(lambda: "/world/map/walls" in scene.nodes, 30.0, "the walls are drawn")
            received = scene.wire.received - before
        finally:
            scene.close()
    assert {"/world/map/tile0", "/world/map/tile1"} <= scene.nodes
    assert 20_000 < received <= MOST, "the map, and with it the robot's body"
