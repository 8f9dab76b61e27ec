"""Drills are begun, watched, cancelled, looked into, and refused where they cannot be."""

from __future__ import annotations

import copy
import fcntl
import os
import shutil
import subprocess
import tempfile
import uuid
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import httpx
import pytest

from kompass_console.drills.subject import DrillSubject
from kompass_console.scene import playback
from kompass_console.schema.roles import Role
from tests.console.conftest import TOKENS, Served, cookie_of, serving
from tests.console.rules_client import Json, await_monitor, running_monitor, table
from tests.console.scene_client import SceneClient
from tests.support.processes import ended, marked, wait_until

pytestmark = pytest.mark.ros

RECIPES = Path(__file__).parents[2] / "recipes"
# Whoever is too near something, and that is soon the case, is stopped: a change for the worse.
STOPS: Json = {
    "id": "shy",
    "name": "Stop near anything",
    "event": {
        "condition": {
            "kind": "compare",
            "operator": "<",
            "value": 0.6,
            "signal": {
                "topic": "scan",
                "type": "sensor_msgs/msg/LaserScan",
                "path": ["ranges"],
                "aggregate": "min",
            },
        }
    },
    "actions": [{"kind": "raise_alarm", "alarm": "shy", "text": "something is near"}],
}


OWN: Json = {
    "name": "mine",
    "world": "hexagon",
    "start": {"x": -2.0, "y": -0.5},
    "goals": [{"x": -1.0, "y": -0.4}],
    "faults": [{"name": "kill:controller", "at": 3.0}],
    "limit": 60.0,
}


