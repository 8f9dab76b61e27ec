"""The console on a real graph: what it tells pages about the robot, and what it asks of it."""

from __future__ import annotations

import json
import statistics
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

from kompass_console.schema.roles import Role
from tests.console.conftest import Served, cookie_of, running_stack, serving
from tests.support.patience import patient
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

State = dict[str, Any]
Stack = subprocess.Popen[bytes]
# What runs beside the console. Tests of the same stack share it, so each leaves it without a goal.
WHOLE = ("--failing", "mapper")
SLOW = ("--slow-checks", "1.5", "--slow-release", "1.5")  # s; the console gives up after 2 s
TAKES_NO_GOALS = ("--no-poses", "--no-points")
FOREIGN = ("--no-planner", "--no-action", "--no-statuses", "--no-drive")


def beside(*options: str) -> pytest.MarkDecorator:
    """Run a test beside a stack with these options."""
    return pytest.mark.parametrize("stack", [options], indirect=True, ids=" ".join)


@contextmanager
def listening(console: Served, client: httpx.Client) -> Iterator[ClientConnection]:
    """The state websocket of a logged-in page, after its hello."""
    with connect(
        f"ws://127.0.0.1:{console.port}/api/state",
        origin=console.origin,
        additional_headers={"Cookie": cookie_of(client)},
        close_timeout=1.0,
    ) as socket:
        assert json.loads(socket.recv(timeout=patient(2.0)))["type"] == "hello"
        yield socket


def until(socket: ClientConnection, good: Callable[[State], object], timeout: float = 8.0) -> State:
    """The first state for which `good` holds."""
    deadline = time.monotonic() + patient(timeout)
    state: State = {}
    while time.monotonic() < deadline:
        state = json.loads(socket.recv(timeout=patient(2.0)))
        if state["type"] == "state" and good(state):
            return state
    raise AssertionError(f"not within {patient(timeout):g} s; the last state was {state}")


def complete(state: State) -> bool:
    """Everything of the stack has been found and heard."""
    streams = {s["key"]: s for s in state["streams"]}
    return (
        all(not streams[key]["stale"] for key in ("odometry", "scan", "map", "local_map"))
        and len(state["components"]) == 4
        and bool(state["drive"] and state["drive"]["available"])
        and state["robot"]["radius"] is not None
        and state["simulation"] is not None
    )


def gone(state: State) -> bool:
    """Nothing is heard of a stack."""
    streams = {s["key"]: s for s in state["streams"]}
    silent = all(
        streams[key]["age"] is None or streams[key]["stale"] for key in ("odometry", "scan")
    )
    # A STOP in the last words of one that has gone would be taken for the next one's.
    return silent and not (state["drive"] and state["drive"]["available"])


def seen(state: State) -> bool:
    """The robot is somewhere."""
    return bool(state["pose"] and state["pose"]["age"] < 0.2)


@pytest.fixture(scope="module")
def client(console: Served) -> Iterator[httpx.Client]:
    with console.client(Role.OPERATOR, user="ava") as client:
        yield client


@pytest.fixture
def socket(console: Served, client: httpx.Client) -> Iterator[ClientConnection]:
    with listening(console, client) as socket:
        yield socket


@pytest.fixture(scope="module")
def stack(request: pytest.FixtureRequest, console: Served, client: httpx.Client) -> Iterator[Stack]:
    """A stack, found by the console as far as it is there."""
    found = complete if "--no-drive" not in request.param else seen
    with listening(console, client) as socket:
        until(socket, gone)  # the one before: what is found must be of this one
        with running_stack(*request.param) as running:
            until(socket, found)
            yield running


def without_age(goal: Any) -> Any:
    """A goal as it was told, but for how long ago it ended."""
    return goal and {name: value for name, value in goal.items() if name != "ended"}


def ready(client: httpx.Client) -> None:
    """Wait until goals can be sent; the stack of the test before may still be leaving."""
    wait_until(
        lambda: client.post("/api/goals/check", json={"x": 0.6, "y": 0.6}).json()["ok"],
        8.0,
        "a goal is accepted",
    )


def send(client: httpx.Client, x: float, y: float) -> None:
    """Send the robot to a place (m) that it takes."""
    answer = client.post("/api/goals", json={"x": x, "y": y})
    assert answer.status_code == 200, answer.text


