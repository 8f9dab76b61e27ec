"""Zones over the console: who may, what is kept, and what is said where none can be."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from std_msgs.msg import String

from kompass.zones.mask import MaskMark, MasksNow
from kompass_console.schema.roles import Role
from tests.console.conftest import Served, running_stack
from tests.console.fake_stack import world_map
from tests.console.rules_client import Json, await_monitor
from tests.console.test_places import listed as places_of
from tests.console.test_places import monitor_in, publish_map, refused
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot

pytestmark = pytest.mark.ros

CORNERS = [[0.2, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.8]]
STAIRS = {"name": "Stairs", "kind": "keep_out", "corners": CORNERS}
CHANGES: list[tuple[str, str, Json]] = [
    ("POST", "/api/zones", STAIRS),
    ("POST", "/api/zones/sketch", {"corners": CORNERS}),
    ("PUT", "/api/zones/1", {"version": 1, **STAIRS}),
    ("DELETE", "/api/zones/1?version=1", {}),
    ("POST", "/api/zones/1/restore", {}),
]


@pytest.fixture(scope="module")
def stack() -> Iterator[object]:
    with running_stack() as process:
        yield process


@pytest.fixture(scope="module")
def robot(
    console: Served, stack: object, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Served]:
    """The console beside a monitor and a stack that has told its map."""
    folder: Path = tmp_path_factory.mktemp("robot")
    with monitor_in(folder), console.client(Role.VIEWER) as client:
        await_monitor(client)
        wait_until(lambda: listed(client)["available"], 10.0, "the zones are told")
        wait_until(lambda: places_of(client)["map"], 10.0, "the map is there")
        yield console


@pytest.fixture
def ava(robot: Served) -> Iterator[httpx.Client]:
    """An operator, and no zones."""
    with robot.client(Role.OPERATOR, user="ava") as client:
        for zone in listed(client)["zones"]:
            client.delete(f"/api/zones/{zone['id']}", params={"version": zone["version"]})
        wait_until(lambda: not listed(client)["zones"], 5.0, "no zones")
        yield client


def listed(client: httpx.Client) -> Json:
    answer = client.get("/api/zones")
    assert answer.status_code == 200, answer.text
    found: Json = answer.json()
    return found


def save(client: httpx.Client, **more: Any) -> Json:
    answer = client.post("/api/zones", json={**STAIRS, **more})
    assert answer.status_code == 201, answer.text
    zone: Json = answer.json()
    wait_until(
        lambda: any(each["id"] == zone["id"] for each in listed(client)["zones"]),
        5.0,
        "the zone is told",
    )
    return zone


@pytest.mark.parametrize(("method", "path", "body"), CHANGES, ids=lambda one: str(one)[:30])
def test_a_viewer_sees_zones_and_changes_none(
    robot: Served, ava: httpx.Client, method: str, path: str, body: Json
) -> None:
    save(ava)
    with robot.client(Role.VIEWER) as viewer:
        assert [zone["name"] for zone in listed(viewer)["zones"]] == ["Stairs"]
        refused(viewer.request(method, path, json=body), 403, "this takes an operator")
    with robot.client() as stranger:
        assert stranger.get("/api/zones").status_code == 401
        assert stranger.request(method, path, json=body).status_code == 401


def test_another_site_changes_nothing(ava: httpx.Client) -> None:
    for method, path, body in CHANGES:
        answer = ava.request(method, path, json=body, headers={"Origin": "https://evil.example"})
        assert answer.status_code == 403, answer.text
    assert listed(ava)["zones"] == []


def test_a_zone_is_saved_changed_deleted_and_restored_by_name_and_audited(
    robot: Served, ava: httpx.Client
) -> None:
    zone = save(ava)
    assert (zone["author"], zone["here"], zone["speed"]) == ("ava", True, None)
    slow = {"version": 1, "name": "Slow <b>", "kind": "speed", "speed": 0.3, "corners": CORNERS}
    with robot.client(Role.OPERATOR, user="ben") as ben:
        changed = ben.put(f"/api/zones/{zone['id']}", json=slow).json()
        assert (changed["author"], changed["version"], changed["name"]) == ("ben", 2, "Slow <b>")
        refused(ava.put(f"/api/zones/{zone['id']}", json=slow), 409, "changed meanwhile, by ben")
        assert ben.delete(f"/api/zones/{zone['id']}", params={"version": 2}).status_code == 200
        refused(ben.put(f"/api/zones/{zone['id']}", json=slow), 409, "somebody has deleted it")
        assert ava.post(f"/api/zones/{zone['id']}/restore").json()["speed"] == 0.3
    with robot.client(Role.ENGINEER) as engineer:
        lines = engineer.get("/api/audit").json()["lines"]
    done = [line["what"] for line in lines if "zone" in line["what"] and line["outcome"] == "done"]
    assert done[:4] == ["restore zone", "delete zone", "change zone", "save zone"]


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"corners": CORNERS[:2]}, "at least 3"),
        ({"corners": [CORNERS[0], CORNERS[2], CORNERS[1], CORNERS[3]]}, "crosses"),
        ({"corners": [*CORNERS[:3], [900.0, 0.0]]}, "outside the map"),
        ({"kind": "speed"}, "no speed"),
        ({"kind": "speed", "speed": 99.0}, "10"),
        ({"name": "x" * 41}, "41 characters"),
    ],
)
def test_what_is_no_zone_is_refused_and_says_why(
    ava: httpx.Client, changed: Json, told: str
) -> None:
    refused(ava.post("/api/zones", json={**STAIRS, **changed}), 422, told)
    assert listed(ava)["zones"] == []


def test_what_is_drawn_is_judged_before_it_is_saved(ava: httpx.Client) -> None:
    def sketched(corners: list[list[float]]) -> str:
        answer = ava.post("/api/zones/sketch", json={"corners": corners})
        assert answer.status_code == 200, answer.text
        assert answer.json()["corners"] == corners
        problem: str = answer.json()["problem"]
        return problem

    assert sketched(CORNERS) == ""
    assert "three corners" in sketched(CORNERS[:2])
    assert "crosses" in sketched([CORNERS[0], CORNERS[2], CORNERS[1], CORNERS[3]])
    assert "outside the map" in sketched([*CORNERS[:3], [900.0, 0.0]])
    assert listed(ava)["zones"] == []


def test_who_would_be_in_a_zone_is_told_before_it_is_saved(ava: httpx.Client) -> None:
    around_robot = [[-1.0, -0.9], [-0.5, -0.9], [-0.5, -0.3], [-1.0, -0.3]]  # it is at -0.75, -0.6
    saved = ava.post("/api/places", json={"name": "Ramp", "pose": {"x": 0.5, "y": 0.5}})
    assert saved.status_code == 201, saved.text

    def inside(corners: list[list[float]]) -> tuple[bool, list[str]]:
        told = ava.post("/api/zones/sketch", json={"corners": corners}).json()
        return told["robot_inside"], told["places_inside"]

    wait_until(lambda: inside(CORNERS) == (False, ["Ramp"]), 5.0, "the place is told of")
    assert inside(around_robot) == (True, [])
    assert inside(CORNERS[:2]) == (False, [])
    gone = ava.delete(f"/api/places/{saved.json()['id']}", params={"version": 1})
    assert gone.status_code == 200, gone.text


def test_masks_of_the_recipe_are_listed_to_be_drawn_beside_the_zones(
    ava: httpx.Client, domain: int
) -> None:
    save(ava)
    tester = Robot(domain)
    try:
        masks = tester.node.create_publisher(String, "/masks", LATCHED)
        corners = tuple((x, y) for x, y in CORNERS)
        ramp = MaskMark(name="Ramp", speed=0.2, corners=corners)
        told = MasksNow(masks=(MaskMark(name="Pit", speed=None, corners=corners), ramp))
        masks.publish(String(data="{}}"))  # is passed over
        masks.publish(String(data=told.model_dump_json()))
        wait_until(lambda: len(listed(ava)["masks"]) == 2, 10.0, "two masks")
        assert [(one["name"], one["kind"], one["speed"]) for one in listed(ava)["masks"]] == [
            ("Pit", "keep_out", None),
            ("Ramp", "speed", 0.2),
        ]
        assert [zone["name"] for zone in listed(ava)["zones"]] == ["Stairs"]
        masks.publish(String(data=MasksNow().model_dump_json()))
        wait_until(lambda: not listed(ava)["masks"], 10.0, "no masks")
    finally:
        tester.close()


def test_on_another_map_a_zone_is_not_in_force_until_it_is_taken_along(
    ava: httpx.Client, domain: int
) -> None:
    zone = save(ava)
    tester = Robot(domain)
    tester.subscribe(String, "/zones", LATCHED)

    def in_force() -> list[str]:
        told = tester.newest.get("/zones")
        return [] if told is None else [each["name"] for each in json.loads(told.data)["zones"]]

    def monitor_hears_the_map() -> bool:
        infos = tester.node.get_subscriptions_info_by_topic("/map")
        return any(info.node_name == "monitor" for info in infos)

    try:
        wait_until(lambda: in_force() == ["Stairs"], 10.0, "a zone in force")
        wait_until(monitor_hears_the_map, 10.0, "a monitor that looks at the map")
        other = world_map()
        other[70, 90] = 100  # one cell is enough
        ends = []

        def without() -> bool:
            # Whoever has just begun to listen may hear the map of before after this one.
            ends.append(tester.do(lambda: publish_map(tester, other)))
            with contextlib.suppress(AssertionError):
                wait_until(lambda: not in_force(), 0.5, "no zone in force")
            return not in_force()

        wait_until(without, 10.0, "no zone in force")
        wait_until(lambda: not listed(ava)["zones"][0]["here"], 10.0, "another map")
        along = ava.put(f"/api/zones/{zone['id']}", json={"version": 1, **STAIRS})
        assert along.json()["here"]
        wait_until(lambda: in_force() == ["Stairs"], 10.0, "the zone in force there")
        for end in ends:
            tester.do(end)
        end = tester.do(lambda: publish_map(tester, world_map()))
        wait_until(lambda: not in_force(), 10.0, "the first map again")
        tester.do(end)
    finally:
        tester.close()
