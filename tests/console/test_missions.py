"""Missions over the console: who may, what is kept, who sees it, and what is refused."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from kompass_console.schema.roles import Role
from tests.console.conftest import Served, running_stack
from tests.console.rules_client import Json, await_monitor, opened, until
from tests.console.test_places import listed as places_of
from tests.console.test_places import monitor_in, refused
from tests.console.test_places import save as save_place
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

CHANGES: list[tuple[str, str, Json]] = [
    ("POST", "/api/missions", {"name": "Round", "waypoints": [{"place": 1}]}),
    ("PUT", "/api/missions/1", {"name": "Round", "waypoints": [{"place": 1}], "version": 1}),
    ("DELETE", "/api/missions/1?version=1", {}),
    ("POST", "/api/missions/1/restore", {}),
    ("POST", "/api/missions/1/start", {"version": 1}),
    ("POST", "/api/missions/run/1/resume", {"step": 1}),
    ("POST", "/api/missions/queue/next", {}),
    ("DELETE", "/api/missions/queue/1", {}),
]


@pytest.fixture(scope="module")
def stack() -> Iterator[object]:
    with running_stack() as process:
        yield process


@pytest.fixture(scope="module")
def robot(
    console: Served, stack: object, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Served]:
    """The console beside a monitor and a stack that has told its map, with a place."""
    folder: Path = tmp_path_factory.mktemp("robot")
    with monitor_in(folder), console.client(Role.OPERATOR, user="ava") as client:
        await_monitor(client)
        wait_until(lambda: listed(client)["available"], 10.0, "the missions are told")
        wait_until(lambda: places_of(client)["map"], 10.0, "the map is there")
        save_place(client)
        yield console


@pytest.fixture
def ava(robot: Served) -> Iterator[httpx.Client]:
    """An operator, and no missions."""
    with robot.client(Role.OPERATOR, user="ava") as client:
        for mission in listed(client)["missions"]:
            remove(client, mission)
        wait_until(lambda: not listed(client)["missions"], 5.0, "no missions")
        yield client


def listed(client: httpx.Client) -> Json:
    answer = client.get("/api/missions")
    assert answer.status_code == 200, answer.text
    found: Json = answer.json()
    return found


def body(client: httpx.Client, *tasks: Json, **more: Any) -> Json:
    dock = places_of(client)["places"][0]["id"]
    return {"name": "Round", "waypoints": [{"place": dock, "tasks": list(tasks)}], **more}


def save(client: httpx.Client, *tasks: Json, **more: Any) -> Json:
    answer = client.post("/api/missions", json=body(client, *tasks, **more))
    assert answer.status_code == 201, answer.text
    mission: Json = answer.json()
    wait_until(lambda: mission in listed(client)["missions"], 5.0, "the mission is told")
    return mission


def remove(client: httpx.Client, mission: Json) -> httpx.Response:
    params = {"version": mission["version"]}
    return client.delete(f"/api/missions/{mission['id']}", params=params)


@pytest.mark.parametrize(("method", "path", "given"), CHANGES, ids=lambda one: str(one)[:30])
def test_a_viewer_sees_missions_and_changes_none(
    robot: Served, ava: httpx.Client, method: str, path: str, given: Json
) -> None:
    mission = save(ava)
    with robot.client(Role.VIEWER) as viewer:
        assert listed(viewer)["missions"] == [mission]
        refused(viewer.request(method, path, json=given), 403, "this takes an operator")
    with robot.client() as stranger:
        assert stranger.get("/api/missions").status_code == 401
        assert stranger.request(method, path, json=given).status_code == 401
    headers = {"Origin": "https://evil.example"}
    assert ava.request(method, path, json=given, headers=headers).status_code == 403
    assert listed(ava)["missions"] == [mission]


def test_it_is_changed_deleted_and_brought_back_and_nothing_is_overwritten_unseen(
    robot: Served, ava: httpx.Client
) -> None:
    mission = save(ava, {"kind": "wait", "seconds": 5}, rounds=3)
    assert (mission["author"], mission["role"], mission["here"]) == ("ava", "operator", True)
    with robot.client(Role.OPERATOR, user="ben") as ben:
        changed = ben.put(
            f"/api/missions/{mission['id']}",
            json={**body(ben, name="Night round"), "version": mission["version"]},
        )
        assert changed.status_code == 200, changed.text
        refused(remove(ava, mission), 409, "was changed meanwhile, by ben")
        deleted = remove(ben, changed.json())
        assert deleted.status_code == 200, deleted.text
        back = ben.post(f"/api/missions/{mission['id']}/restore")
        assert back.json()["name"] == "Night round"
        wait_until(lambda: listed(ava)["missions"] == [back.json()], 5.0, "the mission is back")
    taken = ava.post("/api/missions", json=body(ava, name="NIGHT round"))
    refused(taken, 409, "taken by another mission")


@pytest.mark.parametrize(
    ("tasks", "more", "status", "told"),
    [
        ([], {"rounds": 0}, 422, "has one place only"),
        ([], {"name": " "}, 422, "give the place a name"),
        ([], {"waypoints": [{"place": 9999}]}, 409, "is there no more"),
        ([{"kind": "wait", "seconds": -1}], {}, 422, "seconds"),
        (
            [{"kind": "act", "action": {"kind": "method", "component": "x", "method": "y"}}],
            {},
            409,
            "task 1",
        ),
        ([], {"schedule": {"at": "25:00"}}, 422, "at"),
        ([], {"surprise": 1}, 422, "surprise"),
    ],
)
def test_what_makes_no_sense_is_refused_with_what_to_do_and_changes_nothing(
    ava: httpx.Client, tasks: list[Json], more: Json, status: int, told: str
) -> None:
    answer = ava.post("/api/missions", json=body(ava, *tasks, **more))
    refused(answer, status, told)
    assert listed(ava)["missions"] == []


def test_what_runs_is_told_to_all_and_steered_by_number(robot: Served, ava: httpx.Client) -> None:
    mission = save(ava, {"kind": "ask", "text": "Load it"})
    started = ava.post(f"/api/missions/{mission['id']}/start", json={"version": 1})
    assert started.status_code == 200, started.text
    with told(robot) as state:
        run = state(lambda now: now["run"] and now["run"]["phase"] == "asking")["run"]
        assert (run["name"], run["by"], run["place"]) == ("Round", "ava", "Dock")
        assert (run["task"], run["ask"]) == ("wait for a person", "Load it")
        refused(ava.post("/api/missions/run/999/skip", json={"step": 1}), 409, "That run is over")
        steer, seen = f"/api/missions/run/{run['number']}", {"step": run["step"]}
        assert ava.post(f"{steer}/pause").status_code == 422
        assert ava.post(f"{steer}/pause", json=seen).status_code == 204
        refused(ava.post(f"{steer}/confirm", json=seen), 409, "has gone on meanwhile")
        paused = state(lambda now: now["run"]["phase"] == "paused")["run"]
        now = {"step": paused["step"]}
        refused(ava.post(f"{steer}/confirm", json=now), 409, "waits for nobody")
        assert ava.post(f"{steer}/dance", json=now).status_code == 422
        # A second one waits for its turn.
        again = ava.post(f"/api/missions/{mission['id']}/start", json={"version": 1})
        assert again.status_code == 200
        (waits,) = state(lambda now: now["queue"])["queue"]
        assert (waits["name"], waits["by"]) == ("Round", "ava")
        refused(ava.post("/api/missions/queue/next"), 409, "A mission runs")
        assert ava.delete(f"/api/missions/queue/{waits['number']}").status_code == 204
        refused(ava.delete(f"/api/missions/queue/{waits['number']}"), 409, "waits no more")
        assert ava.post(f"{steer}/cancel", json=seen).status_code == 204
        ended = state(lambda now: now["run"]["phase"] == "canceled")
        assert (ended["run"]["decided_by"], ended["queue"]) == ("ava", [])
        refused(ava.post("/api/missions/queue/next"), 409, "No mission waits")
    lines = [(line["what"], line["outcome"]) for line in robot.audited()]
    assert ("start mission", "done") in lines
    assert ("cancel mission", "done") in lines


@contextmanager
def told(robot: Served) -> Iterator[Callable[[Callable[[Json], object]], Json]]:
    """Waits until what a viewer is told of the missions fits."""
    with robot.client(Role.VIEWER) as viewer, opened(robot, "/api/state", viewer) as socket:

        def state(good: Callable[[Json], object]) -> Json:
            message = until(socket, lambda m: m["type"] == "state" and good(m["missions"]))
            found: Json = message["missions"]
            return found

        yield state
