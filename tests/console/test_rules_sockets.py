"""The rules' websockets: what fires is told, and conditions are judged while they are written."""

from __future__ import annotations

import contextlib
import json
import time
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from websockets import Origin
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

from kompass_console.schema.roles import Role
from tests.console.conftest import Served, cookie_of, running_stack
from tests.console.rules_client import Json, await_monitor, opened, running_monitor, table, until
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

LIVE, PROBE = "/api/rules/live", "/api/rules/probe"
SCAN = {"topic": "/scan", "type": "sensor_msgs/msg/LaserScan", "path": ["ranges"]}
NEAREST = {**SCAN, "aggregate": "min"}


def compare(signal: Json, operator: str, value: Any) -> Json:
    return {"kind": "compare", "signal": signal, "operator": operator, "value": value}


def probe(condition: Json | None, probe_id: str = "a", **more: Any) -> str:
    return json.dumps({"id": probe_id, "condition": condition, **more})


@pytest.fixture(scope="module")
def robot(console: Served) -> Iterator[Served]:
    """The console, a monitor, and a robot that scans."""
    with running_stack("--no-planner", "--no-action"), running_monitor():
        with console.client(Role.VIEWER) as client:
            await_monitor(client)
            with opened(console, "/api/state", client) as socket:
                until(socket, lambda m: m["type"] == "state" and _scans(m), 15.0)
        yield console


def _scans(state: Json) -> bool:
    return any(s["key"] == "scan" and not s["stale"] for s in state["streams"])


@contextlib.contextmanager
def page(console: Served, path: str, role: Role = Role.OPERATOR) -> Iterator[ClientConnection]:
    with console.client(role) as client, opened(console, path, client) as socket:
        yield socket


# -- who may ---------------------------------------------------------------------------------


@pytest.mark.parametrize("path", [LIVE, PROBE])
def test_strangers_and_other_pages_hear_nothing(robot: Served, path: str) -> None:
    with robot.client() as stranger, robot.client(Role.ENGINEER) as engineer:
        assert_refused(robot, path, cookie_of(stranger), robot.origin)
        assert_refused(robot, path, cookie_of(engineer), "http://evil.example")


def test_a_viewer_watches_the_rules_and_looks_into_no_topics(robot: Served) -> None:
    with page(robot, LIVE, Role.VIEWER) as socket:
        assert until(socket, lambda m: m["statuses"])["statuses"][0]["rule_id"] == "near"
    with robot.client(Role.VIEWER) as viewer:
        assert_refused(robot, PROBE, cookie_of(viewer), robot.origin)


def assert_refused(console: Served, path: str, cookie: str, origin: str) -> None:
    url = f"ws://127.0.0.1:{console.port}{path}"
    headers = {"Cookie": cookie} if cookie else {}
    with (
        pytest.raises(InvalidStatus, match="403"),
        connect(url, origin=Origin(origin), additional_headers=headers),
    ):
        pass


def test_whatever_a_viewer_sends_on_a_raw_socket_changes_nothing(robot: Served) -> None:
    with robot.client(Role.VIEWER) as client:
        before = kept(client)
        apply = json.dumps({"type": "apply", "table": {"rules": []}, "expected_revision": 1})
        for path in (LIVE, "/api/state"):
            with opened(robot, path, client) as socket:
                for text in (apply, probe(compare(NEAREST, "<", 9.0)), "{", "x" * 100_000):
                    socket.send(text)
                socket.send(b"\x00\xff")
                for _ in range(3):
                    socket.recv(timeout=3.0)  # it goes on
        assert kept(client) == before


def kept(client: httpx.Client) -> tuple[Json, Json]:
    """The table in force, and all revisions."""
    table: Json = client.get("/api/rules").json()["table"]
    history: Json = client.get("/api/rules/history").json()
    return table, history


# -- what fires ------------------------------------------------------------------------------