def test_nobody_hears_the_state_without_login(console: Served) -> None:
    with pytest.raises(InvalidStatus):
        connect(f"ws://127.0.0.1:{console.port}/api/state", origin=console.origin)


def test_a_state_comes_though_there_is_no_robot(socket: ClientConnection) -> None:
    state = until(socket, lambda _: True)
    assert state["pose"] is None or state["pose"]["age"] > 0.0
    assert {s["label"] for s in state["streams"]} >= {"Position", "Laser scan", "Map"}
    assert state["viewers"] == 1


@beside(*WHOLE)
def test_the_state_tells_all_of_the_robot(socket: ClientConnection, stack: Stack) -> None:
    state = until(socket, complete)
    assert state["robot"]["name"] == "test robot"
    assert state["robot"]["radius"] == pytest.approx(0.105, abs=1e-6)
    assert state["pose"]["x"] == pytest.approx(-0.75)
    assert state["pose"]["age"] < patient(0.2)
    labels = {c["name"]: (c["label"], c["status"]) for c in state["components"]}
    assert labels["drive_manager"] == ("Drive", "healthy")
    assert state["drive"]["standstill"]


def test_a_ping_is_answered_and_noise_is_not(socket: ClientConnection) -> None:
    socket.send("noise")
    socket.send(json.dumps({"type": "ping", "t": 12.5}))
    deadline = time.monotonic() + patient(2.0)
    while (answer := json.loads(socket.recv(timeout=patient(2.0))))["type"] != "pong":
        assert time.monotonic() < deadline
    assert answer == {"type": "pong", "t": 12.5}


@beside(*WHOLE)
def test_states_come_ten_times_a_second_at_most(socket: ClientConnection, stack: Stack) -> None:
    first = until(socket, lambda _: True)
    last = until(socket, lambda s: s["time"] > first["time"] + 1.5)
    rate = (last["seq"] - first["seq"]) / (last["time"] - first["time"])
    assert 2.0 <= rate <= 12.0


@beside(*WHOLE)
def test_a_goal_is_followed_until_it_arrives(
    socket: ClientConnection, client: httpx.Client, stack: Stack
) -> None:
    ready(client)
    sent = client.post("/api/goals", json={"x": 0.3, "y": -0.6, "yaw": 1.0}).json()
    assert (sent["topic"], sent["heading_used"]) == ("/goal_pose", True)
    state = until(socket, lambda s: s["goal"] and s["goal"]["phase"] == "driving")
    assert state["goal"]["id"] == sent["id"]
    assert state["goal"]["sent_by"] == "ava"
    assert state["goal"]["distance_left"] > 0.0
    assert state["goal"]["eta"] > 0.0
    state = until(socket, lambda s: s["goal"]["phase"] == "arrived" and s["goal"]["message"])
    state = until(socket, lambda s: s["goal"]["message"] == "Arrived.")
    assert state["goal"]["error"] < 0.05
    assert (state["goal"]["x"], state["goal"]["y"]) == (0.3, -0.6)


@beside(*WHOLE)
def test_a_canceled_goal_is_told_so(
    socket: ClientConnection, client: httpx.Client, stack: Stack
) -> None:
    ready(client)
    send(client, 3.0, 2.0)
    until(socket, lambda s: s["goal"] and s["goal"]["phase"] == "driving")
    assert client.post("/api/goals/cancel").status_code == 202
    until(socket, lambda s: s["goal"]["phase"] == "canceled" and "operator" in s["goal"]["message"])


@beside(*WHOLE)
def test_a_goal_that_cannot_be_reached_is_not_sent(
    socket: ClientConnection, client: httpx.Client, stack: Stack
) -> None:
    ready(client)
    answer = client.post("/api/goals/check", json={"x": 30.0, "y": 0.0}).json()
    assert (answer["ok"], answer["reason"]) == (False, "outside_map")
    assert answer["nearest"] == {"x": pytest.approx(3.2), "y": pytest.approx(0.0)}
    before = without_age(until(socket, lambda _: True)["goal"])
    refused = client.post("/api/goals", json={"x": 30.0, "y": 0.0})
    assert refused.status_code == 409
    assert refused.json()["detail"]["title"] == answer["message"]
    assert without_age(until(socket, lambda _: True)["goal"]) == before


