"""The planner tells what is missing, waits out what may pass, and takes goals from rules."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from automatika_ros_sugar.srv import ChangeParameter
from geometry_msgs.msg import Point, PointStamped, Pose, Quaternion
from kompass_interfaces.action import PlanPath
from kompass_interfaces.srv import CheckGoal
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from std_msgs.msg import Bool, String

from kompass.algorithms.following.gears import legs_of
from kompass.algorithms.grid import Grid
from kompass.bench.stack import described
from kompass.components import Planner, PlannerConfig
from kompass.components.base.convert import grid_msg, path_poses, quaternion_msg
from kompass.simulation.physics.robot_model import ACKERMANN
from kompass.timeline.goal import GoalReport
from tests.components.alive import LATCHED, Alive
from tests.components.goals import Goals
from tests.components.test_manoeuvres import car, robot

Run = Callable[..., Alive]


class Stage:
    """A map of 4 × 4 m with a closed rim, and a robot that stands in it."""

    def __init__(self, run: Run, *, run_type: str = "ActionServer", **settings: Any) -> None:
        settings = {"robot": robot(), "loop_rate": 10.0, **settings}
        self.planner = Planner(config=PlannerConfig(**settings))
        self.planner.run_type = run_type
        self.alive = run(self.planner)
        self.at, self.yaw = (1.0, 1.0), 0.0
        node = self.alive.node
        self._odometry = node.create_publisher(Odometry, "/odom", 10)
        self._map = node.create_publisher(OccupancyGrid, "/map", LATCHED)
        self.plans: list[Path] = self.alive.hear(Path, "/plan", LATCHED)
        node.create_timer(0.05, self._tick)

    def _tick(self) -> None:
        odometry = Odometry()
        odometry.header.frame_id = "map"
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = self.at
        odometry.pose.pose.orientation = quaternion_msg(self.yaw)
        self._odometry.publish(odometry)

    def map(self, *occupied: tuple[float, float]) -> None:
        cells = np.zeros((80, 80), dtype=np.int8)
        cells[[0, -1], :] = cells[:, [0, -1]] = 100
        for x, y in occupied:
            cells[int(y / 0.05), int(x / 0.05)] = 100
        stamp = self.alive.node.get_clock().now().to_msg()
        self._map.publish(grid_msg(Grid(cells, 0.05), "map", stamp))

    def is_led_from(self, x: float, y: float, yaw: float) -> bool:
        """Whether the path that is driven begins at a pose."""
        poses = path_poses(self.plans[-1]) if self.plans else np.empty((0, 3))
        return len(poses) > 0 and bool(np.allclose(poses[0], (x, y, yaw), atol=1e-3))

    def level(self) -> int:
        return self.alive.statuses[-1].status if self.alive.statuses else -1

    def send(self, x: float, y: float) -> Any:
        return self.alive.execute("trigger_main_action_server", goal_x=x, goal_y=y)


def test_no_map_is_a_system_failure_without_any_goal_and_a_map_heals_it(run: Run) -> None:
    stage = Stage(run)
    stage.alive.wait_until(lambda: stage.level() == 3, 5, "a SYSTEM failure")
    assert list(stage.alive.statuses[-1].src_topics) == ["/map"]
    stage.map()
    stage.alive.wait_until(lambda: stage.level() == 0, 5, "health")


def test_a_goal_waits_for_an_occupied_start_to_become_free(run: Run) -> None:
    stage = Stage(run, patience=20.0)
    stage.map((1.0, 1.0))
    stage.alive.wait_until(lambda: stage.level() == 0, 5, "a map and a pose")
    assert stage.send(3.0, 3.0).success
    stage.alive.wait_until(lambda: stage.level() == 1, 5, "an ALGORITHM failure")
    assert "RRTConnect" in stage.alive.statuses[-1].src_algorithms
    assert not any(plan.poses for plan in stage.plans)
    stage.at = (2.0, 1.0)
    stage.alive.wait_until(
        lambda: stage.plans and stage.plans[-1].poses, 5, "a plan from the free place"
    )
    stage.alive.wait_until(lambda: stage.level() == 0, 5, "health")


def test_patience_with_an_occupied_start_ends(run: Run) -> None:
    stage = Stage(run, patience=1.0)
    stage.map((1.0, 1.0))
    stage.alive.wait_until(lambda: stage.level() == 0, 5, "a map and a pose")
    assert stage.send(3.0, 3.0).success
    stage.alive.wait_until(lambda: stage.level() == 1, 5, "an ALGORITHM failure")
    stage.alive.wait_until(lambda: stage.level() == 0, 5, "the end of the goal")


@pytest.mark.parametrize(
    ("x", "said"), [(1e30, "x = 1e+30 m is no place"), (900.0, "outside the map")]
)
def test_a_goal_far_away_is_refused_although_the_robot_could_not_start(
    run: Run, x: float, said: str
) -> None:
    stage = Stage(run, patience=60.0)
    stage.map((1.0, 1.0))
    stage.alive.wait_until(lambda: stage.level() == 0, 5, "a map and a pose")
    goals = Goals(stage.alive, PlanPath, "planner/plan_path")
    ended = goals.result(goals.send(goal=Pose(position=Point(x=x, y=1.0))))
    assert said in ended.result.message


def test_without_its_action_the_planner_says_so(run: Run) -> None:
    stage = Stage(run, run_type="Timed")
    answer = stage.send(3.0, 3.0)
    assert not answer.success
    assert "ActionServer" in answer.error_msg


def test_another_clearance_counts_from_the_next_plan_on(run: Run) -> None:
    stage = Stage(run)
    stage.map((2.0, 1.0))
    request = CheckGoal.Request()
    request.goal.position.x, request.goal.position.y = 2.0, 1.45

    def check() -> CheckGoal.Response:
        return stage.alive.call(CheckGoal, "check_goal", request)

    stage.alive.wait_until(lambda: check().reachable, 10, "a reachable goal")
    change = ChangeParameter.Request(name="clearance", value="0.4", keep_alive=True)
    assert stage.alive.call(ChangeParameter, "update_config_parameter", change).success
    answer = check()
    assert not answer.reachable
    assert "needs 0.50 m" in answer.message


NO_NUMBERS = [
    (Pose(position=Point(x=math.nan, y=2.0)), "x = nan"),
    (Pose(position=Point(x=2.0, y=math.inf)), "y = inf"),
    (Pose(position=Point(x=2.0, y=2.0), orientation=Quaternion(z=math.nan)), "orientation"),
]


@pytest.mark.parametrize(("pose", "said"), NO_NUMBERS)
def test_a_goal_that_is_no_number_is_refused_and_the_one_under_way_goes_on(
    run: Run, pose: Pose, said: str
) -> None:
    stage = Stage(run)
    stage.map()
    stage.alive.wait_until(lambda: stage.level() == 0, 5, "a map and a pose")
    goals = Goals(stage.alive, PlanPath, "planner/plan_path")
    under_way = goals.send(goal=Pose(position=Point(x=3.0, y=3.0)))
    stage.alive.wait_until(
        lambda: under_way.status == GoalStatus.STATUS_EXECUTING, 5, "a goal under way"
    )
    refused = goals.result(goals.send(goal=pose))
    assert refused.status == GoalStatus.STATUS_ABORTED
    assert refused.result.outcome == PlanPath.Result.OUTCOME_REFUSED
    assert said in refused.result.message
    answer = stage.alive.call(CheckGoal, "check_goal", CheckGoal.Request(goal=pose))
    assert not answer.reachable
    assert said in answer.message
    stage.at = (3.0, 3.0)
    assert goals.result(under_way).result.reached_end


@pytest.mark.parametrize("run_type", ["Timed", "ActionServer"])
def test_a_goal_on_a_topic_that_is_no_number_changes_nothing(run: Run, run_type: str) -> None:
    stage = Stage(run, run_type=run_type, goals_from_topics=True)
    stage.map()
    stage.alive.wait_until(lambda: stage.level() == 0, 5, "a map and a pose")
    goals = stage.alive.node.create_publisher(PointStamped, "/goal", 10)
    reached = stage.alive.hear(Bool, "/reached_end", 10)
    stage.alive.wait_until(lambda: goals.get_subscription_count() > 0, 5, "the planner")
    for x in (math.nan, -math.inf, 3.0):
        goals.publish(PointStamped(point=Point(x=x, y=3.0)))
    stage.alive.wait_until(lambda: stage.plans and stage.plans[-1].poses, 5, "a plan")
    stage.at = (3.0, 3.0)
    stage.alive.wait_until(lambda: reached, 10, "the end of the goal")
    assert [each.data for each in reached] == [True]


@pytest.mark.parametrize("run_type", ["Timed", "ActionServer"])
def test_a_goal_on_a_topic_that_a_newer_one_takes_over_ends_with_that_reason(
    run: Run, run_type: str
) -> None:
    stage = Stage(run, run_type=run_type, goals_from_topics=True)
    stage.map()
    stage.alive.wait_until(lambda: stage.level() == 0, 5, "a map and a pose")
    reports = stage.alive.hear(String, "/goal_reports", 10)
    goals = stage.alive.node.create_publisher(PointStamped, "/goal", 10)
    stage.alive.wait_until(lambda: goals.get_subscription_count() > 0, 5, "the planner")

    def told() -> list[tuple[float, str]]:
        read = [GoalReport.model_validate_json(report.data) for report in reports]
        return [(report.x, report.outcome) for report in read]

    goals.publish(PointStamped(point=Point(x=3.0, y=3.0)))
    stage.alive.wait_until(lambda: (3.0, "") in told(), 5, "the first goal")
    goals.publish(PointStamped(point=Point(x=2.0, y=3.0)))
    stage.alive.wait_until(lambda: (2.0, "") in told(), 5, "the second goal")
    assert told() == [(3.0, ""), (3.0, "preempted"), (2.0, "")]


def test_a_tolerance_that_is_no_number_is_refused(run: Run) -> None:
    stage = Stage(run)
    answer = stage.alive.execute(
        "trigger_main_action_server", goal_x=3.0, goal_y=3.0, tolerance_dist=-1.0
    )
    assert not answer.success
    assert "lateral_distance_error = -1.0" in answer.error_msg


def test_an_inactive_planner_answers_instead_of_keeping_silent(run: Run) -> None:
    stage = Stage(run)
    assert stage.alive.execute("stop").success
    answer = stage.alive.call(CheckGoal, "check_goal", CheckGoal.Request())
    assert not answer.reachable
    assert "not active" in answer.message
    answer = stage.send(3.0, 3.0)
    assert not answer.success


def test_a_car_that_cannot_steer_back_to_its_path_before_a_wall_is_led_anew_at_once(
    run: Run,
) -> None:
    stage = Stage(run, robot=described(ACKERMANN), patience=100.0)
    stage.map(*[(2.52, y) for y in np.arange(0.1, 3.9, 0.05)])
    stage.alive.wait_until(lambda: stage.level() == 0, 5, "a map and a pose")
    goal = {"goal_x": 1.9, "goal_y": 3.0, "goal_orientation": math.pi / 2}
    assert stage.alive.execute("trigger_main_action_server", **goal).success
    stage.alive.wait_until(lambda: stage.is_led_from(1.0, 1.0, 0.0), 5, "a plan")
    assert not any(leg.backward for leg in legs_of(path_poses(stage.plans[-1])))
    # It is to turn left before the wall, and has not begun to.
    stage.at = (1.7, 1.0)
    stage.alive.wait_until(
        lambda: stage.is_led_from(1.7, 1.0, 0.0), 5, "a plan from where the car is"
    )
    assert legs_of(path_poses(stage.plans[-1]))[0].backward


def test_a_car_that_does_not_get_on_is_led_anew_from_where_it_is(run: Run) -> None:
    stage = Stage(run, robot=car(), patience=10.0)
    stage.map()
    stage.alive.wait_until(lambda: stage.level() == 0, 5, "a map and a pose")
    assert stage.send(3.0, 1.0).success
    stage.alive.wait_until(lambda: stage.is_led_from(1.0, 1.0, 0.0), 5, "a plan")
    stage.at, stage.yaw = (1.5, 1.05), 0.2
    stage.alive.wait_until(
        lambda: stage.is_led_from(1.5, 1.05, 0.2), 5, "a plan from where the car is"
    )
    # To be led is no progress: the goal still ends.
    stage.alive.wait_until(lambda: not stage.plans[-1].poses, 12, "the end of the goal")
