"""The stack that a benchmark drives: the components as they come, described for one robot."""

from __future__ import annotations

from typing import Any

import numpy as np

from kompass.components import Controller, DriveManager, LocalMapper, Planner, PlannerConfig
from kompass.components.controller.controllers_id import ControllersID
from kompass.launch.launcher import Launcher
from kompass.rclpy_ext.topic import Topic
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotGeometry,
    RobotType,
)
from kompass.simulation.physics.robot_model import (
    ACKERMANN,
    JACKAL,
    OMNI,
    TURTLEBOT3,
    RobotModel,
)

COMPONENTS = ("planner", "controller", "mapper", "drive_manager")
# What a robot is driven with: top speed, acceleration, braking, of driving and of turning.
LIMITS: dict[str, tuple[LinearCtrlLimits, AngularCtrlLimits]] = {
    "turtlebot3": (
        LinearCtrlLimits(max_vel=TURTLEBOT3.usual_speed, max_acc=1.5, max_decel=2.5),
        AngularCtrlLimits(max_vel=1.5, max_acc=3.0, max_decel=3.0),
    ),
    "jackal": (
        LinearCtrlLimits(max_vel=JACKAL.usual_speed, max_acc=3.0, max_decel=4.0),
        # What its wheels do while it brakes as hard as it can, too.
        AngularCtrlLimits(max_vel=4.0, max_acc=5.0, max_decel=5.0),
    ),
    "ackermann": (
        LinearCtrlLimits(max_vel=ACKERMANN.usual_speed, max_acc=1.5, max_decel=2.5),
        AngularCtrlLimits(max_vel=1.7, max_acc=5.0, max_decel=5.0, max_steer=0.6),
    ),
    "omni": (
        LinearCtrlLimits(max_vel=OMNI.usual_speed, max_acc=1.5, max_decel=2.5),
        AngularCtrlLimits(max_vel=2.0, max_acc=5.0, max_decel=5.0),
    ),
}


def described(robot: RobotModel) -> RobotConfig:
    """What a recipe says of one of the embedded robots."""
    along, turning = LIMITS[robot.name]
    if robot.box is None:
        kind, params = RobotGeometry.Type.CYLINDER, [robot.radius, robot.body_height]
    else:
        kind, params = RobotGeometry.Type.BOX, [*robot.box, robot.body_height]
    if robot.steering is not None:
        drive: dict[str, Any] = {
            "model_type": RobotType.ACKERMANN,
            "wheel_base": robot.steering.wheel_base,
        }
    elif robot.omni is not None:
        drive = {"model_type": RobotType.OMNI, "ctrl_vy_limits": along}
    else:
        drive = {"model_type": RobotType.DIFFERENTIAL_DRIVE}
    return RobotConfig(
        geometry_type=kind,
        geometry_params=np.array(params),
        geometry_offset=robot.middle,
        ctrl_vx_limits=along,
        ctrl_omega_limits=turning,
        **drive,
    )


def bring_up(robot: RobotModel, follower: str) -> None:
    """Bring the stack up, as a recipe does.

    Parameters
    ----------
    robot
        Which it drives.
    follower
        Algorithm of the controller.
    """
    planner = Planner(component_name=COMPONENTS[0], config=PlannerConfig(use_sensor=True))
    planner.run_type = "ActionServer"
    controller = Controller(component_name=COMPONENTS[1])
    controller.algorithm = ControllersID(follower)
    controller.direct_sensor = True  # the cells of the local map are coarse for the gaps of BARN
    mapper = LocalMapper(component_name=COMPONENTS[2])
    driver = DriveManager(component_name=COMPONENTS[3])
    driver.outputs(robot_command=Topic(name="/cmd_vel", msg_type="TwistStamped"))
    launcher = Launcher()
    launcher.kompass(components=[planner, controller, mapper, driver], multi_processing=True)
    launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
    launcher.robot = described(robot)
    launcher.bringup()