def test_an_edit_is_told_to_every_page(robot: Served) -> None:
    with page(robot, LIVE) as mine, page(robot, LIVE, Role.VIEWER) as other:
        until(mine, lambda m: m["available"])
        with robot.client(Role.OPERATOR) as client:
            before = client.get("/api/rules").json()["revision"]
            body = {"table": table(), "expected_revision": before}
            number = client.post("/api/rules/apply", json=body).json()["revision"]
            for socket in (mine, other):
                told = until(socket, lambda m: m["revision"] == number)
                assert (told["confirmed"], told["robot"]) == (before, "test robot")
                assert 50.0 < told["probation_left"] <= 60.0
            with opened(robot, "/api/state", client) as state:
                top = until(state, lambda m: m.get("rules", {}).get("revision") == number)["rules"]
                assert top["available"]
                assert top["probation_left"] > 50.0
                assert client.post("/api/rules/confirm", json={"revision": number}).is_success
                until(state, lambda m: m.get("rules", {}).get("confirmed") == number)


def test_every_step_of_a_firing_is_told_even_to_a_page_that_reads_slowly(robot: Served) -> None:
    with page(robot, LIVE) as slow, page(robot, LIVE) as fast:
        until(slow, lambda m: m["available"])
        until(fast, lambda m: m["available"])
        with robot.client(Role.ENGINEER) as client:
            told: list[Json] = []
            for _ in range(5):
                assert client.post("/api/rules/silent/reset").is_success
                told += _steps(fast, 3)
        assert [step["phase"] for step in told] == ["fired", "action", "done"] * 5
        assert _steps(slow, 15) == told


def _steps(socket: ClientConnection, count: int) -> list[Json]:
    steps: list[Json] = []
    while len(steps) < count:
        message = until(socket, lambda m: m["firings"])
        assert message["missed"] == 0
        steps += [step for step in message["firings"] if step["rule_id"] == "silent"]
    return steps


def test_alarms_are_told(robot: Served) -> None:
    with page(robot, LIVE) as socket:
        alarms = until(socket, lambda m: m["alarms"])["alarms"]
    assert [alarm["name"] for alarm in alarms] == ["low-battery"]
    with page(robot, "/api/state") as socket:
        assert until(socket, lambda m: m["type"] == "state")["rules"]["alarms"] == 1


def test_no_page_hears_more_than_five_times_a_second(robot: Served) -> None:
    with page(robot, LIVE) as socket, robot.client(Role.OPERATOR) as client:
        until(socket, lambda m: m["available"])
        heard, begun = 0, time.monotonic()
        while time.monotonic() < begun + 1.0:
            client.post("/api/rules/silent/reset")
            with contextlib.suppress(TimeoutError):
                socket.recv(timeout=0.01)
                heard += 1
        elapsed = time.monotonic() - begun
    assert 1 <= heard <= 5.0 * elapsed + 3  # those that were under way are read late


def test_health_has_processes_sources_and_ages_of_inputs(robot: Served) -> None:
    with page(robot, "/api/state") as socket:
        state = until(
            socket,
            lambda m: m["type"] == "state" and any(c["process"] for c in m["components"]),
        )
    planner = next(c for c in state["components"] if c["name"] == "planner")
    assert planner["process"] == {
        "name": "planner",
        "state": "busy",
        "pid": 77,
        "restarts": 2,
        "reason": "killed",
        "restarted": None,
        "cpu": None,  # nobody measures it here
        "memory": None,
    }
    assert "/scan" not in [each["topic"] for each in planner["inputs"]]  # it subscribes to none
    assert [process["name"] for process in state["processes"]] == ["planner"]


# -- conditions that are being written -------------------------------------------------------


def test_a_condition_is_judged_on_live_messages_as_it_is_written(robot: Served) -> None:
    with page(robot, PROBE) as socket:
        socket.send(probe(compare(NEAREST, "<", 100.0)))
        near = until(socket, lambda m: m["verdict"] is not None)
        leaf = near["leaves"][0]
        assert near["verdict"] is True
        assert leaf["text"] == "min(scan.ranges) < 100"
        assert 0.1 < leaf["value"] < 3.5
        assert 0.0 <= leaf["age"] < 1.0
        both = {
            "kind": "all",
            "conditions": [compare(NEAREST, "<", 100.0), compare(NEAREST, "<", 0.01)],
        }
        socket.send(probe(both, clear=compare(NEAREST, ">", 0.01)))
        told = until(socket, lambda m: len(m["leaves"]) == 2 and m["verdict"] is not None)
        assert [leaf["verdict"] for leaf in told["leaves"]] == [True, False]
        assert [leaf["path"] for leaf in told["leaves"]] == [[0], [1]]
        assert (told["verdict"], told["clear_verdict"]) == (False, True)