@beside(*SLOW)
def test_a_goal_that_has_just_passed_is_sent_without_another_check(
    client: httpx.Client, stack: Stack
) -> None:
    slow = float(SLOW[1])
    ready(client)
    body = {"x": 0.7, "y": 0.6, "yaw": 0.0}
    assert client.post("/api/goals/check", json=body).json()["ok"]
    pressed = time.monotonic()
    assert client.post("/api/goals", json=body).status_code == 200
    assert time.monotonic() - pressed < slow
    pressed = time.monotonic()
    assert client.post("/api/goals", json={**body, "x": 0.75}).status_code == 200
    assert time.monotonic() - pressed >= slow  # this one was never checked


@beside(*WHOLE)
def test_stop_ends_the_drive_and_stays_until_released(
    socket: ClientConnection, client: httpx.Client, stack: Stack
) -> None:
    ready(client)
    send(client, 3.0, 2.0)
    until(socket, lambda s: s["goal"] and s["goal"]["phase"] == "driving")
    assert client.post("/api/stop", json={"reason": "test"}).json()["accepted"]
    state = until(socket, lambda s: s["drive"]["stopped"] and s["drive"]["standstill"])
    assert (state["drive"]["stopped_by"], state["drive"]["reason"]) == ("ava", "test")
    until(socket, lambda s: s["goal"]["phase"] == "failed" and "topped" in s["goal"]["message"])
    refused = client.post("/api/goals", json={"x": 0.6, "y": 0.6})
    assert refused.status_code == 409
    assert "release STOP" in refused.text.replace("Release", "release")
    assert client.post("/api/stop/release").json()["accepted"]
    until(socket, lambda s: not s["drive"]["stopped"])
    assert client.post("/api/goals", json={"x": -3.0, "y": 2.0}).status_code == 200
    until(socket, lambda s: s["goal"]["phase"] == "driving")
    assert client.post("/api/goals/cancel").status_code == 202
    until(socket, lambda s: s["goal"]["phase"] == "canceled")


@beside(*SLOW)
def test_a_release_that_waits_for_the_disk_is_awaited(
    socket: ClientConnection, client: httpx.Client, stack: Stack
) -> None:
    """The drive manager writes a release down before it answers; a STOP is answered at once."""
    pressing = lambda: client.post("/api/stop", json={}).is_success  # noqa: E731
    wait_until(pressing, 5.0, "the drive manager")
    released = client.post("/api/stop/release")
    assert released.is_success, released.text
    assert released.json()["accepted"], released.text
    until(socket, lambda s: not s["drive"]["stopped"])


@beside(*SLOW)
def test_stop_waits_for_nothing_else(console: Served, stack: Stack) -> None:
    with console.client(Role.VIEWER) as client:
        wait_until(
            lambda: client.post("/api/stop", json={}).status_code == 200, 5.0, "the drive manager"
        )
        checks = [threading.Thread(target=_check, args=(console,)) for _ in range(6)]
        for check in checks:
            check.start()
        # A press every 50 ms while checks are waiting: each is answered on its own. The median,
        # because a busy machine holds up a press now and then, and a queue would hold up all.
        times = []
        while any(check.is_alive() for check in checks):
            pressed = time.monotonic()
            client.post("/api/stop", json={})
            times.append(time.monotonic() - pressed)
            checks[0].join(0.05)
        assert statistics.median(times) < 0.75  # half of what a check takes
        assert len(times) > 2


