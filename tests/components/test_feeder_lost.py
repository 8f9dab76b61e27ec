"""A drive manager that is told that its commands come from nobody any more."""

from collections.abc import Callable

import pytest
from automatika_ros_sugar.srv import ExecuteMethod
from geometry_msgs.msg import Twist

from kompass.components import DriveManager
from tests.components.alive import Alive
from tests.components.toy_robot import ToyRobot

Run = Callable[..., Alive]


def lose(alive: Alive) -> None:
    """As the host tells it, on the thread of the component's executor."""
    executor = alive.component.node.executor
    executor.create_task(alive.component.on_feeder_lost, "controller: dead")


class Commands:
    """Commands as a controller sends them, and what becomes of them."""

    def __init__(self, alive: Alive) -> None:
        self._alive = alive
        self.robot = ToyRobot(alive)
        self._publisher = alive.publisher(Twist, "/control")
        self._timer = alive.node.create_timer(0.02, self._publish)

    def _publish(self) -> None:
        twist = Twist()
        twist.linear.x = 0.2
        self._publisher.publish(twist)

    def moving(self) -> bool:
        return bool(self.robot.commands) and self.robot.commands[-1][0] > 0.1

    def a_while(self) -> None:
        """Until the component has answered, after some commands have come in."""
        for _ in range(5):
            assert self._alive.execute("broadcast_status").success


def test_it_halts_and_takes_no_command_that_was_under_way(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kompass.components.drive.drive_manager.LATE", 60.0)
    alive = run(DriveManager())
    commands = Commands(alive)
    alive.wait_until(commands.moving, 10, "motion")
    lose(alive)
    alive.wait_until(commands.robot.is_halted, 5, "a zero twist")
    commands.robot.commands.clear()
    commands.a_while()
    assert not [one for one in commands.robot.commands if one != (0.0, 0.0)]


def test_it_obeys_the_next_one(run: Run) -> None:
    alive = run(DriveManager())
    commands = Commands(alive)
    alive.wait_until(commands.moving, 10, "motion")
    lose(alive)
    alive.wait_until(commands.robot.is_halted, 5, "a zero twist")
    alive.wait_until(commands.moving, 5, "motion again")


def test_a_motion_of_its_own_goes_on(run: Run) -> None:
    alive = run(DriveManager())
    robot = ToyRobot(alive)
    driver = alive.component
    alive.wait_until(lambda: driver.input("location").message is not None, 10, "odometry")
    alive.wait_until(lambda: driver.input("sensor_data").message is not None, 10, "a scan")
    request = ExecuteMethod.Request(name="move_forward", kwargs_json='{"max_distance": 0.3}')
    ended = alive.begin(ExecuteMethod, "execute_method", request)
    alive.wait_until(lambda: robot.x > 0.05, 10, "motion")
    lose(alive)
    alive.wait_until(lambda: ended() is not None, 20, "the end of the motion")
    assert ended().success, ended().error_msg
    assert robot.x == pytest.approx(0.3, abs=0.05)
