"""Places over the console: who may, what is kept, who sees it, and where nobody is sent."""

from __future__ import annotations

import concurrent.futures
import contextlib
import signal
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from nav_msgs.msg import OccupancyGrid

from kompass.store.place_store import PlaceStore
from kompass_console.schema.roles import Role
from tests.console.conftest import Served, running, running_stack, serving
from tests.console.fake_stack import ORIGIN, RESOLUTION, world_map
from tests.console.rules_client import Json, await_monitor, opened, until
from tests.support.domains import give_back, next_domain
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot

pytestmark = pytest.mark.ros

DOCK = {"name": "Dock", "pose": {"x": 0.6, "y": 0.6, "yaw": 1.0}}
CHANGES: list[tuple[str, str, Json]] = [
    ("POST", "/api/places", DOCK),
    ("PATCH", "/api/places/1", {"version": 1, "name": "Door"}),
    ("DELETE", "/api/places/1?version=1", {}),
    ("POST", "/api/places/1/restore", {}),
    ("POST", "/api/goals", {"place": 1, "version": 1}),
]


@pytest.fixture(scope="module")
def stack() -> Iterator[object]:
    with running_stack() as process:
        yield process


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("robot")


@contextlib.contextmanager
def monitor_in(folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    with running("tests.console.fake_monitor", str(folder)) as process:
        yield process


@pytest.fixture(scope="module")
def robot(console: Served, stack: object, folder: Path) -> Iterator[Served]:
    """The console beside a monitor and a stack that has told its map."""
    with monitor_in(folder), console.client(Role.VIEWER) as client:
        await_monitor(client)
        wait_until(lambda: listed(client)["available"], 10.0, "the places are told")
        wait_until(lambda: listed(client)["map"], 10.0, "the map is there")
        yield console


@pytest.fixture
def ava(robot: Served) -> Iterator[httpx.Client]:
    """An operator, and no places."""
    with robot.client(Role.OPERATOR, user="ava") as client:
        for place in listed(client)["places"]:
            remove(client, place)
        wait_until(lambda: not listed(client)["places"], 5.0, "no places")
        yield client


@pytest.fixture
def ben(robot: Served) -> Iterator[httpx.Client]:
    with robot.client(Role.OPERATOR, user="ben") as client:
        yield client


def listed(client: httpx.Client) -> Json:
    answer = client.get("/api/places")
    assert answer.status_code == 200, answer.text
    found: Json = answer.json()
    return found


def names(client: httpx.Client) -> list[str]:
    return [place["name"] for place in listed(client)["places"]]


def save(client: httpx.Client, **more: Any) -> Json:
    answer = client.post("/api/places", json={**DOCK, **more})
    assert answer.status_code == 201, answer.text
    place: Json = answer.json()
    wait_until(
        lambda: any(each["id"] == place["id"] for each in listed(client)["places"]),
        5.0,
        "the place is told",
    )
    return place


def edit(client: httpx.Client, place: Json, **change: Any) -> httpx.Response:
    body = {"version": place["version"], **change}
    return client.patch(f"/api/places/{place['id']}", json=body)


def remove(client: httpx.Client, place: Json) -> httpx.Response:
    return client.delete(f"/api/places/{place['id']}", params={"version": place["version"]})


def refused(answer: httpx.Response, status: int, *parts: str) -> None:
    assert answer.status_code == status, answer.text
    detail = answer.json()["detail"]
    said = f"{detail['title']} {detail['remedy']}"
    assert all(part in said for part in parts), said


@pytest.mark.parametrize(("method", "path", "body"), CHANGES, ids=lambda one: str(one)[:30])
def test_a_viewer_sees_places_and_changes_none(
    robot: Served, ava: httpx.Client, method: str, path: str, body: Json
) -> None:
    save(ava)
    with robot.client(Role.VIEWER) as viewer:
        assert names(viewer) == ["Dock"]
        refused(viewer.request(method, path, json=body), 403, "this takes an operator")
        assert names(viewer) == ["Dock"]
    with robot.client() as stranger:
        assert stranger.get("/api/places").status_code == 401
        assert stranger.request(method, path, json=body).status_code == 401


def test_another_site_changes_nothing(ava: httpx.Client) -> None:
    for method, path, body in CHANGES:
        answer = ava.request(method, path, json=body, headers={"Origin": "https://evil.example"})
        assert answer.status_code == 403, answer.text
    assert names(ava) == []


def test_what_one_saves_another_sees_at_once_and_by_whom(
    robot: Served, ava: httpx.Client, ben: httpx.Client
) -> None:
    with opened(robot, "/api/state", ben) as socket:
        before = until(socket, lambda m: m["type"] == "state")["places"]["revision"]
        place = save(ava, note="mind the step")
        until(socket, lambda m: m["type"] == "state" and m["places"]["revision"] > before)
    [seen] = listed(ben)["places"]
    assert {**seen, "warning": ""} == place
    assert (seen["author"], seen["note"], seen["here"], seen["version"]) == (
        *("ava", "mind the step", True),
        1,
    )


def test_where_the_robot_stands_is_saved_without_giving_a_pose(
    robot: Served, ava: httpx.Client
) -> None:
    with opened(robot, "/api/state", ava) as socket:
        stands = until(socket, lambda m: m["type"] == "state" and m["pose"] is not None)["pose"]
    place = save(ava, name="Here", pose=None)
    for key in ("x", "y", "yaw"):
        assert place["pose"][key] == pytest.approx(stands[key], abs=0.05)
    there = save(ava, name="There", pose={"x": 1.0, "y": 0.6})
    moved = edit(ava, there, to_robot=True).json()
    assert (moved["name"], moved["version"]) == ("There", 2)
    assert moved["pose"] == pytest.approx(place["pose"], abs=0.05)
    both = edit(ava, moved, to_robot=True, pose={"x": 1.0, "y": 0.6})
    assert both.status_code == 422


def test_a_place_is_renamed_moved_deleted_and_brought_back(ava: httpx.Client) -> None:
    place = save(ava)
    renamed = edit(ava, place, name="Dock A", note="left").json()
    assert (renamed["name"], renamed["note"], renamed["version"]) == ("Dock A", "left", 2)
    moved = edit(ava, renamed, pose={"x": 1.0, "y": 0.6}).json()
    assert moved["pose"] == {"x": 1.0, "y": 0.6, "yaw": None}
    assert remove(ava, moved).status_code == 200
    wait_until(lambda: not names(ava), 5.0, "it is deleted")
    back = ava.post(f"/api/places/{place['id']}/restore").json()
    assert (back["id"], back["name"], back["pose"]) == (place["id"], "Dock A", moved["pose"])


def test_of_two_who_change_a_place_at_once_one_is_told_who_was_faster(
    ava: httpx.Client, ben: httpx.Client
) -> None:
    place = save(ava)
    with concurrent.futures.ThreadPoolExecutor(2) as both:
        answers = list(
            both.map(
                lambda one: edit(one[0], place, name=one[1]), [(ava, "Dock A"), (ben, "Dock B")]
            )
        )
    assert sorted(answer.status_code for answer in answers) == [200, 409]
    [late] = [answer for answer in answers if answer.status_code == 409]
    [won] = [answer.json() for answer in answers if answer.status_code == 200]
    refused(late, 409, won["author"], won["name"], "meanwhile")
    wait_until(lambda: names(ava) == [won["name"]], 5.0, "the faster one's name")


def test_of_many_who_save_one_name_at_once_one_does(ava: httpx.Client, robot: Served) -> None:
    with contextlib.ExitStack() as stack:
        clients = [stack.enter_context(robot.client(Role.OPERATOR)) for _ in range(5)]
        with concurrent.futures.ThreadPoolExecutor(5) as pool:
            codes = list(pool.map(lambda c: c.post("/api/places", json=DOCK).status_code, clients))
    assert sorted(codes) == [201, 409, 409, 409, 409]


@pytest.mark.parametrize(
    ("body", "status", "parts"),
    [
        ({**DOCK, "name": ""}, 422, ("name cannot be ''", "give the place a name")),
        ({**DOCK, "name": "x" * 41}, 422, ("name", "use at most 40")),
        ({**DOCK, "name": "a\u202eb"}, 422, ("name", "cannot be seen")),
        ({**DOCK, "name": "x" * 10_000}, 422, ("name",)),
        ({**DOCK, "note": "x" * 201}, 422, ("note", "use at most 200")),
        ({**DOCK, "pose": {"x": 40.0, "y": 0.0}}, 422, ("outside the map", "a point of the map")),
        ({**DOCK, "pose": {"x": 1e300, "y": 0.0}}, 422, ("pose.x",)),
        ({**DOCK, "pose": {"x": "here", "y": 0.0}}, 422, ("pose.x",)),
        ({**DOCK, "map": "mine"}, 422, ("map",)),
        ({"pose": DOCK["pose"]}, 422, ("name",)),
    ],
    ids=lambda one: str(one)[:40],
)
def test_what_cannot_be_a_place_is_refused_in_a_sentence(
    ava: httpx.Client, body: Json, status: int, parts: tuple[str, ...]
) -> None:
    refused(ava.post("/api/places", json=body), status, *parts)
    assert names(ava) == []


def test_who_saves_a_place_in_an_obstacle_is_warned(ava: httpx.Client) -> None:
    assert save(ava)["warning"] == ""
    pillar = {**DOCK, "name": "pillar", "pose": {"x": 0.0, "y": 0.0, "yaw": 0.0}}
    kept = ava.post("/api/places", json=pillar)
    assert kept.status_code == 201
    assert kept.json()["warning"].endswith("now: This point is inside an obstacle.")
    moved = edit(ava, kept.json(), pose=DOCK["pose"])
    assert moved.json()["warning"] == ""


def test_a_place_that_is_gone_is_said_to_be(ava: httpx.Client) -> None:
    place = save(ava)
    assert remove(ava, place).status_code == 200
    refused(remove(ava, place), 409, "deleted")
    refused(edit(ava, place, name="x"), 409, "deleted")
    wait_until(lambda: not names(ava), 5.0, "it is deleted")
    go = {"place": place["id"], "version": 1}
    refused(ava.post("/api/goals", json=go), 404, "no place")
    refused(ava.post("/api/places/999999/restore"), 409, "ave it anew")


def test_the_robot_goes_to_a_place_as_to_a_goal(robot: Served, ava: httpx.Client) -> None:
    place = save(ava)
    go = {"place": place["id"], "version": place["version"]}
    before = len(robot.audited())
    check = ava.post("/api/goals/check", json=go).json()
    assert (check["ok"], check["x"], check["y"], check["yaw"]) == (True, 0.6, 0.6, 1.0)
    assert check["length"] > 0
    sent = ava.post("/api/goals", json=go)
    assert sent.status_code == 200, sent.text
    with opened(robot, "/api/state", ava) as socket:

        def arrived(message: Json) -> bool:
            goal = message.get("goal") or {"id": "", "phase": ""}
            return (goal["id"], goal["phase"]) == (sent.json()["id"], "arrived")

        until(socket, arrived, 20.0)
    lines = robot.audited()[before:]
    [line] = [line for line in lines if line["what"] == "send goal"]
    assert (line["who"], line["place"], line["outcome"]) == ("ava", "Dock", "sent")


def test_a_place_that_was_moved_since_it_was_looked_at_is_not_gone_to(ava: httpx.Client) -> None:
    place = save(ava)
    edit(ava, place, pose={"x": 1.0, "y": 0.6}).raise_for_status()
    wait_until(lambda: listed(ava)["places"][0]["version"] == 2, 5.0, "it is moved")
    go = {"place": place["id"], "version": 1}
    for path in ("/api/goals/check", "/api/goals"):
        refused(ava.post(path, json=go), 409, "'Dock' was changed meanwhile, by ava")


def test_a_place_that_cannot_be_reached_says_why(ava: httpx.Client) -> None:
    place = save(ava, name="Pillar", pose={"x": 0.0, "y": 0.0})
    go = {"place": place["id"], "version": 1}
    check = ava.post("/api/goals/check", json=go).json()
    assert not check["ok"]
    assert check["message"]
    refused(ava.post("/api/goals", json=go), 409, check["message"])


def test_every_change_leaves_a_line_with_before_and_after(robot: Served, ava: httpx.Client) -> None:
    place = save(ava)
    before = len(robot.audited())
    edit(ava, place, name="Door").raise_for_status()
    edit(ava, place, name="Gate")
    told = [line for line in robot.audited()[before:] if line["what"] == "change place"]
    assert [line["who"] for line in told] == ["ava", "ava"]
    assert (told[0]["outcome"], told[0]["before"]["name"]) == ("done", "Dock")
    assert (told[0]["after"]["name"], told[0]["after"]["version"]) == ("Door", 2)
    assert "meanwhile" in told[1]["outcome"]


def publish_map(tester: Robot, cells: np.ndarray) -> Callable[[], None]:
    """Tell a map as a map server does; what ends it."""
    message = OccupancyGrid()
    message.header.frame_id = "map"
    message.info.resolution = RESOLUTION
    message.info.height, message.info.width = cells.shape
    message.info.origin.position.x, message.info.origin.position.y = ORIGIN
    message.data = cells.ravel().tolist()
    publisher = tester.node.create_publisher(OccupancyGrid, "/map", LATCHED)
    publisher.publish(message)
    return lambda: tester.node.destroy_publisher(publisher)


def test_a_place_of_another_map_is_not_offered_and_nobody_is_sent_there(
    ava: httpx.Client, domain: int
) -> None:
    place = save(ava)
    go = {"place": place["id"], "version": 1}
    tester = Robot(domain)
    try:
        other = world_map()
        other[70, 90] = 100  # one cell is enough
        end = tester.do(lambda: publish_map(tester, other))
        wait_until(lambda: not listed(ava)["places"][0]["here"], 10.0, "another map")
        for path in ("/api/goals/check", "/api/goals"):
            refused(ava.post(path, json=go), 409, "'Dock' is a place of another map", "8.0 × 6.0")
        refused(edit(ava, place, pose={"x": 1.0, "y": 0.6}), 409, "another map")
        # The same name is free here, and a place can be taken along to where it is the same room.
        mine = save(ava)
        assert mine["here"]
        refused(edit(ava, place, here=True), 409, "taken")
        along = edit(ava, place, here=True, name="Old dock").json()
        assert (along["here"], along["pose"]) == (True, place["pose"])
        tester.do(end)
        end = tester.do(lambda: publish_map(tester, world_map()))
        wait_until(
            lambda: [each["here"] for each in listed(ava)["places"]] == [False, False],
            *(10.0, "the first map again"),
        )
        tester.do(end)
    finally:
        tester.close()


def test_places_outlive_the_monitor_s_violent_end(tmp_path: Path, console: Served) -> None:
    """On a robot of its own: what was acknowledged is there again, and nothing else was waited
    for."""
    domain, folder = next_domain(), tmp_path / "robot"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        with (
            serving(tmp_path / "audit", domain) as own,
            running_stack(),
            own.client(Role.OPERATOR, user="ava") as client,
        ):
            with monitor_in(folder) as first:
                wait_until(lambda: listed(client)["available"], 20.0, "the places are told")
                wait_until(lambda: listed(client)["map"], 10.0, "the map is there")
                await_monitor(client)
                answer = client.post("/api/places", json=DOCK)
                first.send_signal(signal.SIGKILL)  # at once after it was answered
                assert answer.status_code == 201, answer.text
            # The robot can go there all the same; nothing can be changed, and that is said.
            go = {"place": answer.json()["id"], "version": 1}
            assert client.post("/api/goals/check", json=go).status_code == 200
            wait_until(
                lambda: client.post("/api/places", json={**DOCK, "name": "x"}).status_code == 503,
                *(30.0, "nobody keeps places"),
            )
            with monitor_in(folder):
                wait_until(
                    lambda: edit(client, answer.json(), note="here again").status_code == 200,
                    *(30.0, "the places of before"),
                )
    give_back(domain)


def test_a_robot_that_cannot_keep_places_says_why_and_keeps_its_rules(tmp_path: Path) -> None:
    domain, folder = next_domain(), tmp_path / "robot"
    with pytest.MonkeyPatch.context() as patch, PlaceStore.open(folder):  # somebody else has them
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        with (
            serving(tmp_path / "audit", domain) as own,
            running_stack(),
            monitor_in(folder),
            own.client(Role.OPERATOR) as client,
        ):
            await_monitor(client)
            wait_until(lambda: "store of places" in listed(client)["problem"], 10.0, "why not")
            wait_until(lambda: listed(client)["map"], 10.0, "the map is there")
            assert not listed(client)["available"]
            refused(client.post("/api/places", json=DOCK), 409, "Places cannot be kept")
    give_back(domain)
