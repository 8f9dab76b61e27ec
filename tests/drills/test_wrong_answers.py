"""A component that is well by its own account and says what is not so: what the robot does."""

from __future__ import annotations

import math
from typing import Any

import pytest
from geometry_msgs.msg import PoseStamped, Twist
from kompass_interfaces.msg import DriveState, TwistArray
from nav_msgs.msg import OccupancyGrid, Path
from std_msgs.msg import Bool, Float32MultiArray, Float64, Int16, String

from kompass.components.base.convert import quaternion_msg
from kompass.drills.scenario import ScheduledFault
from kompass.launch.wrong_answers import spoiler
from kompass.message_types import type_name
from kompass.virtual.wire import Packet
from tests.drills.test_runner import RECIPES, drive, scenario

pytestmark = pytest.mark.ros


def spoilt(message: Any) -> Any:
    """What arrives instead."""
    kind: Any = type(message)
    spoil = spoiler("/said", type_name(kind))
    assert spoil is not None
    return spoil(Packet.of(message)).message(kind)


def test_a_path_leads_elsewhere_from_where_the_robot_is() -> None:
    path = Path()
    for x in (1.0, 2.0, 3.0):
        pose = PoseStamped()
        pose.pose.position.x = x
        pose.pose.orientation = quaternion_msg(0.0)
        path.poses.append(pose)
    wrong = spoilt(path)
    places = [(each.pose.position.x, each.pose.position.y) for each in wrong.poses]
    assert places == [pytest.approx(place, abs=1e-9) for place in ((1, 0), (1, 1), (1, 2))]
    heading = wrong.poses[0].pose.orientation
    assert 2 * math.atan2(heading.z, heading.w) == pytest.approx(math.pi / 2)
    assert spoilt(Path()) == Path()


def test_commands_go_the_other_way_and_too_fast() -> None:
    twist = Twist()
    twist.linear.x, twist.angular.z = 0.2, -0.5
    wrong = spoilt(twist)
    assert (wrong.linear.x, wrong.angular.z) == (-0.4, 1.0)
    several = TwistArray(time_step=0.1)
    several.linear_velocities.x = [0.1, 0.2]
    wrong = spoilt(several)
    assert list(wrong.linear_velocities.x) == [-0.2, -0.4]
    assert wrong.time_step == pytest.approx(several.time_step)


def test_a_map_is_off_by_half_a_metre() -> None:
    grid = OccupancyGrid()
    grid.info.origin.position.x = 1.0
    origin = spoilt(grid).info.origin.position
    assert (origin.x, origin.y) == (1.5, 0.5)


def test_numbers_of_a_users_component_are_ten_times_too_large_and_fit_their_type() -> None:
    assert spoilt(Float64(data=1.5)).data == 15.0
    assert spoilt(Int16(data=7000)).data == 32767
    assert list(spoilt(Float32MultiArray(data=[1.0, 2.0])).data) == [10.0, 20.0]
    pose = PoseStamped()
    pose.header.stamp.sec, pose.pose.position.x = 5, 1.0
    wrong = spoilt(pose)
    assert (wrong.header.stamp.sec, wrong.pose.position.x) == (5, 10.0)


@pytest.mark.parametrize("kind", [DriveState, String, Bool])
def test_what_somebody_says_of_his_state_and_in_words_stays_what_it_is(kind: Any) -> None:
    assert spoiler("/said", type_name(kind)) is None


@pytest.mark.slow
@pytest.mark.parametrize("recipe", ["01_point_navigation.py", "03_events_and_actions.py"])
def test_a_controller_that_drives_the_wrong_way_drives_into_nothing(recipe: str) -> None:
    lying = ScheduledFault(name="wrong:controller", at=4.0)
    result = drive(scenario(lying, limit=25.0), RECIPES / recipe).result
    assert result.contacts == ()
    assert result.broken == ()
    assert any(fault.disturbed for fault in result.faults)
    # The gate holds it back, and somebody says so.
    assert any("obstacle" in one.text or "no progress" in one.text for one in result.moments)


@pytest.mark.slow
def test_a_path_through_walls_leads_into_none() -> None:
    lying = ScheduledFault(name="wrong:planner", at=1.0)
    result = drive(scenario(lying, limit=45.0)).result
    assert result.outcome not in ("arrived", "contact")
    assert any("no progress" in one.text for one in result.moments)


@pytest.mark.slow
def test_who_is_started_again_is_no_longer_wrong() -> None:
    faults = (
        ScheduledFault(name="wrong:controller", at=1.0),
        ScheduledFault(name="kill:controller", at=4.0),
    )
    assert drive(scenario(*faults, limit=60.0)).result.outcome == "recovered"
