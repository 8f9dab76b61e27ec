"""The robot's log over real DDS: what pages are told of it, and what a flood of it disturbs."""

from __future__ import annotations

import contextlib
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import pytest

from kompass_console.schema.roles import Role
from tests.console.conftest import Served, running_stack
from tests.console.test_link import listening, until
from tests.support.processes import wait_until
from tests.support.robot import Robot

pytestmark = pytest.mark.ros


@pytest.fixture
def robot(domain: int) -> Iterator[Robot]:
    robot = Robot(domain)
    yield robot
    robot.close()


def test_pages_read_what_nodes_log_and_who_is_not_logged_in_does_not(
    console: Served, robot: Robot
) -> None:
    with console.client(Role.VIEWER) as client, listening(console, client) as socket:
        said = until(socket, lambda state: state["log"]["available"])
        logger = robot.node.get_logger()
        logger.info("all is well")
        logger.warning("a\nb\x1b[2J")
        logger.error("<b>no</b> way")

        def lines(**query: Any) -> list[dict[str, Any]]:
            page = client.get("/api/log", params={"node": logger.name, **query}).json()
            return list(page["lines"])

        wait_until(lambda: len(lines()) == 3, 10.0, "all three lines")
        assert [(each["level"], each["text"]) for each in lines()] == [
            ("error", "<b>no</b> way"),
            ("warning", "a\nb [2J"),
            ("info", "all is well"),
        ]
        assert lines(level="error", text="WAY")[0]["where"].endswith(".py:" + where_of(lines()[0]))
        until(socket, lambda state: state["log"]["newest"] > said["log"]["newest"])
        for wrong in ({"level": "loud"}, {"count": 501}, {"after": -1}, {"text": "x" * 201}):
            assert client.get("/api/log", params=wrong).status_code == 422
    with console.client() as stranger:
        assert stranger.get("/api/log").status_code == 401


def where_of(line: dict[str, Any]) -> str:
    """Number of the line of code that wrote it."""
    return str(line["where"]).rpartition(":")[2]


@contextlib.contextmanager
def flooding(name: str) -> Iterator[subprocess.Popen[bytes]]:
    with subprocess.Popen([sys.executable, "-m", "tests.console.log_writer", name]) as process:
        try:
            yield process
        finally:
            process.kill()


def test_a_flood_is_counted_and_keeps_neither_stop_nor_errors_from_being_heard(
    console: Served,
) -> None:
    with running_stack(), console.client(Role.OPERATOR) as client:
        wait_until(lambda: client.post("/api/stop").status_code == 200, 30.0, "a drive manager")

        def page(**query: Any) -> dict[str, Any]:
            answer: dict[str, Any] = client.get("/api/log", params=query).json()
            return answer

        with flooding("babbler"):
            wait_until(
                lambda: sum(each["left_out"] for each in page(count=500)["lines"]) > 1000,
                30.0,
                "a flood that is counted",
            )
            before = page()["newest"]
            assert client.post("/api/stop").json()["accepted"]
            assert client.post("/api/stop/release").json()["accepted"]
            wait_until(
                lambda: page(node="babbler", level="error")["lines"], 30.0, "the error in it"
            )
            wait_until(lambda: page()["newest"] > before, 10.0, "that it goes on")
        assert len(page(count=500)["lines"]) <= 500
