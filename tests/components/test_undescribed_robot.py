"""A robot that nobody described does not move, and every part of the stack says so."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from automatika_ros_sugar.srv import ChangeParameters
from geometry_msgs.msg import Twist
from kompass_interfaces.srv import StopRobot

from kompass.components import (
    Component,
    Controller,
    DriveManager,
    DriveManagerConfig,
    LocalMapper,
    MapServer,
    Planner,
)
from kompass.components.base.component_config import NO_ROBOT
from kompass.robot import AngularCtrlLimits, LinearCtrlLimits
from tests.components.alive import Alive
from tests.components.toy_robot import ToyRobot
from tests.support.described import described_robot
from tests.support.domains import give_back, next_domain
from tests.support.patience import patient
from tests.support.processes import end_with_parent, wait_until
from tests.support.robot import LATCHED as LATCHED_STATUS
from tests.support.robot import Robot

pytestmark = pytest.mark.ros

Run = Callable[..., Alive]
NEED_ONE = [Planner, Controller, DriveManager]
FAILED = ComponentStatus.STATUS_FAILURE_COMPONENT_LEVEL


@pytest.mark.parametrize("kind", NEED_ONE, ids=lambda kind: kind.__name__)
def test_who_drives_does_not_become_active_without_a_robot(
    run_on_dds: Run, kind: Callable[[], Component]
) -> None:
    component = kind()
    assert component.robot is None
    alive = run_on_dds(component, describe=False)
    wait_until(lambda: bool(alive.statuses), 10, "a status")
    assert alive.statuses[-1].status == FAILED
    assert NO_ROBOT in alive.statuses[-1].msg
    assert "launcher.robot = RobotConfig(…)" in alive.statuses[-1].msg
    assert not component.is_active
    answer = alive.execute("start")
    assert not answer.success
    assert NO_ROBOT in answer.error_msg


@pytest.mark.parametrize("kind", [LocalMapper, MapServer], ids=lambda kind: kind.__name__)
def test_who_does_not_drive_needs_none(run_on_dds: Run, kind: Callable[[], Component]) -> None:
    component = kind()
    run_on_dds(component, describe=False)
    assert component.is_active


def test_stop_can_be_pressed_on_a_robot_that_nobody_described(run_on_dds: Run) -> None:
    driver = DriveManager()
    alive = run_on_dds(driver, describe=False)
    assert alive.call(StopRobot, "stop", StopRobot.Request(operator_name="Ada")).success
    assert driver.health.level == FAILED


def test_a_robot_described_over_ros_lets_it_start(run_on_dds: Run) -> None:
    driver = DriveManager()
    alive = run_on_dds(driver, describe=False)
    request = ChangeParameters.Request(
        names=["robot"], values=[described_robot().model_dump_json()], keep_alive=True
    )
    assert list(alive.call(ChangeParameters, "update_config_parameters", request).success) == [True]
    assert alive.execute("start").success
    assert driver.is_active


def test_the_robot_of_who_drives_is_not_taken_away(run_on_dds: Run) -> None:
    driver = DriveManager()
    alive = run_on_dds(driver)
    request = ChangeParameters.Request(names=["robot"], values=["null"], keep_alive=True)
    answer = alive.call(ChangeParameters, "update_config_parameters", request)
    assert list(answer.success) == [False]
    assert "nobody described the robot" in answer.error_msg[0]
    assert driver.robot == described_robot()


def test_what_is_slower_than_the_base_can_drive_is_not_sent(run_on_dds: Run) -> None:
    limits = LinearCtrlLimits(max_vel=1.0, min_absolute_val=0.1)
    turning = AngularCtrlLimits(max_vel=5.0, min_absolute_val=0.5)
    robot = described_robot(ctrl_vx_limits=limits, ctrl_omega_limits=turning)
    alive = run_on_dds(DriveManager(config=DriveManagerConfig(robot=robot)))
    toy = ToyRobot(alive)
    publisher = alive.publisher(Twist, "/control")

    def drive(vx: float, omega: float) -> None:
        alive.node.create_timer(0.05, lambda: publisher.publish(message(vx, omega)))

    drive(0.05, 1.0)
    wait_until(lambda: any(omega > 0.5 for _, omega in toy.commands), 10, "a turn")
    assert all(vx == 0.0 for vx, _ in toy.commands)
    assert all(omega == 0.0 or omega >= 0.5 for _, omega in toy.commands)


def message(vx: float, omega: float) -> Twist:
    twist = Twist()
    twist.linear.x, twist.angular.z = vx, omega
    return twist


RECIPE = """
from kompass.components import Controller, DriveManager, LocalMapper, Planner
from kompass.launcher import Launcher

launcher = Launcher(enable_monitoring=False)
launcher.kompass([Planner(), Controller(), LocalMapper(), DriveManager()])
launcher.bringup()
"""


@pytest.mark.parametrize("processes", ["1", "0"])
def test_a_stack_without_a_robot_comes_up_and_its_health_says_why(
    tmp_path: Path, processes: str
) -> None:
    program = tmp_path / "recipe.py"
    program.write_text(RECIPE)
    with (
        running(program, tmp_path / "log", processes) as (stack, domain, log),
        closing(Robot(domain)) as client,
    ):
        heard = {
            name: hear(client, name)
            for name in ("planner", "controller", "mapper", "drive_manager")
        }
        up = "but not active: planner, controller, drive_manager"
        wait_until(lambda: up in log(), 30, "the stack")
        assert "all components active" not in log()
        for name in ("planner", "controller", "drive_manager"):
            wait_until(partial(fails, heard[name]), 20, f"the failure of {name}")
            assert NO_ROBOT in heard[name][-1].msg
        wait_until(lambda: heard["mapper"], 20, "a status of the mapper")
        assert not [told.msg for told in heard["mapper"] if NO_ROBOT in told.msg]
        text = f"planner, controller, drive_manager cannot become active: {NO_ROBOT}"
        assert text in log()
        assert stack.poll() is None


def hear(client: Robot, name: str) -> list[ComponentStatus]:
    """What a component says of itself, from now on."""
    heard: list[ComponentStatus] = []
    client.node.create_subscription(
        ComponentStatus, f"/{name}/status", heard.append, LATCHED_STATUS
    )
    return heard


def fails(heard: list[ComponentStatus]) -> bool:
    return bool(heard) and heard[-1].status == FAILED


@contextmanager
def running(
    program: Path, output: Path, processes: str
) -> Iterator[tuple[subprocess.Popen[bytes], int, Callable[[], str]]]:
    """A recipe without a console: its process, its domain, and what it has written."""
    domain = next_domain(stack=True)
    with output.open("w") as out:
        stack = subprocess.Popen(
            [sys.executable, str(program)],
            env={
                **os.environ,
                "ROS_DOMAIN_ID": str(domain),
                "KOMPASS_MULTI_PROCESSING": processes,
            },
            stdout=out,
            stderr=subprocess.STDOUT,
            preexec_fn=end_with_parent,
        )
    try:
        yield stack, domain, output.read_text
    finally:
        stack.send_signal(signal.SIGTERM)
        assert stack.wait(patient(30)) == 0, output.read_text()
        give_back(domain)
