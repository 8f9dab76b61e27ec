"""The socket of the hand: who may drive, and what becomes of a page that goes, hangs or lies."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

import pytest
from websockets import Origin
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

from kompass_console.control.lease import AWAY
from kompass_console.schema.roles import Role
from tests.console.conftest import Served, cookie_of, running_stack
from tests.console.rules_client import Json, opened, until
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

HAND = "/api/hand"


@pytest.fixture(scope="module")
def robot(console: Served) -> Iterator[Served]:
    """The console, and a robot that obeys the last command for ever."""
    with running_stack():
        with console.client(Role.VIEWER) as client, opened(console, "/api/state", client) as socket:
            until(socket, lambda m: m["type"] == "state" and m["drive"] and m["pose"], 20.0)
        yield console


class Page:
    """A page with the panel open, and its view of the robot."""

    def __init__(self, socket: ClientConnection, states: ClientConnection) -> None:
        self.socket, self.states = socket, states

    def say(self, kind: str, **more: Any) -> None:
        self.socket.send(json.dumps({"type": kind} | more))

    def drive(self, vx: float, t: float | None = None) -> None:
        self.say("drive", vx=vx, t=time.monotonic() if t is None else t)

    def answer(self, **expected: Any) -> Json:
        """The first answer with these values."""
        return until(self.socket, lambda m: all(m[name] == expected[name] for name in expected))

    def take(self, kind: str = "take") -> Json:
        self.say(kind)
        return self.answer(yours=True)

    def take_when_free(self) -> None:
        """Take the wheel as soon as control of whoever has gone has lapsed."""

        def taken() -> bool:
            self.say("take")
            answer = until(self.socket, lambda m: m["yours"] or m["message"])
            return bool(answer["yours"])

        wait_until(taken, 2 * AWAY, "the wheel")

    def robot(self, speed: float | None = None, driver: str | None = None) -> Json:
        """The robot's state once it moves so fast, and is driven by so and so."""

        def fits(state: Json) -> bool:
            return (
                state["type"] == "state"
                and (speed is None or state["pose"]["v"] == speed)
                and (driver is None or state["drive"]["driven_by"] == driver)
            )

        return until(self.states, fits)

    def moving(self, vx: float = 0.2) -> None:
        """Drive until the robot does."""
        for _ in range(100):
            self.drive(vx)
            with contextlib.suppress(TimeoutError):
                state = json.loads(self.states.recv(timeout=0.05))
                if state["type"] == "state" and state["pose"]["v"] == vx:
                    return
        raise AssertionError("the robot does not move")


@contextlib.contextmanager
def page(
    robot: Served, name: str, role: Role = Role.OPERATOR, *, logs_out: bool = True
) -> Iterator[Page]:
    with robot.client(role, user=name) as client:
        with opened(robot, HAND, client) as socket, opened(robot, "/api/state", client) as states:
            yield Page(socket, states)
        if logs_out:
            client.post("/api/logout")


@pytest.mark.parametrize(
    ("role", "origin"),
    [(None, None), (Role.VIEWER, None), (Role.ENGINEER, "http://evil.example")],
    ids=["stranger", "viewer", "another site"],
)
def test_who_may_not_drive_gets_no_socket(
    robot: Served, role: Role | None, origin: str | None
) -> None:
    with robot.client(role) as client:
        cookie = cookie_of(client)
    headers = {"Cookie": cookie} if cookie else {}
    with (
        pytest.raises(InvalidStatus, match="403"),
        connect(
            f"ws://127.0.0.1:{robot.port}{HAND}",
            origin=Origin(origin or robot.origin),
            additional_headers=headers,
        ),
    ):
        pass


def test_an_operator_takes_the_wheel_drives_and_gives_it_up_and_the_log_knows(
    robot: Served,
) -> None:
    with page(robot, "ava") as ava:
        assert ava.take()["max_vx"] == pytest.approx(0.4)
        ava.moving()
        assert ava.robot()["drive"]["driven_by"] == "ava"
        with robot.client(Role.OPERATOR) as client:
            refused = client.post("/api/goals", json={"x": -0.75, "y": 0.6})
        assert refused.status_code == 409
        assert refused.json()["detail"]["title"] == "ava drives by hand."
        ava.say("give")
        ava.answer(yours=False)
        ava.robot(speed=0.0, driver="")
    deeds = [(line["who"], line["what"], line["outcome"]) for line in robot.audited()]
    assert ("ava", "take the wheel", "taken") in deeds
    assert ("ava", "give up the wheel", "given up") in deeds


