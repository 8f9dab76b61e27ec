"""A camera on a page: found by type, read while somebody looks, the newest picture or none."""

from __future__ import annotations

import base64
import io
import json
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from PIL import Image as Pil
from sensor_msgs.msg import CompressedImage, Image
from websockets.sync.client import ClientConnection

from kompass_console.link.on_demand.cameras import MOST_READ
from kompass_console.schema.roles import Role
from tests.console.conftest import Served
from tests.console.looking import socket_of
from tests.console.test_link import State, listening, until
from tests.console.test_pictures import filled, image
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.robot import Robot

pytestmark = pytest.mark.ros


@pytest.fixture
def robot(domain: int) -> Iterator[Robot]:
    robot = Robot(domain)
    yield robot
    robot.close()


@pytest.fixture
def client(console: Served) -> Iterator[httpx.Client]:
    with console.client(Role.VIEWER) as client:
        yield client


def is_there(state: State, topic: str) -> bool:
    return any(each["topic"] == topic for each in state["cameras"])


def told(socket: ClientConnection, good: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
    """The first news of a camera that fits; all before it are acknowledged, and this one not."""
    deadline = time.monotonic() + patient(8.0)
    while time.monotonic() < deadline:
        news: dict[str, Any] = json.loads(socket.recv(timeout=patient(3.0)))
        if good(news):
            return news
        socket.send("seen")
    raise AssertionError("no such news")


def colour_of(news: dict[str, Any]) -> list[int]:
    """In the middle of the picture."""
    kind, _, data = news["picture"].partition(";base64,")
    assert kind == "data:image/jpeg"
    pixels = np.array(Pil.open(io.BytesIO(base64.b64decode(data))).convert("RGB"))
    return [int(part) for part in pixels[pixels.shape[0] // 2, pixels.shape[1] // 2]]


def test_a_camera_is_read_while_somebody_looks_and_shows_the_newest_picture(
    console: Served, client: httpx.Client, robot: Robot
) -> None:
    publisher = robot.node.create_publisher(Image, "/front/image", 5)
    colour = [200, 40, 40]
    timer = robot.node.create_timer(
        0.05, lambda: publisher.publish(image("rgb8", filled(tuple(colour), 480, 640)))
    )
    with listening(console, client) as states:
        until(states, lambda state: is_there(state, "/front/image"))
    assert publisher.get_subscription_count() == 0
    with socket_of(console, client, "/api/camera?topic=/front/image") as socket:
        news = told(socket, lambda news: news["picture"])
        assert (news["width"], news["height"], news["problem"]) == (640, 480, "")
        assert news["age"] < patient(1.0)
        np.testing.assert_allclose(colour_of(news), (200, 40, 40), atol=8)
        with socket_of(console, client, "/api/camera?topic=/front/image&size=large") as larger:
            assert told(larger, lambda news: news["picture"])
            assert publisher.get_subscription_count() == 1
        colour[:] = [20, 180, 60]
        socket.send("seen")
        told(socket, lambda n: n["picture"] and np.allclose(colour_of(n), (20, 180, 60), atol=8))
        # Its cable is pulled: the page hears how old the last picture has become.
        robot.do(timer.cancel)
        socket.send("seen")
        told(socket, lambda news: not news["picture"] and (news["age"] or 0.0) > 2.0)
    wait_until(lambda: publisher.get_subscription_count() == 0, 5.0, "nobody reads it")


def test_who_does_not_say_that_a_picture_came_is_sent_no_other(
    console: Served, client: httpx.Client, robot: Robot
) -> None:
    publisher = robot.node.create_publisher(Image, "/slow/image", 5)
    robot.node.create_timer(0.05, lambda: publisher.publish(image("rgb8", filled((9, 9, 9)))))
    with (
        socket_of(console, client, "/api/camera?topic=/slow/image") as slow,
        socket_of(console, client, "/api/camera?topic=/slow/image") as quick,
    ):
        first = told(slow, lambda news: news["picture"])
        for _ in range(8):
            last = told(quick, lambda news: news["picture"])
            quick.send("seen")
        with pytest.raises(TimeoutError):
            slow.recv(timeout=0.1)
        slow.send("seen")
        then = told(slow, lambda news: news["picture"])
        assert then["number"] >= last["number"] > first["number"] + 1


def test_what_cannot_be_shown_is_said_and_the_next_good_picture_is_shown(
    console: Served, client: httpx.Client, robot: Robot
) -> None:
    publisher = robot.node.create_publisher(CompressedImage, "/back/compressed", 5)
    sent = [CompressedImage(format="jpeg", data=b"<script>alert(1)</script>")]
    robot.node.create_timer(0.1, lambda: publisher.publish(sent[0]))
    with socket_of(console, client, "/api/camera?topic=/back/compressed") as socket:
        problem = told(socket, lambda news: "JPEG" in news["problem"])
        assert problem["picture"] == ""
        assert problem["problem"] == (
            "The picture is not shown: format = 'jpeg': its bytes are no whole JPEG or PNG; have "
            "the camera send one."
        )
        good = io.BytesIO()
        Pil.new("RGB", (64, 48), (30, 60, 200)).save(good, "JPEG", quality=95)
        sent[0] = CompressedImage(format="jpeg", data=good.getvalue())
        news = told(socket, lambda news: news["picture"])
        assert base64.b64decode(news["picture"].partition(",")[2]) == good.getvalue()


def test_a_camera_that_is_not_there_is_waited_for(
    console: Served, client: httpx.Client, robot: Robot
) -> None:
    with socket_of(console, client, "/api/camera?topic=/late/image") as socket:
        news = told(socket, lambda news: news["problem"])
        assert news["problem"] == "/late/image shows no pictures now; choose another camera."
        publisher = robot.node.create_publisher(Image, "/late/image", 5)
        robot.node.create_timer(0.1, lambda: publisher.publish(image("mono8", filled((80,)))))
        told(socket, lambda news: news["picture"])


def test_so_many_cameras_are_looked_at_on_all_pages_and_no_more(
    console: Served, client: httpx.Client, robot: Robot
) -> None:
    names = [f"/many/image{number}" for number in range(MOST_READ + 1)]
    for name in names:
        robot.node.create_publisher(Image, name, 5)
    with listening(console, client) as states:
        until(states, lambda state: all(is_there(state, name) for name in names))
    with ExitStack() as open_sockets:
        sockets = [
            open_sockets.enter_context(socket_of(console, client, f"/api/camera?topic={name}"))
            for name in names[:-1]
        ]
        for socket in sockets:
            told(socket, lambda news: news["problem"] == "")
        last = open_sockets.enter_context(
            socket_of(console, client, f"/api/camera?topic={names[-1]}")
        )
        refused = told(last, lambda news: news["problem"])["problem"]
        assert refused.startswith(f"{MOST_READ} cameras are looked at on all pages; close one")
        sockets[0].close()
        told(last, lambda news: news["problem"] == "")


def test_no_picture_is_kept_on_the_disk_or_told_to_who_is_not_logged_in(
    console: Served, client: httpx.Client, robot: Robot
) -> None:
    publisher = robot.node.create_publisher(Image, "/private/image", 5)
    robot.node.create_timer(0.1, lambda: publisher.publish(image("mono8", filled((80,)))))

    def files() -> set[Path]:
        # The audit log writes where it ends under a name that comes and goes.
        there = console.audit_folder.parent.rglob("*")
        return {path for path in there if path.is_file() and path.name != ".end.json"}

    before = files()
    with socket_of(console, client, "/api/camera?topic=/private/image") as socket:
        told(socket, lambda news: news["picture"])
    assert files() == before
    assert client.get("/api/camera?topic=/private/image").status_code == 404