@pytest.fixture(scope="module")
def recipe(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recipe of the user's, on its own."""
    file = tmp_path_factory.mktemp("recipe") / "patrol.py"
    shutil.copy(RECIPES / "01_point_navigation.py", file)
    return file


@pytest.fixture(scope="module")
def drilling(
    tmp_path_factory: pytest.TempPathFactory, domain: int, recipe: Path
) -> Iterator[Served]:
    """A console that has the robot's recipe."""
    folder = tmp_path_factory.mktemp("console") / "audit"
    subject = DrillSubject.of(recipe, None)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TESTED_BY", uuid.uuid4().hex)  # by which what is forked is found again
        with serving(folder, domain, drill=subject) as served:
            yield served


def test_of_a_robot_with_a_camera_there_is_what_only_a_camera_sees(
    tmp_path: Path, domain: int, recipe: Path
) -> None:
    subject = DrillSubject.of(recipe, "hexagon", "turtlebot3-plus")
    with (
        serving(tmp_path / "audit", domain, drill=subject) as served,
        served.client(Role.VIEWER) as client,
    ):
        room = client.get("/api/drills").json()
    assert room["robot"] == "turtlebot3-plus"
    assert "low_box" in [fault["name"] for fault in room["faults"]]


@pytest.fixture(scope="module")
def monitor(drilling: Served) -> Iterator[subprocess.Popen[bytes]]:
    with running_monitor() as process, drilling.client(Role.VIEWER) as client:
        await_monitor(client)
        yield process


@pytest.fixture
def operator(drilling: Served, monitor: subprocess.Popen[bytes]) -> Iterator[httpx.Client]:
    with drilling.client(Role.OPERATOR, user="ava") as client:
        yield client
        newest = client.get("/api/drills").json()["newest"]
        if newest is not None and newest["state"] == "running":
            client.delete(f"/api/drills/{newest['id']}")


def proposed() -> Json:
    """The table in force with another rule."""
    whole = table()
    return {**whole, "rules": [*whole["rules"], copy.deepcopy(STOPS)]}


def begin(client: httpx.Client, drives: int = 50, **more: object) -> str:
    """Begin one; its id."""
    body = {"table": proposed(), "faults": ["kill:controller"], "drives": drives, **more}
    answer = client.post("/api/drills", json=body)
    assert answer.status_code == 202, answer.text
    return str(answer.json()["id"])


def after(client: httpx.Client, drill: str) -> Json:
    """What came of it."""
    told: Json = {}

    def over() -> bool:
        told.update(client.get(f"/api/drills/{drill}").json())
        return bool(told["state"] != "running")

    wait_until(over, 60.0, "the end of the drill")
    return told


def programs() -> list[str]:
    """Command lines of the processes of drills of this run."""
    found = marked(f"TESTED_BY={os.environ['TESTED_BY']}")
    return [line for line in found if "kompass.drills" in line or "multiprocessing" in line]


@pytest.mark.slow
def test_a_proposed_table_is_compared_drive_by_drive_with_the_one_in_force(
    operator: httpx.Client, drilling: Served
) -> None:
    drill = begin(operator, drives=2)
    told: Json = {}

    def further() -> bool:
        told.update(operator.get(f"/api/drills/{drill}").json())
        # What is not known yet is not told.
        assert told["state"] != "running" or (told["left"] is None) == (told["done"] < enough)
        return bool(told["done"] >= enough)

    enough = 2 * max(1, len(os.sched_getaffinity(0)) - 1)
    wait_until(further, 60.0, "drives")
    assert (told["total"], told["by"]) == (4, "ava")
    if told["state"] == "running":
        assert told["left"] == pytest.approx(told["elapsed"] / told["done"] * (4 - told["done"]))
    told = after(operator, drill)
    assert (told["state"], told["error"], told["done"]) == ("done", None, 4)
    report = told["report"]
    assert report["sentence"] == "Recovers in 2 of 2, as before."
    assert report["notes"] == []  # its only fault was drawn
    broken = [[fault["name"] for fault in drive["faults"]] for drive in report["drives"]]
    assert broken == [["kill:controller"]] * 2
    assert {drive["change"] for drive in report["drives"]} == {"other"}
    assert "“Stop near anything” fired" in report["drives"][0]["text"]

    name = report["drives"][0]["name"]
    pair = operator.get(f"/api/drills/{drill}/drives/{name}").json()
    assert "shy" in {firing["rule_id"] for firing in pair["proposed"]["firings"]}
    assert "shy" not in {firing["rule_id"] for firing in pair["in_force"]["firings"]}
    assert pair["proposed"]["scenario"] == pair["in_force"]["scenario"]
    assert len(pair["proposed"]["track"]) > 10
    assert pair["place"]["name"] == "hexagon"
    assert operator.get(f"/api/drills/{drill}/drives/nowhere").status_code == 404
    page = operator.get(f"/api/drills/{drill}/report")
    assert report["sentence"] in page.text
    assert page.headers["content-disposition"].startswith("attachment")
    assert programs() == []
    lines = [line for line in drilling.audited() if line["what"] == "drill"]
    assert lines[-1]["who"] == "ava"
    assert lines[-1]["outcome"] == "started"


@pytest.fixture
def scene(drilling: Served, operator: httpx.Client) -> Iterator[tuple[str, SceneClient]]:
    """A view of the operator's, and the page that shows it."""
    view = str(operator.post("/api/views").json()["id"])
    with closing(SceneClient(drilling.port, view, cookie_of(operator))) as page:
        page.look()
        wait_until(lambda: "/world/robot" in page.nodes, 5.0, "the scene is drawn")
        yield view, page


@pytest.mark.slow
def test_a_drive_is_played_in_the_scene_of_one_page_and_the_robot_comes_back(
    operator: httpx.Client,
    drilling: Served,
    scene: tuple[str, SceneClient],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    view, page = scene
    drill = begin(operator, drives=1)
    [drive] = after(operator, drill)["report"]["drives"]
    pair = operator.get(f"/api/drills/{drill}/drives/{drive['name']}").json()
    address = f"/api/views/{view}/drive"
    played = {"drill": drill, "scenario": drive["name"]}
    ghosts = [f"/drive/{side}/robot" for side in ("proposed", "in_force")]
    before = dict(page.camera)
    others = str(operator.post("/api/views").json()["id"])
    with closing(SceneClient(drilling.port, others, cookie_of(operator))) as other:
        other.look()
        assert operator.put(address, json={**played, "moment": 0.0}).status_code == 204
        wait_until(lambda: all(page.visible.get(ghost) for ghost in ghosts), 5.0, "both robots")
        assert page.visible["/world"] is False
        start = pair["proposed"]["scenario"]["start"]
        for ghost in ghosts:
            assert page.positions[ghost][:2] == pytest.approx((start["x"], start["y"]), abs=0.05)
        assert page.camera != before

        # It goes on by itself at its speed, and stands at the moment that it is taken to.
        assert operator.put(address, json={**played, "speed": 10.0}).status_code == 204
        wait_until(
            lambda: page.positions[ghosts[0]][:2] != pytest.approx((start["x"], start["y"]), abs=1),
            10.0,
            "it drives",
        )
        end = {**played, "moment": pair["proposed"]["duration"]}
        assert operator.put(address, json=end).status_code == 204
        last = pair["proposed"]["track"][-1][1:]
        wait_until(
            lambda: page.positions[ghosts[0]][:2] == pytest.approx(last, abs=0.01), 2.0, "its end"
        )
        fired = next(one for one in pair["proposed"]["firings"] if one["rule_id"] == "shy")
        assert operator.put(address, json={**played, "moment": fired["at"]}).status_code == 204
        said = page.updates.setdefault("/drive/proposed/robot/name", {})
        wait_until(lambda: "shy fired" in said.get("text", ""), 2.0, "which rule fires")

        # What is pressed there is no place of the robot's.
        pressed = operator.post("/api/goals/check", json={"view": view, "start": [0.5, 0.6]})
        assert pressed.status_code == 409
        assert "shows a drill" in pressed.json()["detail"]["title"]

        assert operator.delete(address).status_code == 204
        wait_until(lambda: page.visible["/world"], 2.0, "the robot's world")
        wait_until(lambda: "/drive" not in page.nodes, 2.0, "nothing is left of the drive")
        assert page.camera == before
        assert not any(node.startswith("/drive") for node in other.nodes)
        assert other.visible["/world"]

    # A page that says no more of it is not shown a robot that is not there.
    monkeypatch.setattr(playback, "_FORGOTTEN", 0.5)
    assert operator.put(address, json=played).status_code == 204
    wait_until(lambda: not page.visible["/world"], 2.0, "the drive")
    wait_until(lambda: page.visible["/world"], 5.0, "the robot again")


def test_a_drive_is_played_where_it_is_known_and_a_page_looks(
    operator: httpx.Client, drilling: Served, scene: tuple[str, SceneClient]
) -> None:
    view, _ = scene
    played = {"drill": "none", "scenario": "1-0"}
    assert operator.put(f"/api/views/{view}/drive", json=played).status_code == 404
    with drilling.client(Role.VIEWER) as other:
        assert other.put(f"/api/views/{view}/drive", json=played).status_code == 404
        assert other.delete(f"/api/views/{view}/drive").status_code == 404
    assert operator.put(f"/api/views/{view}/drive", json={**played, "speed": -1}).status_code == 422


def test_one_runs_at_a_time_and_one_that_is_cancelled_leaves_nothing_behind(
    operator: httpx.Client, drilling: Served
) -> None:
    drill = begin(operator)
    wait_until(programs, 20.0, "processes")
    refused = operator.post("/api/drills", json={"table": proposed()})
    assert refused.status_code == 429
    assert "A drill of ava's runs already" in refused.json()["detail"]["title"]
    for result in ("report", "drives/1-0", "files/1-0"):
        early = operator.get(f"/api/drills/{drill}/{result}")
        assert early.status_code == 409, early.text
        assert "has not come to its end yet" in early.json()["detail"]["title"]
    assert operator.delete(f"/api/drills/{drill}").status_code == 204
    told = operator.get(f"/api/drills/{drill}").json()
    assert (told["state"], told["error"]) == ("canceled", "ava cancelled it.")
    assert ended(programs, 2.0) == []
    again = begin(operator)
    operator.delete(f"/api/drills/{again}")
    operator.delete(f"/api/drills/{again}")
    assert operator.get(f"/api/drills/{again}").status_code == 404


def test_it_gives_way_to_whatever_else_the_machine_does(operator: httpx.Client) -> None:
    drill = begin(operator)
    wait_until(lambda: len(programs()) >= 3, 30.0, "the processes that make drives")
    pids = [int(line.partition(":")[0]) for line in programs()]
    for pid in pids:
        assert os.getpriority(os.PRIO_PROCESS, pid) == 19
        assert os.sched_getscheduler(pid) == os.SCHED_IDLE
        # Where the kernel shares out processors by session, only within one does that count.
        assert os.getsid(pid) == os.getsid(0)
        assert Path(f"/proc/{pid}/oom_score_adj").read_text().strip() == "1000"
    told = Path(f"/proc/{pids[0]}/environ").read_text(encoding="utf-8").split("\0")
    [folder] = [Path(line.partition("=")[2]) for line in told if line.startswith("TMPDIR=")]
    assert folder.is_dir()
    operator.delete(f"/api/drills/{drill}")
    assert not folder.exists()  # nothing of it is left


def test_what_consoles_that_were_killed_have_left_goes_with_the_next_drill(
    operator: httpx.Client,
) -> None:
    left, others = (Path(tempfile.mkdtemp(prefix="kompass-drills-")) for _ in range(2))
    (left / "kompass-drill-1").mkdir()
    locked = os.open(others, os.O_RDONLY)  # as by the console that it is of
    fcntl.flock(locked, fcntl.LOCK_EX)
    try:
        drill = begin(operator)
        wait_until(programs, 20.0, "processes")
        operator.delete(f"/api/drills/{drill}")
        assert not left.exists()
        assert others.exists()
    finally:
        os.close(locked)
        others.rmdir()


def test_who_logs_out_takes_the_drill_along(drilling: Served, operator: httpx.Client) -> None:
    with drilling.client(Role.OPERATOR, user="ben") as other:
        drill = begin(other)
        other.post("/api/logout")
    told = after(operator, drill)
    assert (told["state"], told["error"]) == ("canceled", "Ended: ben logged out.")


def test_applying_rules_ends_a_drill_against_the_ones_before(operator: httpx.Client) -> None:
    drill = begin(operator)
    wait_until(programs, 20.0, "processes")
    view = operator.get("/api/rules").json()
    answer = operator.post(
        "/api/rules/apply",
        # Without a probation, whose end would take it back in the middle of a later test.
        json={"table": table(), "expected_revision": view["active"], "probation": 0},
    )
    assert answer.status_code == 200, answer.text
    assert ended(programs, 2.0) == []  # whether anybody asks for it or not
    told = after(operator, drill)
    assert told["state"] == "canceled"
    assert told["error"] == (
        f"Ended: revision {answer.json()['revision']} was put in force meanwhile."
    )


def test_a_viewer_looks_and_begins_nothing(drilling: Served, operator: httpx.Client) -> None:
    drill = begin(operator)
    with drilling.client(Role.VIEWER) as viewer:
        assert viewer.get(f"/api/drills/{drill}").json()["state"] == "running"
        assert viewer.post("/api/drills", json={"table": proposed()}).status_code == 403
        assert viewer.delete(f"/api/drills/{drill}").status_code == 403
        assert viewer.post("/api/drills/scenarios", content=b"name: x").status_code == 403
    operator.delete(f"/api/drills/{drill}")


def test_a_table_that_is_none_is_the_callers_fault(operator: httpx.Client) -> None:
    answer = operator.post("/api/drills", json={"table": {"kind": "log"}})
    assert answer.status_code == 422, answer.text
    detail = answer.json()["detail"]
    assert "kind" in answer.text
    assert detail["remedy"]
    assert "monitor" not in detail["title"]


def test_a_table_with_errors_is_refused_with_its_findings(operator: httpx.Client) -> None:
    bad = proposed()
    bad["rules"][-1]["event"]["condition"]["signal"]["path"] = ["rangs"]
    answer = operator.post("/api/drills", json={"table": bad})
    assert answer.status_code == 422
    findings = answer.json()["report"]["findings"]
    assert {one["rule_id"] for one in findings if one["level"] == "error"} == {"shy"}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"faults": ["kil"]}, "did you mean 'kill'?"),
        ({"world": "moon"}, "There is no world 'moon'."),
        ({"drives": 201}, "drives"),
        ({"lasting": 1.5}, "lasting"),
        ({"drives": True}, "drives"),
        ({"scenario": {**OWN, "name": ".."}}, "scenario.name"),
        ({"scenario": {"name": "mine", "world": "hexagon", "goals": []}}, "scenario.goals"),
        (
            {"scenario": {**OWN, "start": {"x": 99.0, "y": 0.0}}},
            "scenario.start: that is off the floor of the hexagon; move it",
        ),
        ({"scenario": OWN, "world": "hexagon"}, "world is of drawn drives"),
    ],
)
def test_what_cannot_be_drawn_is_refused_by_name(
    operator: httpx.Client, options: Json, said: str
) -> None:
    answer = operator.post("/api/drills", json={"table": proposed(), **options})
    assert answer.status_code == 422
    assert said in answer.json()["detail"]["title"]


