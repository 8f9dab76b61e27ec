"""The flat map: what a page that draws it by itself is told, and how much that is."""

from __future__ import annotations

import io
import json
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

from kompass.algorithms.grid import Grid
from kompass_console.api.goals import preview_of
from kompass_console.link.goal_check import Checked
from kompass_console.scene.drawings import Drawings
from kompass_console.scene.flat_map import FlatMap
from kompass_console.scene.layers.local_map import local_map_drawing
from kompass_console.scene.layers.map import map_drawing, whole_picture
from kompass_console.scene.layers.palette import palette
from kompass_console.scene.layers.path import path_segments
from kompass_console.scene.layers.trail import Trail
from kompass_console.schema.models import GoalCheck, PointXY
from kompass_console.schema.roles import Role
from kompass_console.schema.world import GoalMark, HindranceMark, Pose
from tests.console.conftest import Served, cookie_of, running_stack
from tests.support.processes import wait_until


def test_the_picture_has_a_pixel_for_each_cell_and_north_up() -> None:
    cells = np.array([[100, 0, 0], [-1, 0, 0]], np.int8)  # row 0 is the south
    picture = whole_picture(map_drawing(Grid(cells, 0.5, (0.0, 0.0, 0.0))), "dark")
    pixels = np.array(Image.open(io.BytesIO(picture)).convert("RGB"))
    assert pixels.shape == (2, 3, 3)
    colours = palette("dark")
    assert tuple(pixels[1, 0]) == colours.occupied
    assert tuple(pixels[0, 0]) == colours.unknown
    assert tuple(pixels[0, 2]) == colours.free


def test_a_page_is_told_where_something_is_in_the_way_and_that_it_is_gone() -> None:
    drawings = Drawings()
    flat = FlatMap(drawings, lambda: None)
    flat.news()
    drawings.hindrance = HindranceMark(1.2, 0.45, "In the way: a box.")
    told = flat.news().hindrance
    assert told is not None
    assert (told.x, told.y) == (1.2, 0.45)
    drawings.hindrance = None
    gone = flat.news()
    assert "hindrance" in gone.model_fields_set
    assert gone.hindrance is None


def test_a_page_is_told_everything_once_and_then_what_has_changed() -> None:
    cells = np.zeros((20, 40), np.int8)
    cells[3, 4:6] = 100
    drawings = Drawings()
    drawings.map = map_drawing(Grid(cells, 0.1, (-1.0, -2.0, 0.0)), 7)
    drawings.local_map = local_map_drawing(Grid(cells, 0.1, (1.0, 2.0, 0.5)))
    drawings.path = path_segments(np.array([[0.0, 0.0], [1.0, 0.5], [2.0, 0.5]]))
    drawings.scan = np.array([[1.234, 0.5, 0.1]], np.float32)
    drawings.goal = GoalMark(1.0, 2.0, None, active=True)
    flat = FlatMap(drawings, lambda: None)

    first = flat.news()
    assert first.map is not None
    assert (first.map.version, first.map.width, first.map.height) == (7, 40, 20)
    assert (first.map.x, first.map.y, first.map.resolution) == (-1.0, -2.0, 0.1)
    assert first.local_map is not None
    assert first.local_map.areas == [0.4, 0.3, 0.6, 0.4]
    assert first.path == [0.0, 0.0, 1.0, 0.5, 2.0, 0.5]
    assert first.scan == [1.23, 0.5]
    assert first.goal is not None
    assert (first.goal.x, first.goal.y, first.goal.yaw) == (1.0, 2.0, None)

    assert flat.news().model_fields_set == set()
    drawings.scan = np.zeros((0, 3), np.float32)
    drawings.goal = None
    then = flat.news()
    assert then.model_fields_set == {"scan", "goal"}
    assert (then.scan, then.goal) == ([], None)
    late = FlatMap(drawings, lambda: None).news()
    assert late.path == first.path


def test_a_short_trail_is_the_points_that_were_driven() -> None:
    trail = Trail()
    for x in (0.0, 0.1, 0.2):
        trail.add(Pose(x, 0.0, 0.0), x)
    drawings = Drawings(trail=trail.segments())
    assert FlatMap(drawings, lambda: None).news().trail == [0.0, 0.0, 0.1, 0.0, 0.2, 0.0]


def test_of_a_refused_goal_the_place_and_the_nearest_one_are_marked() -> None:
    check = GoalCheck(ok=True, x=1.0, y=2.0, yaw=0.5, reason="", message="")
    way = np.array([[0.0, 0.0], [1.0, 2.0]])
    fine = preview_of(Checked(check, way, "/goal_pose"))
    assert fine.mark == GoalMark(1.0, 2.0, 0.5, active=False)
    assert fine.refused is None

    refused = check.model_copy(
        update={"ok": False, "reason": "occupied", "nearest": PointXY(x=3.0, y=4.0)}
    )
    shown = preview_of(Checked(refused, way, "/goal_pose"))
    assert shown.refused == (1.0, 2.0)
    assert shown.mark == GoalMark(3.0, 4.0, 0.5, active=False)
    assert len(shown.path) == 0
    nowhere = preview_of(Checked(refused.model_copy(update={"nearest": None}), way, None))
    assert nowhere.mark is None
    assert replace(shown, mark=None).refused == nowhere.refused


@pytest.mark.ros
def test_a_viewer_gets_map_and_scan_and_nobody_else_does(console: Served) -> None:
    url = f"ws://127.0.0.1:{console.port}/api/map/live"
    with console.client() as stranger:
        assert stranger.get("/api/map/1?theme=light").status_code == 401
    with pytest.raises(InvalidStatus):
        connect(url, origin=console.origin)
    with running_stack(), console.client(Role.VIEWER) as viewer:
        headers = {"Cookie": cookie_of(viewer)}
        with pytest.raises(InvalidStatus):
            connect(url, origin="http://evil.example", additional_headers=headers)
        with connect(url, origin=console.origin, additional_headers=headers) as live:
            world = heard(live, {"map", "scan"})
        version, info = world["map"]["version"], world["map"]
        answer = viewer.get(f"/api/map/{version}?theme=dark")
        assert answer.headers["content-type"] == "image/webp"
        assert Image.open(io.BytesIO(answer.content)).size == (info["width"], info["height"])
        gone = viewer.get(f"/api/map/{version + 1000}?theme=dark")
        assert gone.status_code == 404
        assert gone.json()["detail"]["remedy"]
        assert viewer.get(f"/api/map/{version}?theme=pink").status_code == 422


def heard(live: ClientConnection, layers: set[str]) -> dict[str, dict[str, int]]:
    """What was told, as soon as these layers are there."""
    world: dict[str, dict[str, int]] = {}

    def whole() -> bool:
        world.update(json.loads(live.recv(timeout=15.0)))
        return all(world.get(layer) for layer in layers)

    wait_until(whole, 20.0, f"{layers} are told")
    return world
