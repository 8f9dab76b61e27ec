"""The room that a test of the base needs is that of the whole body, all along its legs."""

import math
from pathlib import Path

import numpy as np
import pytest

from kompass.algorithms.following.limits import Limits
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.safety.velocity_limiter import VelocityLimits
from kompass.components import MotionServer
from kompass.components.drive.leg import least_gap, read_legs, swept
from kompass.components.motion.legs import circle_legs, step_legs
from kompass.components.motion.recording import MotionRecording, NotRecorded
from kompass.robot import RobotType
from kompass.ros import Topic

LIMITS = VelocityLimits(
    vx=Limits(0.4, 1.0, 1.0), vy=Limits(0.2, 1.0, 1.0), omega=Limits(2.0, 4.0, 4.0)
)
ROUND = Footprint.circle(0.1)
LONG = Footprint(np.array([[0.4, 0.1], [-0.4, 0.1], [-0.4, -0.1], [0.4, -0.1]]))


def gap(rows: list[list[float]], point: tuple[float, float], body: Footprint) -> float:
    legs = read_legs(rows, LIMITS)
    return least_gap(swept(legs, LIMITS), np.array([point]), body, 0.2)


def test_the_way_to_rest_needs_room_too() -> None:
    ahead = [[0.4, 0.0, 0.0, 1.0]]
    # 0.4 m in the time, 0.12 m late, 0.08 m of braking, and the body.
    assert gap(ahead, (0.8, 0.0), ROUND) == pytest.approx(0.8 - 0.6 - 0.1, abs=0.005)
    assert gap(ahead, (-0.3, 0.0), ROUND) == pytest.approx(0.2, abs=0.005)


def test_corners_that_turn_need_room() -> None:
    turn = [[0.0, 0.0, 1.0, 3.0]]
    assert gap(turn, (0.0, 0.45), LONG) == pytest.approx(0.45 - math.hypot(0.4, 0.1), abs=0.01)
    assert gap([[0.2, 0.0, 0.0, 1.0]], (0.0, 0.45), LONG) >= 0.2


@pytest.mark.parametrize("kind", RobotType)
def test_after_a_test_the_robot_is_where_it_was(kind: RobotType) -> None:
    for rows in (step_legs(LIMITS, kind, 2.0), circle_legs(LIMITS, 2.0)):
        still = read_legs([*map(list, rows), [0.0, 0.0, 0.0, 1.0]], LIMITS)
        assert swept(still, LIMITS)[-1] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


def test_only_what_the_robot_can_is_driven() -> None:
    moved = {kind: np.abs(step_legs(LIMITS, kind, 2.0)).max(axis=0) > 0 for kind in RobotType}
    assert moved[RobotType.OMNI].tolist() == [True, True, True, True]
    assert moved[RobotType.DIFFERENTIAL_DRIVE].tolist() == [True, False, True, True]
    assert moved[RobotType.ACKERMANN].tolist() == [True, False, False, True]


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ([], "no legs"),
        ([[0.1, 0.0, 1.0]], "leg 1 is"),
        ([[0.1, 0.0, math.nan, 1.0]], "leg 1 is"),
        ([[0.1, 0.0, 0.0, 1.0], [0.5, 0.0, 0.0, 1.0]], "leg 2: vx = 0.5 is beyond the robot's 0.4"),
        ([[0.1, 0.0, 0.0, 61.0]], "seconds = 61"),
        ([[0.0, 0.0, 0.0, 60.0]] * 6, "take 360 s"),
        ([[0.0, 0.0, 0.0, 0.01]] * 41, "there are 41 legs; give at most 40"),
    ],
)
def test_what_is_no_leg_is_refused(rows: list[list[float]], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        read_legs(rows, LIMITS)


def test_the_topics_of_older_recipes_are_taken_and_the_way_past_the_gate_is_not(
    caplog: pytest.LogCaptureFixture,
) -> None:
    server = MotionServer(
        component_name="tests_of_the_base",
        robot_cmd_topic=Topic(name="/told", msg_type="TwistStamped"),
        robot_odom_topic=Topic(name="/odometry/filtered", msg_type="Odometry"),
        outputs={"robot_command": Topic(name="/cmd_vel", msg_type="Twist")},
    )
    assert server.in_topic_name("command") == "told"
    assert server.in_topic_name("location") == "odometry/filtered"
    assert server.outputs_keys == []
    assert "past which there is no way to the wheels" in caplog.text
    with pytest.raises(ValueError, match="'plan' is not an output"):
        server.outputs(plan=Topic(name="/plan", msg_type="Path"))


def test_a_folder_that_is_full_of_other_tables_takes_no_more(tmp_path: Path) -> None:
    recording = MotionRecording(0.0)
    recording.measured(0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    for name in ("a", "motion-1", "motion-2"):
        recording.write(tmp_path, name, 3)
    recording.write(tmp_path, "b", 3)
    assert sorted(path.stem for path in tmp_path.iterdir()) == ["a", "b", "motion-2"]
    with pytest.raises(NotRecorded, match="is there already"):
        recording.write(tmp_path, "b", 100)
    recording.write(tmp_path, "c", 3)
    with pytest.raises(NotRecorded, match="most_recordings = 3"):
        recording.write(tmp_path, "d", 3)
