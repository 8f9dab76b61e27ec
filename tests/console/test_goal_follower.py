"""A goal is followed to its end, whoever sent it and whatever carries it out."""

import math

import numpy as np
import pytest

from kompass_console.link.goals.goal_follower import (
    ABORTED,
    CANCELED,
    EXECUTING,
    SUCCEEDED,
    ActionStatus,
    Ending,
    GoalFollower,
    length_left,
)
from kompass_console.schema.models import GoalInfo
from kompass_console.schema.world import HindranceMark, Latest, Pose, RobotMotion, WorldModel

ACTION = "/planner/plan_path"


SENT = 5000.0  # ROS time


def at(status: int, accepted: float = SENT - 60.0) -> ActionStatus:
    return ActionStatus(status, accepted)


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def world() -> WorldModel:
    world = WorldModel()
    world.motion.set(RobotMotion(Pose(0.0, 0.0, 0.0), 0.0, 0.0, 0.0))
    return world


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def follower(world: WorldModel, clock: Clock) -> GoalFollower:
    return GoalFollower(world, lambda: None, now=clock)


def info(follower: GoalFollower) -> GoalInfo:
    found = follower.info()
    assert found is not None
    return found


def send(follower: GoalFollower, x: float = 2.0, y: float = 0.0) -> None:
    follower.sent("mine", x, y, None, by="ava", speed=0.5, stamp=SENT)


def line_to(world: WorldModel, x: float, y: float = 0.0) -> None:
    world.path.set(np.column_stack([np.linspace(0.0, x, 21), np.linspace(0.0, y, 21)]))


def test_a_goal_goes_from_sent_to_arrived(follower: GoalFollower, world: WorldModel) -> None:
    send(follower)
    assert info(follower).phase == "sent"
    assert follower.statuses(ACTION, {"a1": at(EXECUTING)}) == ["a1"]
    assert info(follower).phase == "accepted"
    line_to(world, 2.0)
    follower.tick(action_there=True)
    assert info(follower).phase == "driving"
    assert info(follower).distance_left == pytest.approx(2.0)
    assert info(follower).eta == pytest.approx(4.0)
    world.motion.set(RobotMotion(Pose(1.96, 0.0, 0.0), 0.0, 0.0, 1.0))
    follower.result("a1", Ending(SUCCEEDED, "Arrived."))
    ended = info(follower)
    assert (ended.phase, ended.message, ended.id) == ("arrived", "Arrived.", "mine")
    assert ended.error == pytest.approx(0.04)
    goal = world.goal.get()
    assert goal is not None
    assert goal.value is None  # and its mark is taken off the floor


@pytest.mark.parametrize(
    ("status", "phase"), [(SUCCEEDED, "arrived"), (CANCELED, "canceled"), (ABORTED, "failed")]
)
def test_the_planner_says_how_it_ended(follower: GoalFollower, status: int, phase: str) -> None:
    send(follower)
    follower.statuses(ACTION, {"a1": at(EXECUTING)})
    follower.statuses(ACTION, {"a1": at(status)})
    follower.result("a1", Ending(status, "because"))
    assert info(follower).phase == phase


def test_the_reason_arrives_after_the_status(follower: GoalFollower) -> None:
    send(follower)
    follower.statuses(ACTION, {"a1": at(EXECUTING)})
    follower.result("a1", Ending(ABORTED, "The way closed."))
    assert info(follower).message == "The way closed."


def test_a_goal_whose_planner_is_gone_has_failed_and_says_why(follower: GoalFollower) -> None:
    send(follower)
    follower.statuses(ACTION, {"a1": at(EXECUTING)})
    follower.lost("a2")
    assert info(follower).phase == "accepted", "of another goal"
    follower.lost("a1")
    assert info(follower).phase == "failed"
    assert "planner's process died" in info(follower).message
    follower.statuses(ACTION, {"a1": at(EXECUTING)})
    assert info(follower).phase == "failed"


def test_a_goal_of_a_mission_that_is_refused_has_its_place_and_its_sender(
    world: WorldModel, clock: Clock
) -> None:
    def sender(x: float, y: float) -> str:
        return "mission Round" if (x, y) == (1.8, 1.5) else ""

    follower = GoalFollower(world, lambda: None, sender=sender, now=clock)
    follower.reported(0.3, 0.3, None, SENT - 60.0)  # of the goal before
    follower.statuses(ACTION, {"a1": at(EXECUTING, SENT)})
    follower.reported(1.8, 1.5, None, SENT + 0.01)
    follower.result("a1", Ending(ABORTED, "The goal (1.80, 1.50) is inside an obstacle."))
    ended = info(follower)
    assert (ended.phase, ended.x, ended.y) == ("failed", 1.8, 1.5)
    assert ended.sent_by == "mission Round"
    # The report may come before the status, and another goal is none of the mission's.
    follower.reported(0.5, 0.2, 1.0, SENT + 70.0)
    follower.statuses(ACTION, {"a2": at(EXECUTING, SENT + 70.0)})
    other = info(follower)
    assert (other.x, other.y, other.yaw, other.sent_by) == (0.5, 0.2, 1.0, "another program")


def test_what_a_planner_reports_does_not_move_a_goal_of_ours(follower: GoalFollower) -> None:
    send(follower)
    follower.statuses(ACTION, {"a1": at(EXECUTING, SENT)})
    follower.reported(0.5, 0.2, None, SENT)
    assert (info(follower).x, info(follower).sent_by) == (2.0, "ava")


