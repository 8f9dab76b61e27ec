"""What the flight recorder has of a faulted drive on DDS becomes a scenario that goes the same."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from kompass_interfaces.srv import SaveRecording

from kompass.backtest.event_log import Fired
from kompass.drills.report_json import read_report
from kompass.drills.scenario_file import read_scenario
from kompass.recorder.mcap.reader import Recording, messages
from kompass.recorder.replay.explain import explain_recorded
from kompass.recorder.streams import EVENTS, read_event
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import Stack

pytestmark = pytest.mark.ros

RECIPE = Path(__file__).parents[1] / "drills" / "recipes" / "slow_functions.py"
GOAL = (-1.5, 0.5)
BROKEN = 5.0  # s
ROBOT = "turtlebot3-plus"  # not the usual one


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    with closing(Stack.simulated("--robot", ROBOT, recipe=RECIPE)) as running:
        yield running


def cli(*arguments: str) -> subprocess.CompletedProcess[str]:
    """``kompass-console drill …``."""
    command = [str(Path(sys.executable).with_name("kompass-console")), "drill", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ})


@pytest.fixture(scope="module")
def recording(stack: Stack, robot: Robot) -> Path:
    """The robot is sent to a place, loses its lidar on the way, and arrives."""
    robot.ready()
    robot.wait_for_listeners("/clicked_point", "planner", "monitor")
    robot.click(*GOAL, taker="planner")
    away = robot.distance_to(*GOAL)
    wait_until(lambda: robot.distance_to(*GOAL) < away - 0.2, 30, "that it has set off")
    robot.fault("lidar_unplugged", duration=BROKEN)
    wait_until(lambda: robot.distance_to(*GOAL) < 0.12, 60, "arrival at the clicked point")
    request = SaveRecording.Request(name="drive")
    saved = robot.call(SaveRecording, "/monitor/save_recording", request, timeout=30.0)
    assert saved.success, saved.message
    return Path(saved.path)


def test_a_recorded_drive_is_drilled_with_the_same_outcome_and_the_same_rules(
    recording: Path, tmp_path: Path
) -> None:
    with Recording([recording]) as opened:
        found = messages(opened.files, lambda track: track.source == EVENTS.source)
        all_events = [read_event(message.data).event for message in found]
    fired = [event.rule_id for event in all_events if isinstance(event, Fired)]
    assert fired[:2] == ["clicked", "blind"]

    scenario, report = tmp_path / "drive.yaml", tmp_path / "report.json"
    done = cli("scenario", str(recording), "-o", str(scenario))
    assert done.returncode == 0, done.stderr
    made = read_scenario(scenario)
    assert (made.world, made.robot) == ("hexagon", ROBOT)
    (goal,) = made.goals
    assert (goal.x, goal.y, goal.topic) == (*GOAL, "/clicked_point")
    (fault,) = made.faults
    assert fault.name == "lidar_unplugged"
    assert fault.duration == pytest.approx(BROKEN, abs=0.5)

    done = cli(str(RECIPE), "--scenarios", str(scenario), "--json", str(report))
    assert done.returncode == 0, done.stdout + done.stderr
    (drive,) = read_report(report.read_text()).drives
    assert drive.outcome == "recovered"
    assert [firing.rule_id for firing in drive.firings] == fired


def test_rules_are_explained_from_the_recording_of_a_robot(recording: Path) -> None:
    end, _ = explain_recorded(recording, "blind")
    assert end.text.startswith("false: controller/status.status == 3")
    run = 2  # the click was the first
    assert explain_recorded(recording, "blind", run=run).view.firing is not None
    done = subprocess.run(
        [
            *(str(Path(sys.executable).with_name("kompass-console")), "rules", "explain", "blind"),
            *("--recording", str(recording), "--run", str(run), "--json"),
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(done.stdout)["firing"]["rule_id"] == "blind"
