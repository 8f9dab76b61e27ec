"""The scene of each page: complete on connecting, private to it, and closed to everybody else."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import msgspec
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from kompass_console.scene.client_messages import allowed
from kompass_console.schema.roles import Role
from tests.console.conftest import Served, cookie_of, running_stack
from tests.console.scene_client import SceneClient, camera_message, drawn
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros


@contextmanager
def page(console: Served, client: httpx.Client, view: str, **look: object) -> Iterator[SceneClient]:
    with drawn(SceneClient(console.port, view, cookie_of(client)), **look) as scene:
        yield scene


@pytest.fixture(scope="module")
def stack(console: Served) -> Iterator[None]:
    with running_stack():
        with console.client(Role.OPERATOR) as client:
            wait_until(
                lambda: client.post("/api/goals/check", json={"x": 0.6, "y": 0.6}).json()["ok"],
                10.0,
                "the stack is there",
            )
        yield


def new_view(client: httpx.Client) -> str:
    return str(client.post("/api/views").json()["id"])


def test_nobody_gets_a_scene_without_login_or_from_another_page(console: Served) -> None:
    with console.client(Role.OPERATOR) as client:
        view, cookie = new_view(client), cookie_of(client)
    url = f"ws://127.0.0.1:{console.port}/scene/{view}"
    cases = [
        {"origin": console.origin},
        {"origin": console.origin, "additional_headers": {"Cookie": "kompass_session=a.b"}},
        {"origin": "http://evil.example", "additional_headers": {"Cookie": cookie}},
        {"additional_headers": {"Cookie": cookie}},
    ]
    for options in cases:
        with pytest.raises(InvalidStatus) as refused:
            connect(url, subprotocols=["viser-v1.1.1"], **options)  # type: ignore[arg-type]
        assert refused.value.response.status_code == 403


def test_an_unknown_view_has_no_scene(console: Served) -> None:
    with console.client(Role.OPERATOR) as client:
        assert client.get("/scene/nobody/").status_code == 404
        with pytest.raises(InvalidStatus):
            SceneClient(console.port, "nobody", cookie_of(client))


def test_the_scene_page_has_its_own_policy(console: Served) -> None:
    with console.client(Role.VIEWER) as client:
        answer = client.get(f"/scene/{new_view(client)}/")
    assert "frame-ancestors 'self'" in answer.headers["content-security-policy"]


@pytest.mark.parametrize(
    "kind",
    ["ShareUrlRequest", "GuiUpdateMessage", "FileTransferStartUpload", "SceneNodeClickMessage"],
)
def test_messages_that_are_not_a_page_s_business_are_dropped(kind: str) -> None:
    assert not allowed(msgspec.msgpack.encode({"type": kind}))
    assert allowed(msgspec.msgpack.encode(camera_message()))
    assert not allowed(b"\xc1 nonsense")
    assert not allowed(msgspec.msgpack.encode(["ViewerCameraMessage"]))


def test_what_a_page_must_not_send_changes_nothing(console: Served) -> None:
    with console.client(Role.ENGINEER) as client:
        view = new_view(client)
        with page(console, client, view) as scene:
            scene.send(type="ShareUrlRequest")
            scene.socket.send(b"\xc1 nonsense")
            client.patch(f"/api/views/{view}", json={"theme": "dark"})
            wait_until(lambda: scene.dark, 2.0, "the scene goes on")


def test_each_page_has_its_own_theme_and_layers(console: Served, stack: object) -> None:
    with console.client(Role.VIEWER) as client:
        one, other = new_view(client), new_view(client)
        with page(console, client, one) as mine, page(console, client, other) as theirs:
            change = {"theme": "dark", "layers": {"scan": False}}
            assert client.patch(f"/api/views/{one}", json=change).status_code == 200
            wait_until(lambda: mine.visible.get("/world/scan") is False, 2.0, "the scan is off")
            assert mine.dark
            assert theirs.visible["/world/scan"]
            assert not theirs.dark


def test_a_page_that_comes_late_sees_all_there_is(console: Served, stack: object) -> None:
    with console.client(Role.VIEWER) as client, page(console, client, new_view(client)) as scene:
        wait_until(lambda: "/world/map/tile0" in scene.nodes, 5.0, "the map is drawn")
        wait_until(lambda: scene.visible.get("/world/robot"), 5.0, "the robot is drawn")
        wait_until(lambda: "points" in scene.updates.get("/world/scan", {}), 5.0, "the scan")
        assert "SetCameraPositionMessage" in scene.camera


def test_what_is_measured_is_drawn_for_who_measures_and_refused_elsewhere(
    console: Served, stack: object
) -> None:
    with console.client(Role.VIEWER) as client, console.client(Role.ENGINEER) as other:
        view = new_view(client)
        with page(console, client, view, position=(0.5, -4.0, 2.5)) as scene:
            body = {"view": view, "points": [[0.0, 0.0]], "start": [0.5, 0.5]}

            def measured() -> list[list[float]]:
                points: list[list[float]] = client.post("/api/measure", json=body).json()["points"]
                return points

            wait_until(lambda: abs(measured()[1][0]) < 1e-3, 2.0, "the camera is known")
            wait_until(lambda: "/world/preview_path" in scene.nodes, 2.0, "the line is drawn")
            full = {**body, "points": [[0.0, 0.0]] * 100}
            assert "at most 100" in client.post("/api/measure", json=full).json()["problem"]
            scene.look(position=(0.5, -4.0, 0.4), look_at=(0.5, 0.0, 0.4))
            sky = {"view": view, "points": [[0.0, 0.0]], "start": [0.5, 0.1]}

            def at_the_sky() -> bool:
                answer = client.post("/api/measure", json=sky).json()
                return "horizon" in answer["problem"] and answer["points"] == [[0.0, 0.0]]

            wait_until(at_the_sky, 2.0, "that there is no floor")
        assert other.post("/api/measure", json=body).status_code == 404
        for wrong in ([[1e9, 0.0]], [[0.0, 0.0]] * 101, [["here", 0.0]]):
            answer = client.post("/api/measure", json={**body, "points": wrong})
            assert answer.status_code == 422, answer.text


def test_a_page_that_lost_its_connection_keeps_its_camera(console: Served) -> None:
    with console.client(Role.VIEWER) as client:
        view = new_view(client)
        mine = (0.5, -4.0, 2.5)
        with page(console, client, view) as scene:
            scene.look(position=mine)
            # The camera has been taken in when a pick answers from it.
            check = {"view": view, "start": [0.5, 0.5]}
            wait_until(
                lambda: abs(client.post("/api/goals/check", json=check).json()["x"]) < 1e-6,
                2.0,
                "the camera is known",
            )
        with page(console, client, view, position=mine) as scene:
            client.patch(f"/api/views/{view}", json={"layers": {"trail": False}})
            wait_until(lambda: scene.visible.get("/world/trail") is not True, 2.0, "an answer")
            assert "SetCameraPositionMessage" not in scene.camera
        with page(console, client, view, position=(9.0, 9.0, 9.0)) as scene:
            wait_until(lambda: "SetCameraPositionMessage" in scene.camera, 2.0, "a new page")


def test_a_press_means_the_floor_under_it(console: Served, stack: object) -> None:
    with console.client(Role.OPERATOR) as client:
        view = new_view(client)
        with page(console, client, view) as scene:
            scene.look(position=(1.0, -5.0, 4.0), look_at=(1.0, 0.6, 0.0))

            def centre() -> dict[str, object]:
                body = {"view": view, "start": [0.5, 0.5], "end": [0.6, 0.5]}
                answer: dict[str, object] = client.post("/api/goals/check", json=body).json()
                return answer

            wait_until(lambda: centre()["x"] == pytest.approx(1.0, abs=1e-3), 2.0, "the camera")
            answer = centre()
            assert answer["y"] == pytest.approx(0.6, abs=1e-3)
            assert answer["yaw"] == pytest.approx(0.0, abs=1e-2)  # the drag went east
            # Answers of before the camera was there have been drawn, too.
            wait_until(
                lambda: (
                    scene.visible.get("/world/preview_goal")
                    and scene.positions["/world/preview_goal"][:2]
                    == pytest.approx((1.0, 0.6), abs=1e-3)
                ),
                2.0,
                "the preview",
            )
            client.delete(f"/api/views/{view}/preview")
            wait_until(lambda: not scene.visible["/world/preview_goal"], 2.0, "no preview")

            # Outside of the room: the place itself is crossed out, and the nearest has the ring.
            client.post("/api/goals/check", json={"x": 1.0, "y": 9.0, "view": view})
            wait_until(lambda: scene.visible.get("/world/preview_refused"), 2.0, "the cross")
            wait_until(lambda: scene.visible["/world/preview_goal"], 2.0, "the ring")
            assert scene.positions["/world/preview_refused"][:2] == pytest.approx((1.0, 9.0))
            assert scene.positions["/world/preview_goal"][1] < 2.4

            def at_the_sky() -> bool:
                # Again and again, as a page does when the console has moved its camera meanwhile.
                scene.look(position=(1.0, -5.0, 0.5), look_at=(1.0, 0.6, 0.5))
                high = {"view": view, "start": [0.5, 0.2]}
                answer = client.post("/api/goals/check", json=high).json()
                return bool(answer["reason"] == "above_horizon")

            wait_until(at_the_sky, 2.0, "the sky is not the floor")
            wait_until(
                lambda: not scene.visible["/world/preview_refused"],
                2.0,
                "no mark of the pick before",
            )


def test_following_moves_the_world_and_not_the_camera(console: Served, stack: object) -> None:
    with console.client(Role.OPERATOR) as client:
        view = new_view(client)
        with page(console, client, view) as scene:
            wait_until(lambda: scene.visible.get("/world/robot"), 5.0, "the robot is drawn")
            client.patch(f"/api/views/{view}", json={"follow": True})
            before = scene.positions["/world/robot"]
            wait_until(
                lambda: (
                    scene.camera.get("SetCameraLookAtMessage", ())[:2]
                    == pytest.approx(before[:2], abs=1e-3)
                ),
                2.0,
                "the robot is centred",
            )
            camera = dict(scene.camera)
            goal = {"x": before[0] + 0.4, "y": before[1], "yaw": None}
            assert client.post("/api/goals", json=goal).status_code == 200
            wait_until(
                lambda: scene.positions["/world/robot"][0] > before[0] + 0.35, 5.0, "it drives"
            )
            wait_until(
                lambda: (
                    abs(
                        scene.positions["/world"][0]
                        + scene.positions["/world/robot"][0]
                        - before[0]
                    )
                    < 1e-3
                ),
                2.0,
                "the robot stays where it was on the page",
            )
            assert scene.camera == camera
            # A press in the middle means the robot's place on the map, not on the page.
            scene.look(
                position=camera["SetCameraPositionMessage"],  # type: ignore[arg-type]
                look_at=camera["SetCameraLookAtMessage"],  # type: ignore[arg-type]
            )
            middle = {"view": view, "start": [0.5, 0.5]}

            def picked() -> tuple[float, float]:
                answer = client.post("/api/goals/check", json=middle).json()
                return answer["x"], answer["y"]

            wait_until(
                lambda: picked() == pytest.approx(scene.positions["/world/robot"][:2], abs=0.01),
                2.0,
                "the place",
            )


def test_the_scene_comes_back_after_a_broken_connection(console: Served) -> None:
    with console.client(Role.VIEWER) as client:
        view = new_view(client)
        with page(console, client, view) as scene:
            scene.socket.close()
            with pytest.raises(ConnectionClosed):
                scene.send(type="ViewerCameraMessage")
        with page(console, client, view):
            pass
