"""A mission goes on without its console, and waits for a person when the robot's program died."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import closing
from typing import Any

import httpx
import pytest
from std_msgs.msg import String

from kompass.missions.queue import MissionState
from kompass.missions.run import Run
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot
from tests.support.stack import TOKEN, Stack

pytestmark = pytest.mark.ros

PLACES = {"Gate": (0.55, -0.55), "Wall": (0.55, 0.55), "Dock": (-0.55, 0.55)}


@pytest.fixture
def robot(stack: Stack) -> Iterator[Robot]:
    with closing(Robot(stack.domain)) as client:
        client.subscribe(String, "/monitor/mission_state", LATCHED)
        client.ready()
        yield client


def state(robot: Robot) -> MissionState:
    return MissionState.model_validate_json(robot.newest["/monitor/mission_state"].data)


def run(robot: Robot) -> Run:
    found = state(robot).run
    assert found is not None
    return found


def asked(console: httpx.Client, method: str, path: str, **body: Any) -> Any:
    """What is answered; asked again until the console that was just started can."""
    answers: list[httpx.Response] = []

    def good() -> bool:
        answers.append(console.request(method, path, json=body))
        return answers[-1].is_success

    wait_until(good, 20, f"{method} {path}")
    return answers[-1].json() if answers[-1].content else None


def test_a_killed_console_holds_no_mission_up_and_a_killed_monitor_pauses_it(
    stack: Stack, robot: Robot
) -> None:
    with httpx.Client(
        base_url=stack.url, headers={"Origin": stack.url}, timeout=patient(10.0)
    ) as console:
        asked(console, "POST", "/api/login", token=TOKEN, user="ava")
        saved = [
            asked(console, "POST", "/api/places", name=name, pose={"x": x, "y": y})
            for name, (x, y) in PLACES.items()
        ]
        waypoints = [{"place": place["id"]} for place in saved]
        mission = asked(console, "POST", "/api/missions", name="Round", waypoints=waypoints)
        asked(console, "POST", f"/api/missions/{mission['id']}/start", version=1)
        wait_until(lambda: robot.speed > 0.1, 20, "motion")

        os.kill(stack.pid_of("console"), signal.SIGKILL)
        wait_until(lambda: run(robot).waypoint == 1, 60, "the second place")
        assert robot.distance_to(*PLACES["Gate"]) < 0.3
        wait_until(lambda: robot.distance_to(*PLACES["Gate"]) > 0.3, 20, "the way to it")

        killed = stack.pid_of("monitor")
        robot.newest.pop("/monitor/mission_state")
        os.kill(killed, signal.SIGKILL)
        wait_until(lambda: "/monitor/mission_state" in robot.newest, 20, "another monitor")
        found = run(robot)
        assert (found.phase, found.waypoint, found.by) == ("paused", 1, "ava")
        assert "ended while it was driving" in found.reason
        wait_until(
            lambda: robot.distance_to(*PLACES["Wall"]) < 0.15, 60, "the goal that was under way"
        )
        wait_until(lambda: robot.speed < 0.01, 5, "a standstill")

        # The page comes back by itself, and a person resumes.
        asked(console, "POST", "/api/login", token=TOKEN, user="ben")
        asked(console, "POST", f"/api/missions/run/{found.number}/resume", step=found.step)
        wait_until(lambda: run(robot).phase == "done", 90, "the end of the mission")
        assert robot.distance_to(*PLACES["Dock"]) < 0.15
        assert robot.contacts == 0