def test_a_recipe_that_cannot_be_drilled_says_why(
    operator: httpx.Client, domain: int, tmp_path: Path
) -> None:
    lost = tmp_path / "lost.py"
    lost.write_text("print('nothing is brought up here')\n")
    with (
        serving(tmp_path / "audit", domain, drill=DrillSubject.of(lost, None)) as served,
        served.client(Role.OPERATOR) as client,
    ):
        await_monitor(client)
        told = after(client, begin(client))
        assert told["state"] == "failed"
        assert "lost.py calls launcher.bringup() 0 times" in told["error"]
        lost.write_text("print('another')\n")
        room = client.get("/api/drills").json()
        assert "lost.py was changed since the robot was started" in room["refusal"]
        refused = client.post("/api/drills", json={"table": proposed()})
        assert refused.status_code == 409
        assert refused.json()["detail"]["remedy"] == "Start the robot again."


def test_a_console_without_the_recipe_says_so(console: Served) -> None:
    with console.client(Role.OPERATOR) as client:
        room = client.get("/api/drills").json()
    assert "does not have the recipe" in room["refusal"]
    assert "kompass-console drill" in room["remedy"]


def test_one_of_the_persons_own_is_driven_again_and_again_and_kept_as_a_file(
    operator: httpx.Client,
) -> None:
    body = {"table": proposed(), "scenario": {**OWN, "name": "hall/mine"}, "drives": 2}
    answer = operator.post("/api/drills", json=body)
    assert answer.status_code == 202, answer.text
    drill = answer.json()["id"]
    told = after(operator, drill)
    assert told["state"] == "done", told["error"]
    drives = told["report"]["drives"]
    assert sorted(drive["name"] for drive in drives) == ["hall/mine-0", "hall/mine-1"]
    assert {drive["faults"][0]["at"] for drive in drives} == {3.0}

    kept = operator.get(f"/api/drills/{drill}/files/hall/mine-1")
    assert kept.status_code == 200
    again = operator.post("/api/drills/scenarios", content=kept.content)
    assert again.status_code == 200, again.text
    read = again.json()
    assert (read["name"], read["start"], read["goals"][0]["x"]) == (
        "hall/mine-1",
        {"x": -2.0, "y": -0.5, "yaw": 0.0},
        -1.0,
    )
    pair = operator.get(f"/api/drills/{drill}/drives/hall%2Fmine-1").json()
    assert pair["proposed"]["scenario"]["seed"] == read["seed"] != 0