def test_silence_is_unknown_and_asked_for_it_is_true(robot: Served) -> None:
    nobody = {"topic": "/nobody", "type": "std_msgs/msg/Bool", "path": ["data"]}
    with page(robot, PROBE) as socket:
        socket.send(probe(compare(nobody, "==", True)))
        silent = until(socket, lambda m: m["leaves"])
        assert (silent["verdict"], silent["leaves"][0]["age"], silent["error"]) == (None, None, "")
        socket.send(probe({"kind": "absent", "signal": nobody, "seconds": 0.5}, "b"))
        assert until(socket, lambda m: m["id"] == "b" and m["verdict"])["error"] == ""


def test_a_rate_is_measured_without_its_type_being_named(robot: Served) -> None:
    with page(robot, PROBE) as socket:
        socket.send(probe({"kind": "rate", "topic": "/scan", "above": 2.0, "window": 1.0}))
        told = until(socket, lambda m: m["verdict"])
        assert 2.0 < told["leaves"][0]["value"] < 20.0


@pytest.mark.parametrize(
    ("condition", "words"),
    [
        (compare({**NEAREST, "path": ["rangs"]}, "<", 1.0), "ranges"),
        (compare({**NEAREST, "type": "std_msgs/msg/Bool", "path": ["data"]}, "<", 1.0), "list"),
        (
            compare({**SCAN, "type": "std_msgs/msg/Float32", "path": ["data"]}, "<", 1.0),
            "LaserScan",
        ),
        (compare({**SCAN, "type": "no_such/msg/Thing"}, "<", 1.0), "no such message type"),
        (compare({**SCAN, "path": ["header", "frame_id"]}, "<", 1.0), "text"),
        ({"kind": "compare", "signal": SCAN, "operator": "<"}, "value"),
        ({"kind": "nonsense"}, "kind"),
        ({"kind": "not", "condition": {"kind": "received", "signal": SCAN}}, "absent"),
    ],
)
def test_what_is_wrong_with_a_condition_is_said_and_the_socket_stays(
    robot: Served, condition: Json, words: str
) -> None:
    with page(robot, PROBE) as socket:
        socket.send(probe(condition))
        wrong = until(socket, lambda m: m["error"])
        assert (wrong["id"], wrong["verdict"]) == ("a", None)
        assert words in wrong["error"]
        socket.send(probe(compare(NEAREST, "<", 100.0)))
        assert until(socket, lambda m: m["verdict"])["error"] == ""


def test_a_page_may_look_at_a_dozen_conditions_and_not_at_more(robot: Served) -> None:
    with page(robot, PROBE) as socket:
        for number in range(13):
            socket.send(probe(compare(NEAREST, "<", 100.0), str(number)))
        assert "At most 12" in until(socket, lambda m: m["error"])["error"]
        socket.send(probe(None, "0"))
        socket.send(probe(compare(NEAREST, "<", 100.0), "12"))
        until(socket, lambda m: m["id"] == "12" and m["verdict"])


def test_no_message_on_the_socket_brings_the_console_down(robot: Served) -> None:
    with page(robot, PROBE) as socket:
        for text in ("", "{", "null", "x" * 200_000, '{"condition":' * 500, probe(None)):
            socket.send(text)
        socket.send(b"\x00")
        deep: Json = compare(NEAREST, "<", 100.0)
        for _ in range(300):
            deep = {"kind": "not", "condition": deep}
        socket.send(probe(deep))
        socket.send(probe(compare(NEAREST, "<", 100.0), "b"))
        until(socket, lambda m: m["id"] == "b" and m["verdict"])


def test_topics_are_let_go_when_nobody_looks_any_more(robot: Served) -> None:
    import rclpy
    from rclpy.context import Context

    context = Context()
    rclpy.init(args=[], context=context)
    node = rclpy.create_node("onlooker", context=context)
    battery = {"topic": "/battery", "type": "std_msgs/msg/Float32", "path": ["data"]}
    try:
        with page(robot, PROBE) as socket:
            socket.send(probe(compare(battery, "<", 0.1)))
            wait_until(lambda: node.count_subscribers("/battery") == 1, 5.0, "the console listens")
        wait_until(lambda: node.count_subscribers("/battery") == 0, 10.0, "it has let go")
    finally:
        node.destroy_node()
        rclpy.shutdown(context=context)
