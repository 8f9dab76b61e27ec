"""Short motions are measured, bounded and safe; unblocking goes where there is room."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from automatika_ros_sugar.srv import ExecuteMethod
from geometry_msgs.msg import Twist, Vector3
from kompass_interfaces.srv import ReleaseStop, StopRobot
from std_msgs.msg import Bool

from kompass.components import DriveManager, DriveManagerConfig
from kompass.components.drive.manoeuvre import (
    Manoeuvre,
    free_way,
    looked_at,
    open_turn,
    widest_turn,
)
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotGeometry,
    RobotType,
)
from tests.components.alive import Alive
from tests.components.toy_robot import Post, ToyRobot, ring

Run = Callable[..., Alive]
RADIUS = 0.1
AHEAD = (0.2, 0.0, 0.05)  # 5 cm before the robot's front
BEHIND = (-0.2, 0.0, 0.05)


def robot(kind: RobotType = RobotType.DIFFERENTIAL_DRIVE) -> RobotConfig:
    return RobotConfig(
        model_type=kind,
        geometry_type=RobotGeometry.Type.CYLINDER,
        geometry_params=np.array([RADIUS, 0.3]),
        ctrl_vx_limits=LinearCtrlLimits(max_vel=0.4, max_acc=1.5, max_decel=2.5),
        ctrl_omega_limits=AngularCtrlLimits(max_vel=2.0, max_acc=4.0, max_decel=4.0),
    )


def car() -> RobotConfig:
    """As narrow as the round one, and longer."""
    return RobotConfig(
        model_type=RobotType.ACKERMANN,
        geometry_type=RobotGeometry.Type.BOX,
        geometry_params=np.array([0.3, 0.2, 0.3]),
        geometry_offset=0.05,
        wheel_base=0.2,
        ctrl_vx_limits=LinearCtrlLimits(max_vel=0.4, max_acc=1.5, max_decel=2.5),
        ctrl_omega_limits=AngularCtrlLimits(max_vel=2.0, max_steer=0.5),
    )


def started(
    run: Run, posts: list[Post] | None = None, **settings: object
) -> tuple[Alive, ToyRobot]:
    settings = {"robot": robot(), **settings}
    config = DriveManagerConfig(**settings)  # type: ignore[arg-type]
    alive = run(DriveManager(config=config))
    toy = ToyRobot(alive, posts)
    driver = alive.component
    alive.wait_until(lambda: driver.input("location").message is not None, 10, "odometry")
    alive.wait_until(lambda: not toy.scans or driver.input("sensor_data").message, 10, "a scan")
    return alive, toy


def test_a_manoeuvre_counts_what_was_measured_not_what_was_commanded() -> None:
    motion = Manoeuvre(0.2, 0.1, 2.0, turns=False)
    assert motion.step((0.0, 0.0, 0.0), 0.0) == (0.1, 0.0, 0.0)
    assert motion.step((0.0, 0.0, 0.0), 9.0) is not None
    assert motion.step((0.21, 0.0, 0.0), 10.0) is None


def test_a_turn_of_more_than_half_a_circle_is_counted() -> None:
    motion = Manoeuvre(-4.0, 1.0, 2.0, turns=True)
    angles = np.arange(0.0, -4.3, -0.1)
    steps = [motion.step((0.0, 0.0, math.remainder(a, 2 * math.pi)), 0.1) for a in angles]
    assert steps[5] is not None
    assert steps[5][2] < 0
    assert steps.index(None) == 40 or steps.index(None) == 41


def test_a_manoeuvre_that_gets_nowhere_is_overdue() -> None:
    motion = Manoeuvre(0.2, 0.1, 2.0, turns=False)
    motion.step((0.0, 0.0, 0.0), 0.0)
    assert not motion.overdue(6.9)
    assert motion.overdue(7.1)


def test_the_free_way_is_that_of_the_whole_body() -> None:
    points = np.array([[0.5, 0.0], [0.3, 0.09], [0.2, 0.11], [-0.4, 0.0]])
    assert free_way(points, 0.1) == pytest.approx(0.3 - math.sqrt(0.01 - 0.0081))
    assert free_way(points, 0.1, math.pi) == pytest.approx(0.3)
    assert free_way(points, 0.1, math.pi / 2) == math.inf


def test_the_smallest_turn_to_an_open_way_is_found() -> None:
    posts = np.array([(x, y) for x, y, _ in ring(0.3, count=72, gap=0.6)])
    assert open_turn(posts, 0.1, math.pi / 2, 1.0) is None
    turn = open_turn(posts, 0.1, math.pi, 1.0)
    assert turn is not None
    assert 2.5 < abs(turn) < math.pi


def test_the_widest_way_is_turned_to_by_the_smallest_turn() -> None:
    posts = np.array([(x, y) for x, y, _ in ring(0.3, count=72, gap=0.6)])
    turn, free = widest_turn(posts, 0.1, math.pi)
    assert abs(turn) > 2.5
    assert free == 2.0
    assert widest_turn(np.array([[-0.5, 0.0]]), 0.1, math.pi) == (0.0, 2.0)


def test_what_no_ray_has_looked_at_is_not_free() -> None:
    bearings = np.radians(np.arange(-90.0, 91.0))
    ranges = np.full(len(bearings), math.inf)
    assert looked_at(ranges, bearings, 0.0, math.radians(60.0))
    assert not looked_at(ranges, bearings, math.pi, math.radians(60.0))
    ranges[80:100] = math.nan
    assert not looked_at(ranges, bearings, 0.0, math.radians(60.0))


@pytest.mark.parametrize(("behind", "expected"), [(None, -0.3), ((-0.35, 0.0, 0.05), -0.12)])
def test_backing_off_goes_as_far_as_is_measured_to_be_free(
    run: Run, behind: Post | None, expected: float
) -> None:
    alive, toy = started(run, [AHEAD, *([behind] if behind else [])])
    answer = alive.execute("back_off")
    assert answer.success, answer.error_msg
    assert toy.x == pytest.approx(expected, abs=0.05)
    assert toy.x > -0.2 or behind is None


def test_there_is_no_backing_off_where_something_is_behind(run: Run) -> None:
    alive, toy = started(run, [BEHIND])
    answer = alive.execute("back_off")
    assert not answer.success
    assert "behind are free" in answer.error_msg
    assert toy.x == pytest.approx(0.0, abs=0.01)


def test_a_turn_leads_to_where_there_is_room(run: Run) -> None:
    alive, toy = started(run, [(0.5, 0.0, 0.05)])
    answer = alive.execute("turn_to_room")
    assert answer.success, answer.error_msg
    assert 0.2 < abs(toy.turned) < 1.0
    assert not alive.execute("turn_to_room").success  # it faces the room


@pytest.mark.parametrize(
    ("name", "amount", "expected"),
    [("move_forward", 0.25, 0.25), ("move_backward", 0.25, -0.25), ("move_forward", -0.1, -0.1)],
)
def test_a_distance_is_driven_as_odometry_measures_it(
    run: Run, name: str, amount: float, expected: float
) -> None:
    alive, toy = started(run)
    answer = alive.execute(name, max_distance=amount)
    assert answer.success, answer.error_msg
    assert toy.x == pytest.approx(expected, abs=0.03)
    assert abs(toy.x) >= abs(expected) - 0.005
    alive.wait_until(toy.is_halted, 5, "a zero twist")


@pytest.mark.parametrize("angle", [1.0, -1.0, 4.0])
def test_a_turn_has_a_sign_and_may_pass_half_a_circle(run: Run, angle: float) -> None:
    alive, toy = started(run)
    assert alive.execute("rotate_in_place", max_rotation=angle).success
    assert toy.turned == pytest.approx(angle, abs=0.12)
    alive.wait_until(toy.is_halted, 5, "a zero twist")


def test_the_stop_zone_holds_in_the_direction_of_the_motion(run: Run) -> None:
    alive, toy = started(run, [BEHIND])
    answer = alive.execute("move_backward", max_distance=0.3)
    assert not answer.success
    assert "obstacle" in answer.error_msg
    assert toy.x == pytest.approx(0.0, abs=0.01)
    assert alive.execute("move_forward", max_distance=0.2).success


def test_a_robot_that_does_not_move_is_given_up_in_time(run: Run) -> None:
    alive, toy = started(run)
    toy.wheels_blocked = True
    began = alive.clock.monotonic()
    answer = alive.execute("move_forward", max_distance=0.1)
    assert not answer.success
    assert "did not get there in time" in answer.error_msg
    assert alive.clock.monotonic() - began < 6.0
    alive.wait_until(toy.is_halted, 5, "a zero twist")


def test_stop_ends_a_manoeuvre_and_refuses_the_next(run: Run) -> None:
    alive, toy = started(run)
    request = ExecuteMethod.Request(name="move_forward", kwargs_json='{"max_distance": 2.0}')
    moving = alive.begin(ExecuteMethod, "execute_method", request)
    alive.wait_until(lambda: toy.x > 0.1, 5, "motion")
    alive.call(StopRobot, "stop", StopRobot.Request(operator_name="ava"))
    alive.wait_until(lambda: moving() is not None, 5, "the end of the manoeuvre")
    assert not moving().success
    assert "STOP" in moving().error_msg
    for name in ("move_to_unblock", "move_forward"):
        kwargs = {} if name == "move_to_unblock" else {"max_distance": 0.1}
        answer = alive.execute(name, **kwargs)
        assert not answer.success
        assert "ava pressed STOP; a person must release it" in answer.error_msg
    stood = toy.x
    alive.call(ReleaseStop, "release_stop", ReleaseStop.Request(operator_name="ava"))
    assert alive.execute("move_forward", max_distance=0.1).success
    assert toy.x - stood == pytest.approx(0.1, abs=0.03)


def test_commands_of_the_controller_wait_while_a_manoeuvre_runs(run: Run) -> None:
    alive, toy = started(run)
    publisher = alive.publisher(Twist, "/control")
    timer = alive.node.create_timer(0.05, lambda: publisher.publish(Twist(angular=Vector3(z=1.0))))
    alive.wait_until(lambda: abs(toy.turned) > 0.1, 5, "the controller's turn")
    before = toy.turned
    assert alive.execute("move_backward", max_distance=0.2).success
    assert abs(toy.turned - before) < 0.3  # what it had until the manoeuvre began and after it
    alive.wait_until(lambda: abs(toy.turned - before) > 0.5, 5, "the controller's turn again")
    timer.cancel()


def test_a_robot_before_an_obstacle_backs_off(run: Run) -> None:
    alive, toy = started(run, [AHEAD])
    answer = alive.execute("move_to_unblock")
    assert answer.success, answer.error_msg
    assert toy.x <= -2 * RADIUS + 0.005


def test_a_robot_with_an_obstacle_behind_goes_ahead(run: Run) -> None:
    alive, toy = started(run, [BEHIND])
    assert alive.execute("move_to_unblock", max_distance_forward=0.3).success
    assert toy.x == pytest.approx(0.3, abs=0.03)


def test_a_robot_between_two_obstacles_turns_to_the_open_side(run: Run) -> None:
    alive, toy = started(run, [AHEAD, BEHIND])
    assert alive.execute("move_to_unblock").success
    assert abs(toy.turned) > 0.5
    assert abs(toy.x) < 0.02


def test_a_robot_boxed_in_everywhere_says_so_and_stays(run: Run) -> None:
    alive, toy = started(run, ring(0.18))
    began = alive.clock.monotonic()
    answer = alive.execute("move_to_unblock")
    assert not answer.success
    assert "boxed in" in answer.error_msg
    assert alive.clock.monotonic() - began < 5.0
    assert (toy.x, toy.turned) == (0.0, 0.0)


def test_a_robot_without_a_scan_does_not_unblock_blindly(run: Run) -> None:
    alive, toy = started(run, [AHEAD])
    toy.scans = False
    driver = alive.component
    alive.wait_until(lambda: driver.input("sensor_data").age() > 0.6, 5, "a stale scan")
    answer = alive.execute("move_to_unblock")
    assert not answer.success
    assert "no scan" in answer.error_msg
    assert toy.x == 0.0


def test_a_failed_manoeuvre_leaves_the_drive_manager_usable(run: Run) -> None:
    alive, toy = started(run)
    assert not alive.execute("move_forward", max_distance=0.0).success
    toy.wheels_blocked = True
    assert not alive.execute("move_forward", max_distance=0.05).success
    toy.wheels_blocked = False
    publisher = alive.publisher(Twist, "/control")
    command = Twist()
    command.linear.x = 0.2

    def moves() -> bool:
        publisher.publish(command)
        return toy.x > 0.05

    alive.wait_until(moves, 5, "motion at the controller's command")


def test_a_restart_ends_a_manoeuvre(run: Run) -> None:
    alive, toy = started(run)
    request = ExecuteMethod.Request(name="move_forward", kwargs_json='{"max_distance": 2.0}')
    moving = alive.begin(ExecuteMethod, "execute_method", request)
    alive.wait_until(lambda: toy.x > 0.05, 5, "motion")
    assert alive.execute("restart").success
    alive.wait_until(lambda: moving() is not None, 5, "the end of the manoeuvre")
    assert "deactivated" in moving().error_msg


def test_the_emergency_flag_is_a_level_that_falls_by_itself(run: Run) -> None:
    alive, toy = started(run)
    flags = alive.hear(Bool, "/emergency_stop")
    publisher = alive.publisher(Twist, "/control")
    command = Twist()
    command.linear.x = 0.2
    timer = alive.node.create_timer(0.05, lambda: publisher.publish(command))
    alive.wait_until(lambda: toy.x > 0.05, 5, "motion")
    toy.posts = [(toy.x + 0.3, 0.0, 0.05)]
    alive.wait_until(lambda: flags and flags[-1].data, 5, "the flag")
    alive.wait_until(toy.is_halted, 5, "a zero twist")
    stood = toy.x
    toy.posts = []
    alive.wait_until(lambda: not flags[-1].data, 5, "the end of the flag")
    alive.wait_until(lambda: toy.x > stood + 0.05, 5, "motion again, with nobody's help")
    timer.cancel()


def test_the_emergency_flag_falls_when_the_robot_is_freed(run: Run) -> None:
    alive, toy = started(run)
    flags = alive.hear(Bool, "/emergency_stop")
    assert alive.execute("move_forward", max_distance=0.05).success
    toy.posts = [(toy.x + 0.18, 0.0, 0.05)]
    alive.wait_until(lambda: flags and flags[-1].data, 5, "the flag, with nothing commanded")
    assert alive.execute("move_to_unblock").success
    alive.wait_until(lambda: not flags[-1].data, 5, "the end of the flag")


def test_without_odometry_the_drive_manager_fails_and_a_new_message_heals_it(run: Run) -> None:
    alive, toy = started(run)
    toy.odometry = False
    alive.wait_until(
        lambda: alive.statuses and alive.statuses[-1].status == 3, 5, "a SYSTEM failure"
    )
    assert list(alive.statuses[-1].src_topics) == ["/odom"]
    toy.odometry = True
    alive.wait_until(lambda: alive.statuses[-1].status == 0, 5, "health")
    assert not alive.statuses[-1].src_topics


def test_inputs_that_have_not_spoken_yet_are_awaited_not_missed(run: Run) -> None:
    alive = run(DriveManager(config=DriveManagerConfig(topic_subscription_timeout=1.0)))
    alive.wait_until(lambda: alive.statuses, 5, "a status")
    assert alive.statuses[0].status == 0
    alive.wait_until(lambda: alive.statuses[-1].status == 3, 5, "a SYSTEM failure in the end")


@pytest.mark.parametrize("action", ["rotate_in_place", "turn_to_room"])
def test_a_car_says_that_it_cannot_turn_on_the_spot(run: Run, action: str) -> None:
    alive, toy = started(run, robot=car())
    answer = alive.execute(action, max_rotation=1.0)
    assert not answer.success
    assert "a robot with steered wheels cannot turn on the spot" in answer.error_msg
    assert not any(omega for _, omega in toy.commands)


def test_a_car_frees_itself_straight_by_the_room_that_its_outline_has(run: Run) -> None:
    # Beside its way back, and within the circle around it.
    alive, toy = started(run, [(0.3, 0.0, 0.05), (-0.2, 0.15, 0.03)], robot=car())
    answer = alive.execute("move_to_unblock", max_distance_backwards=0.3)
    assert answer.success, answer.error_msg
    assert toy.x == pytest.approx(-0.3, abs=0.05)
    assert toy.turned == 0.0


def test_a_car_that_is_boxed_in_tries_no_turn(run: Run) -> None:
    alive, toy = started(run, [(0.27, 0.0, 0.05), (-0.18, 0.0, 0.05)], robot=car())
    answer = alive.execute("move_to_unblock")
    assert not answer.success
    assert "boxed in: no way is free ahead or back" in answer.error_msg
    assert toy.turned == 0.0