@beside("--slow-checks", "1.5")
def test_a_goal_that_was_asked_for_before_a_stop_is_not_sent_after_its_release(
    socket: ClientConnection, client: httpx.Client, console: Served, stack: Stack
) -> None:
    wait_until(lambda: client.post("/api/stop/release").is_success, 5.0, "the drive manager")
    until(socket, lambda s: not s["drive"]["stopped"])
    answers: list[httpx.Response] = []

    def is_checked() -> bool:
        pressed = time.monotonic()
        client.post("/api/goals/check", json={"x": 0.6, "y": 0.6})
        return time.monotonic() - pressed > 1.0

    wait_until(is_checked, 8.0, "the console has found the planner, too")

    def ask() -> None:
        answers.append(client.post("/api/goals", json={"x": -0.6, "y": 0.55}))

    asking = threading.Thread(target=ask)
    asking.start()
    asking.join(0.3)  # the check takes five times as long
    with console.client(Role.OPERATOR, user="ben") as other:
        assert other.post("/api/stop", json={}).is_success
        asking.join(0.05)
        assert asking.is_alive(), "the goal was checked before STOP was pressed"
        assert other.post("/api/stop/release").is_success
    asking.join(10.0)
    assert answers[0].status_code == 409, answers[0].text
    detail = answers[0].json()["detail"]
    assert "after this goal was asked for" in detail["title"]
    assert "Send it again" in detail["remedy"]


def _check(console: Served) -> None:
    with console.client(Role.OPERATOR) as client:
        client.post("/api/goals/check", json={"x": 0.6, "y": 0.6})


@beside("--slow-checks", "3")
def test_a_planner_that_does_not_answer_is_said_not_to(client: httpx.Client, stack: Stack) -> None:
    answer: dict[str, Any] = {}

    def asked_it() -> bool:
        pressed = time.monotonic()
        answer.update(client.post("/api/goals/check", json={"x": 0.6, "y": 0.6}).json())
        return time.monotonic() - pressed > 1.5

    wait_until(asked_it, 8.0, "the console has found the planner")
    assert (answer["ok"], answer["reason"]) == (False, "no_planner")


@beside("--no-poses")
def test_a_program_that_takes_points_gets_points(
    socket: ClientConnection, client: httpx.Client, stack: Stack
) -> None:
    ready(client)
    body = {"x": -0.4, "y": -0.6, "yaw": 1.0}
    check = client.post("/api/goals/check", json=body).json()
    assert not check["heading_used"]
    assert "heading is not used" in check["note"]
    assert client.post("/api/goals", json=body).json()["topic"] == "/clicked_point"
    state = until(socket, lambda s: s["goal"] and s["goal"]["phase"] == "arrived")
    assert state["goal"]["yaw"] is None


@beside("--no-poses", "--onlookers")
def test_recorder_and_other_consoles_are_not_taken_for_who_wants_headings(
    client: httpx.Client, stack: Stack
) -> None:
    ready(client)
    body = {"x": -0.4, "y": -0.6, "yaw": 1.0}
    check = client.post("/api/goals/check", json=body).json()
    assert not check["heading_used"]
    assert client.post("/api/goals", json=body).json()["topic"] == "/clicked_point"


@beside(*TAKES_NO_GOALS, "--onlookers")
def test_who_only_hears_of_goals_is_nobody_to_send_one_to(
    client: httpx.Client, stack: Stack
) -> None:
    wait_until(
        lambda: (
            client.post("/api/goals/check", json={"x": 0.6, "y": 0.6}).json()["reason"]
            == "nobody_listens"
        ),
        5.0,
        "nobody takes goals",
    )


@beside(*TAKES_NO_GOALS)
def test_a_program_that_takes_no_goals_is_said_not_to(client: httpx.Client, stack: Stack) -> None:
    wait_until(
        lambda: (
            client.post("/api/goals/check", json={"x": 0.6, "y": 0.6}).json()["reason"]
            == "nobody_listens"
        ),
        5.0,
        "nobody listens",
    )


@beside("--no-planner", "--no-action")
def test_without_its_planner_a_goal_is_not_waved_through(
    client: httpx.Client, stack: Stack
) -> None:
    answer = client.post("/api/goals/check", json={"x": 0.6, "y": 0.6}).json()
    assert (answer["ok"], answer["reason"]) == (False, "no_planner")


@beside(*FOREIGN)
def test_on_another_stack_the_map_is_looked_at(tmp_path: Path, domain: int, stack: Stack) -> None:
    # A console that has never heard of a stack of ours.
    with serving(tmp_path / "audit", domain) as console, console.client(Role.OPERATOR) as client:
        ready(client)
        free = client.post("/api/goals/check", json={"x": 0.6, "y": 0.6}).json()
        assert "only the map" in free["note"]
        wall = client.post("/api/goals/check", json={"x": 1.5, "y": 1.2}).json()
        assert (wall["ok"], wall["reason"]) == (False, "occupied")
        away = client.post("/api/goals/check", json={"x": 90.0, "y": 1.2}).json()
        assert (away["ok"], away["reason"]) == (False, "outside_map")