def test_a_page_that_falls_silent_has_the_robot_told_to_stand_and_loses_the_wheel(
    robot: Served,
) -> None:
    with page(robot, "ava") as ava:
        ava.take()
        ava.moving()
        ava.robot(speed=0.0, driver="ava")
        ava.answer(
            message="The wheel was lost: nothing was heard of this page for 5 s. Take it again."
        )
        ava.drive(0.2)
        assert ava.robot(driver="")["pose"]["v"] == 0.0


def test_a_page_that_is_closed_leaves_a_robot_that_stands_and_a_free_wheel(robot: Served) -> None:
    with page(robot, "ben") as ben:
        with page(robot, "ava", logs_out=False) as ava:
            ava.take()
            ava.moving()
            ben.robot(driver="ava")
        ben.robot(speed=0.0, driver="")
        ben.take_when_free()
        ben.say("give")
        ben.robot(driver="")


def test_what_a_page_said_long_ago_does_not_drive(robot: Served) -> None:
    with page(robot, "ava") as ava:
        ava.take()
        yaw = ava.robot(driver="ava")["pose"]["yaw"]
        now = time.monotonic()
        ava.drive(0.0, now)
        ava.say("drive", omega=0.5, t=now - 1.0)  # it lay in a socket while the console was held
        ava.say("ask")
        ava.answer(message="ava has been asked.")  # so it has been looked at
        assert {round(ava.robot()["pose"]["yaw"] - yaw, 3) for _ in range(8)} == {0.0}
        ava.say("drive", omega=0.5, t=time.monotonic())  # and what has just been said
        until(ava.states, lambda state: abs(state["pose"]["yaw"] - yaw - 0.5) < 1e-3)
        ava.say("give")
        ava.robot(driver="")


def test_one_drives_and_others_ask_and_only_an_engineer_takes_over(robot: Served) -> None:
    with (
        page(robot, "ava") as ava,
        page(robot, "ben") as ben,
        page(robot, "eve", Role.ENGINEER) as eve,
    ):
        ava.take()
        ava.moving()
        ben.robot(driver="ava")
        ben.answer(yours=False)
        ben.say("take")
        assert "ava has control" in ben.answer(yours=False)["message"]
        ben.say("ask")
        assert ben.answer(yours=False)["message"] == "ava has been asked."
        assert ava.answer(asked_by="ben")["yours"]
        ben.say("take over")
        assert "Only an engineer" in ben.answer(yours=False)["message"]
        eve.take("take over")
        assert "eve" in ava.answer(yours=False)["message"]
        ava.drive(0.2)
        assert eve.robot(driver="eve")
        eve.say("give")
        eve.robot(speed=0.0, driver="")


@pytest.mark.parametrize(
    "text",
    [
        "", "{", "null", "[]", '{"type": "steal"}', '{"type": "drive", "vx": 1e999}',
        '{"type": "drive", "vx": "fast"}', '{"type": "drive", "t": NaN}', "[" * 300,
        '{"type": "drive", "vx": 1e300}', '{"type": "take", "who": "root"}',
    ],
)  # fmt: skip
def test_nonsense_is_answered_and_drives_nothing(robot: Served, text: str) -> None:
    with page(robot, "ava") as ava:
        ava.answer(yours=False)
        ava.socket.send(text)
        assert "reload the page" in ava.answer(yours=False)["message"]
        assert ava.robot()["pose"]["v"] == 0.0


# Says when the console has found it.
STRANGER = """
import rclpy
from kompass_interfaces.srv import TakeWheel
rclpy.init()
node = rclpy.create_node("stranger")
node.create_service(TakeWheel, "/aaa/take_wheel", lambda request, response: response)
told = False
while True:
    rclpy.spin_once(node, timeout_sec=0.05)
    if not told and node.count_clients("/aaa/take_wheel"):
        told = True
        print("found", flush=True)
"""


def test_a_wheel_that_a_stranger_offers_is_not_taken_for_the_robots(robot: Served) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", STRANGER], stdout=subprocess.PIPE, text=True
    ) as stranger:
        try:
            assert stranger.stdout is not None
            assert stranger.stdout.readline() == "found\n"
            with page(robot, "ava") as ava:
                assert ava.take()["max_vx"] == pytest.approx(0.4)
                ava.moving()
        finally:
            stranger.kill()