def test_a_goal_nobody_takes_fails_after_a_while(follower: GoalFollower, clock: Clock) -> None:
    send(follower)
    clock.now += 3.0
    follower.tick(action_there=True)
    assert info(follower).phase == "sent"
    clock.now += 2.0
    follower.tick(action_there=True)
    assert info(follower).phase == "failed"
    assert "No planner" in info(follower).message


def test_goals_of_the_past_are_not_taken_for_ours(follower: GoalFollower) -> None:
    follower.statuses(ACTION, {"old": at(SUCCEEDED)})
    assert follower.info() is None
    send(follower)
    follower.statuses(ACTION, {"old": at(SUCCEEDED), "new": at(EXECUTING)})
    follower.result("old", Ending(SUCCEEDED, ""))
    assert info(follower).phase == "accepted"


def test_another_programs_goal_is_followed_with_its_place(
    follower: GoalFollower, world: WorldModel
) -> None:
    follower.heard(3.0, 1.0, 0.5)
    follower.statuses(ACTION, {"b2": at(EXECUTING)})
    assert (info(follower).x, info(follower).y, info(follower).yaw) == (3.0, 1.0, 0.5)
    assert info(follower).sent_by == "another program"
    goal = world.goal.get()
    assert goal is not None
    assert goal.value is not None


def test_a_goal_sent_straight_to_the_action_gets_its_place_from_the_path(
    follower: GoalFollower, world: WorldModel
) -> None:
    follower.statuses(ACTION, {"b2": at(EXECUTING)})
    line_to(world, 4.0)
    follower.tick(action_there=True)
    assert (info(follower).x, info(follower).y) == (4.0, 0.0)


def test_a_newer_goal_takes_over(follower: GoalFollower) -> None:
    send(follower)
    follower.statuses(ACTION, {"a1": at(EXECUTING)})
    follower.sent("second", 1.0, 1.0, None, by="ben", speed=None, stamp=SENT)
    follower.statuses(ACTION, {"a1": at(ABORTED), "a2": at(EXECUTING)})
    assert info(follower).id == "second"
    assert info(follower).phase == "accepted"
    assert follower.target() == (ACTION, "a2")


def test_without_an_action_path_and_pose_tell(
    follower: GoalFollower, world: WorldModel, clock: Clock
) -> None:
    send(follower)
    line_to(world, 2.0)
    follower.tick(action_there=False)
    assert info(follower).phase == "driving"
    clock.now += 60.0
    world.motion.set(RobotMotion(Pose(1.95, 0.0, 0.0), 0.0, 0.0, 1.0))
    follower.tick(action_there=False)
    assert info(follower).phase == "arrived"


def test_a_goal_that_was_over_before_its_action_was_found_is_ended(
    follower: GoalFollower,
) -> None:
    send(follower)
    assert follower.statuses(ACTION, {"old": at(SUCCEEDED), "a1": at(ABORTED, SENT + 0.1)}) == [
        "a1"
    ]
    follower.result("a1", Ending(ABORTED, "Stopped."))
    assert (info(follower).phase, info(follower).message) == ("failed", "Stopped.")


def test_an_action_found_while_driving_is_taken_for_ours(
    follower: GoalFollower, world: WorldModel
) -> None:
    send(follower)
    line_to(world, 2.0)
    follower.tick(action_there=False)
    follower.statuses(ACTION, {"a1": at(EXECUTING)})
    assert info(follower).id == "mine"
    assert follower.target() == (ACTION, "a1")


def test_without_an_action_a_path_taken_back_is_a_failure(
    follower: GoalFollower, world: WorldModel
) -> None:
    send(follower)
    line_to(world, 2.0)
    follower.tick(action_there=False)
    world.path.set(np.zeros((0, 2)))
    follower.tick(action_there=False)
    assert info(follower).phase == "failed"


def test_a_canceled_goal_that_no_action_took_is_over(follower: GoalFollower) -> None:
    send(follower)
    assert follower.target() == ("", "")
    follower.withdraw()
    assert info(follower).phase == "canceled"
    assert follower.target() is None


def test_time_stands_still_when_the_goal_has_ended(follower: GoalFollower, clock: Clock) -> None:
    send(follower)
    clock.now += 7.0
    follower.withdraw()
    clock.now += 100.0
    assert info(follower).elapsed == pytest.approx(7.0)


def test_length_left_counts_from_the_nearest_point_of_the_path() -> None:
    corner = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 3.0]])
    assert length_left(corner, (0.5, 0.2)) == pytest.approx(4.5)
    assert length_left(corner, (2.4, 1.0)) == pytest.approx(2.0)
    assert length_left(corner, (2.0, 9.0)) == pytest.approx(0.0)
    assert math.isfinite(length_left(np.zeros((3, 2)), (1.0, 1.0)))


def test_what_is_in_the_way_is_told_while_the_goal_is_under_way_and_it_is_news(
    world: WorldModel, clock: Clock
) -> None:
    world.hindrance = Latest(clock)
    follower = GoalFollower(world, lambda: None, now=clock)
    follower.statuses(ACTION, {"aa": at(EXECUTING)})
    assert info(follower).hindrance == ""
    world.hindrance.set(HindranceMark(1.2, 0.45, "In the way: a box."))
    assert info(follower).hindrance == "In the way: a box."
    clock.now += 5.0
    assert info(follower).hindrance == ""
    world.hindrance.set(HindranceMark(1.2, 0.45, "In the way: a box."))
    follower.statuses(ACTION, {"aa": at(ABORTED)})
    follower.result("aa", Ending(ABORTED, "No way. In the way: a box."))
    assert info(follower).hindrance == ""
    assert "a box" in info(follower).message