@beside("--no-drive")
def test_without_a_drive_manager_stop_says_so_soon(
    tmp_path: Path, domain: int, stack: Stack
) -> None:
    # A console of its own: it goes on asking for this STOP.
    log = tmp_path / "audit"
    with serving(log, domain) as console, console.client(Role.OPERATOR) as client:
        pressed = time.monotonic()
        answer = client.post("/api/stop", json={})
        assert time.monotonic() - pressed < patient(1.5)  # it may only be being found
        assert answer.status_code == 503
        assert "emergency stop" in answer.json()["detail"]["remedy"]


@beside("--no-drive")
def test_a_stop_that_nobody_took_is_asked_for_again_until_a_drive_manager_is_there(
    tmp_path: Path, domain: int, stack: Stack
) -> None:
    log = tmp_path / "audit"
    with serving(log, domain) as console, console.client(Role.OPERATOR, user="ava") as client:
        answer = client.post("/api/stop", json={"reason": "a child"})
        assert answer.status_code == 503
        assert "asked for again" in answer.json()["detail"]["remedy"]
        come = running_stack("--no-planner", "--no-action", "--no-statuses")
        with come, listening(console, client) as socket:
            state = until(socket, lambda s: s["drive"] and s["drive"]["stopped"], 20.0)
            assert (state["drive"]["stopped_by"], state["drive"]["reason"]) == ("ava", "a child")
            late = lambda: "s after it was pressed" in str(console.audited())  # noqa: E731
            wait_until(late, 5.0, "the audit log's line")


@beside(*WHOLE)
def test_a_failing_component_is_told_with_its_reason(
    socket: ClientConnection, stack: Stack
) -> None:
    state = until(
        socket,
        lambda s: any(c["status"] == "system_failure" for c in s["components"]),
    )
    mapper = next(c for c in state["components"] if c["name"] == "mapper")
    assert (mapper["message"], mapper["sources"]) == ("No scan for 2 s.", ["/scan"])


@beside(*TAKES_NO_GOALS)
def test_silence_is_told_as_silence(socket: ClientConnection, stack: Stack) -> None:
    until(socket, complete)
    stack.terminate()  # nobody else comes to this one

    def all_silent(state: dict[str, Any]) -> bool:
        streams = {each["key"]: each for each in state["streams"]}
        components = all(each["status"] == "silent" for each in state["components"])
        return bool(
            components
            and streams["odometry"]["stale"]
            and not state["drive"]["available"]
            and state["pose"]["age"] > 0.5
        )

    # Each has a patience of its own.
    until(socket, all_silent)


@beside(*WHOLE)
def test_a_console_that_comes_later_finds_the_goal_that_runs(
    tmp_path: Path, domain: int, socket: ClientConnection, client: httpx.Client, stack: Stack
) -> None:
    ready(client)
    send(client, 3.0, 2.0)
    until(socket, lambda s: s["goal"] and s["goal"]["phase"] == "driving")
    with (
        serving(tmp_path / "second.jsonl", domain) as second,
        second.client(Role.OPERATOR) as late,
        listening(second, late) as heard,
    ):
        state = until(heard, lambda s: s["goal"] and s["goal"]["phase"] == "driving")
        assert state["goal"]["sent_by"] == "another program"
        state = until(heard, lambda s: s["goal"]["phase"] == "arrived")
        assert (state["goal"]["x"], state["goal"]["y"]) == pytest.approx((3.0, 2.0), abs=0.01)


@beside()
def test_a_goal_whose_planner_was_killed_is_told_as_lost_once_there_is_another(
    socket: ClientConnection, client: httpx.Client, stack: Stack
) -> None:
    ready(client)
    send(client, 3.0, 2.0)
    until(socket, lambda s: s["goal"] and s["goal"]["phase"] == "driving")
    stack.kill()
    with running_stack():
        state = until(socket, lambda s: s["goal"]["phase"] != "driving")
    assert state["goal"]["phase"] == "failed"
    assert "planner's process died" in state["goal"]["message"]