def test_a_fault_of_nobody_in_the_recipe_ends_the_drill_with_who_there_is(
    operator: httpx.Client,
) -> None:
    own = {**OWN, "faults": [{"name": "kill:maper", "at": 3.0}]}
    answer = operator.post("/api/drills", json={"table": proposed(), "scenario": own})
    told = after(operator, answer.json()["id"])
    assert told["state"] == "failed"
    assert "has no process or node 'maper'; did you mean 'mapper'?" in told["error"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"name: mine\nworld: moon\ngoals: [{x: 1.0, y: 1.0}]\n", "the file:2: world"),
        (b"\xff", "byte 0 is not UTF-8"),
        (b"[1]", "this is no scenario"),
    ],
)
def test_a_file_that_is_no_scenario_is_refused_with_its_line(
    operator: httpx.Client, text: bytes, said: str
) -> None:
    answer = operator.post("/api/drills/scenarios", content=text)
    assert answer.status_code == 422
    assert said in answer.json()["detail"]["title"]


def test_a_recording_that_is_not_there_is_said_so(operator: httpx.Client) -> None:
    answer = operator.get("/api/drills/scenarios/recorded/none")
    assert answer.status_code == 404
    assert "There is no recording 'none'" in answer.json()["detail"]["title"]


def test_a_world_is_told_from_above(operator: httpx.Client) -> None:
    place = operator.get("/api/drills/worlds/hexagon").json()
    assert place["start"][:2] == [-2.0, -0.5]
    assert len(place["floor"]) > 3
    assert operator.get("/api/drills/worlds/moon").status_code == 422


def test_the_page_is_told_which_faults_and_worlds_there_are(operator: httpx.Client) -> None:
    room = operator.get("/api/drills").json()
    assert room["refusal"] is None
    assert (room["recipe"], room["own_world"]) == ("patrol.py", None)
    assert room["worlds"][0]["name"] == "hexagon"
    kinds = {fault["name"]: fault for fault in room["faults"]}
    assert (kinds["kill"]["parameter"], kinds["kill"]["at_once"]) == ("NAME", True)
    assert (kinds["glass"]["parameter"], kinds["glass"]["example"]) == ("SHARE", "0.3")
    assert kinds["wheel_slip"]["choices"] == ["left", "right", "both"]
    assert kinds["way_blocked"]["parameter"] == ""
    assert room["robot"] == "turtlebot3"
    assert "low_box" not in kinds  # which only a camera sees
    assert TOKENS  # nothing of them in what was said
    assert not any(token in str(room) for token in TOKENS.values())
