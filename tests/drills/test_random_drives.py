"""Whatever happens to the stack, what must hold does: random drives in virtual time."""

from __future__ import annotations

import subprocess
import sys
import time

import pytest

from kompass.drills.scenario import Goal, Scenario, ScheduledFault
from tests.drills.random_drives import RECIPES, draw_drive
from tests.drills.test_runner import drive

BUDGET = 60.0  # s
MOST = 300
# Drives that once went wrong, and what they found.
FOUND = {
    2: "no edit was taken: whoever signs it had no key",
    5: "drove on for 0.6 s without a scan",
    12: "drove on for 0.6 s without odometry",
    16: "drove on for 0.6 s without a scan",
}
POINT_NAVIGATION = RECIPES / "01_point_navigation.py"


def drills(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "tests.drills.many_drives", "--jobs", "2", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.slow
@pytest.mark.parametrize("seed", FOUND)
def test_what_must_hold_does_in_a_drive_that_once_went_wrong(seed: int) -> None:
    done = drills("1", "--seed", str(seed))
    assert done.returncode == 0, f"{FOUND[seed]}: {done.stdout}{done.stderr}"


@pytest.mark.slow
def test_what_must_hold_does_in_as_many_random_drives_as_a_minute_has() -> None:
    # Other drives each day, and the same ones for all of it: a failure names its seed.
    first = 1000 * int(time.strftime("%Y%m%d"))
    done = drills(str(MOST), "--seed", str(first), "--seconds", str(BUDGET))
    assert done.returncode == 0, f"{done.stdout}{done.stderr}"


def test_a_seed_is_one_drive_whatever_was_drawn_before() -> None:
    once = [draw_drive(seed) for seed in range(20)]
    assert [draw_drive(seed) for seed in reversed(range(20))] == once[::-1]
    assert len({str(drive) for drive in once}) == 20


@pytest.mark.slow
def test_a_goal_that_gets_stuck_says_what_holds_the_robot_back() -> None:
    result = drive(
        Scenario(
            name="blind",
            world="hexagon",
            goals=(Goal(x=2.0, y=0.5, at=0.5),),
            faults=(ScheduledFault(name="lidar_unplugged", at=3.0),),
            limit=40.0,
        ),
        POINT_NAVIGATION,
    ).result
    assert result.outcome == "gave_up"
    assert result.goals[0].message.endswith("the drive manager holds the robot back: scan stale.")
    assert not result.broken
