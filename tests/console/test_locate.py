"""A person says where the robot is: looked at beforehand, told to it, or refused with a reason."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from websockets.sync.client import ClientConnection

from kompass_console.schema.roles import Role
from tests.console.conftest import Served, cookie_of, running_stack
from tests.console.rules_client import Json, opened, until
from tests.console.scene_client import SceneClient
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

START = (-0.75, -0.6, 0.4)


def place(x: float, y: float, yaw: float | None = None) -> dict[str, float | None]:
    return {"x": x, "y": y, "yaw": yaw}


@pytest.fixture(scope="module")
def ava(console: Served) -> Iterator[httpx.Client]:
    with console.client(Role.OPERATOR, user="ava") as client:
        yield client


@pytest.fixture(scope="module")
def stack(console: Served, ava: httpx.Client) -> Iterator[None]:
    with running_stack():
        with opened(console, "/api/state", ava) as states:
            agreeing(states)
        wait_until(
            lambda: ava.post("/api/localisation", json=place(*START)).status_code == 202,
            8.0,
            "its localiser is found",
        )
        wait_until(lambda: not check(ava, **place(*START))["note"], 8.0, "its scan")
        yield


def agreeing(states: ClientConnection, lost: bool = False) -> Json:
    """The first state in which scan and map are known to agree, or not to."""

    def fits(state: Json) -> bool:
        if state["type"] != "state" or state["localisation"]["agreement"] is None:
            return False
        well = state["localisation"]["agreement"] > 0.6
        return state["localisation"]["lost"] is lost and well is not lost

    return until(states, fits, 20.0)


def check(client: httpx.Client, **body: Any) -> Json:
    answer = client.post("/api/localisation/check", json=body)
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def test_where_nobody_listens_it_is_refused(console: Served, ava: httpx.Client) -> None:
    """The first of this module, for the stack of the others listens."""
    with running_stack("--no-localiser"), opened(console, "/api/state", ava) as states:
        agreeing(states)
        refused = ava.post("/api/localisation", json=place(*START))
    assert refused.status_code == 409
    assert "Nobody listens on /initialpose" in refused.json()["detail"]["title"]


def test_a_place_is_looked_at_before_it_is_told(ava: httpx.Client, stack: None) -> None:
    there = check(ava, **place(*START))
    assert (there["ok"], there["best"], there["note"]) == (True, None, "")
    assert there["here"]["agreement"] > 0.9
    beside = check(ava, **place(START[0] + 0.2, START[1] - 0.15, START[2] + 0.2))
    best = beside["best"]
    assert best["agreement"] > beside["here"]["agreement"] + 0.05
    assert math.dist((best["x"], best["y"]), START[:2]) < 0.1
    assert check(ava, **place(0.75, 0.6), search=False)["best"] is None
    # Without a heading the robot keeps the one that it has.
    assert check(ava, **place(*START[:2]))["here"]["yaw"] == pytest.approx(START[2], abs=0.01)


@pytest.mark.parametrize(
    ("x", "y", "why"),
    [(30.0, 0.0, "outside the map"), (0.0, 0.0, "inside an obstacle"), (3.8, 0.0, "outside")],
)
def test_what_is_no_place_is_refused_with_its_reason(
    ava: httpx.Client, stack: None, x: float, y: float, why: str
) -> None:
    answer = check(ava, **place(x, y, 0.0))
    assert not answer["ok"]
    assert why in answer["message"]
    refused = ava.post("/api/localisation", json=place(x, y, 0.0))
    assert refused.status_code == 409
    assert why in refused.json()["detail"]["title"]


@pytest.mark.parametrize(
    "body", [{"x": 0.0, "y": 0.0}, place(math.inf, 0.0, 0.0), place(0.0, 0.0, 1e9)]
)
def test_a_place_that_is_not_whole_is_told_so(ava: httpx.Client, body: Json) -> None:
    text = str(body).replace("'", '"').replace("inf", "1e999").replace("None", "null")
    headers = {"Content-Type": "application/json"}
    answer = ava.post("/api/localisation", content=text, headers=headers)
    assert answer.status_code == 422
    assert set(answer.json()["detail"]) == {"title", "remedy"}


def test_a_robot_that_was_told_wrong_is_lost_until_it_is_told_right(
    console: Served, ava: httpx.Client, stack: None
) -> None:
    before = len(console.audited())
    with opened(console, "/api/state", ava) as states:
        wrong = (0.75, -0.6, 2.0)
        assert ava.post("/api/localisation", json=place(*wrong)).status_code == 202
        lost = agreeing(states, lost=True)
        assert (lost["pose"]["x"], lost["pose"]["y"]) == pytest.approx(wrong[:2], abs=1e-6)
        assert ava.post("/api/localisation", json=place(*START)).status_code == 202
        found = agreeing(states)
        assert (found["pose"]["x"], found["pose"]["y"]) == pytest.approx(START[:2], abs=1e-6)
    told = [line for line in console.audited()[before:] if line["what"] == "locate robot"]
    assert [(line["who"], line["outcome"], line["x"]) for line in told] == [
        ("ava", "told", 0.75),
        ("ava", "told", -0.75),
    ]
    assert told[0]["before"] == pytest.approx(START, abs=0.001)


def test_a_robot_on_its_way_is_told_no_other_place(
    console: Served, ava: httpx.Client, stack: None
) -> None:
    with opened(console, "/api/state", ava) as states:
        wait_until(
            lambda: ava.post("/api/goals/check", json=place(2.5, 2.0)).json()["ok"], 8.0, "a way"
        )
        ava.post("/api/goals", json=place(2.5, 2.0))
        until(states, lambda s: s["type"] == "state" and s["pose"]["v"] > 0.0)
        refused = ava.post("/api/localisation", json=place(*START))
        ava.post("/api/goals/cancel")
        until(
            states,
            lambda s: s["type"] == "state" and s["goal"] and s["goal"]["phase"] == "canceled",
        )
    assert refused.status_code == 409
    assert refused.json()["detail"] == {
        "title": "The robot is on its way to a goal.",
        "remedy": "Cancel the goal, then set its place.",
    }


def test_the_scan_is_drawn_as_it_would_lie(console: Served, ava: httpx.Client, stack: None) -> None:
    view = str(ava.post("/api/views").json()["id"])
    scene = SceneClient(console.port, view, cookie_of(ava))
    try:
        scene.look()
        wait_until(lambda: "/world/robot" in scene.nodes, 5.0, "the scene is drawn")

        def pressed() -> Json:
            # Again and again, as a page does when the console has moved its camera meanwhile.
            scene.look(position=(1.0, -5.0, 4.0), look_at=(0.75, 0.6, 0.0))
            return check(ava, view=view, start=[0.5, 0.5], end=[0.6, 0.5], search=False)

        def at(x: float, y: float) -> bool:
            here = pressed().get("here") or {"x": 0.0, "y": 0.0}
            return (here["x"], here["y"]) == pytest.approx((x, y), abs=1e-3)

        wait_until(lambda: at(0.75, 0.6), 5.0, "the camera is known")

        drawn = "/world/preview_scan"
        wait_until(lambda: scene.visible.get(drawn), 2.0, "the scan")
        assert "points" in scene.updates[drawn]
        assert scene.visible.get("/world/preview_goal")
        ava.delete(f"/api/views/{view}/preview")
        wait_until(lambda: not scene.visible[drawn], 2.0, "no scan")

        # A pillar of the map: it is crossed out.
        check(ava, **place(0.0, 0.0, 0.0), view=view)
        wait_until(lambda: scene.visible["/world/preview_refused"], 2.0, "the cross")
        assert not scene.visible["/world/preview_goal"]

        def at_the_sky() -> bool:
            scene.look(position=(1.0, -5.0, 0.5), look_at=(1.0, 0.6, 0.5))  # again, as above
            return "horizon" in check(ava, view=view, start=[0.5, 0.2])["message"]

        wait_until(at_the_sky, 2.0, "the sky")
        wait_until(lambda: not scene.visible["/world/preview_refused"], 2.0, "nothing of it")
    finally:
        scene.close()


@pytest.mark.parametrize("path", ["/api/localisation", "/api/localisation/check"])
def test_a_viewer_says_nothing_of_it(console: Served, path: str) -> None:
    with console.client(Role.VIEWER) as client:
        assert client.post(path, json=place(*START)).status_code == 403
