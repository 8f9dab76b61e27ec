"""Drive to a point on the floor.

The four components of the navigation stack, each in a process of its own:

  goal → planner → path → controller → commands → drive_manager → wheels
                            scan → mapper → local map

Run it with the embedded robot:   kompass-console run recipes/01_point_navigation.py --sim
or on a robot that publishes /map, /scan and /odometry/filtered:   python 01_point_navigation.py
"""

import os

import numpy as np

from kompass.components import Controller, DriveManager, LocalMapper, Planner, PlannerConfig
from kompass.control import ControllersID
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotGeometry,
    RobotType,
)
from kompass.ros import Launcher, Topic

# What the robot is: a round differential drive, 10 cm in radius, 30 cm high.
my_robot = RobotConfig(
    model_type=RobotType.DIFFERENTIAL_DRIVE,
    geometry_type=RobotGeometry.Type.CYLINDER,
    geometry_params=np.array([0.1, 0.3]),
    ctrl_vx_limits=LinearCtrlLimits(max_vel=0.22, max_acc=1.5, max_decel=2.5),
    ctrl_omega_limits=AngularCtrlLimits(max_vel=1.5, max_acc=3.0, max_decel=3.0),
)

# As an action server the planner takes one goal at a time and says how it ended. With
# goals_from_topics a message on a goal topic becomes such a goal: a point as from RViz's
# "Publish Point", a pose (with the heading to arrive with) as from its "2D Goal Pose".
planner = Planner(
    component_name="planner", config=PlannerConfig(loop_rate=1.0, goals_from_topics=True)
)
planner.run_type = "ActionServer"
planner.inputs(
    goal_point=[
        Topic(name="/goal_pose", msg_type="PoseStamped"),
        Topic(name="/clicked_point", msg_type="PointStamped"),
    ]
)

controller = Controller(component_name="controller")
controller.algorithm = ControllersID.PURE_PURSUIT

mapper = LocalMapper(component_name="mapper")

# Newer ROS distributions drive their bases with stamped commands.
driver = DriveManager(component_name="drive_manager")
stamped = os.environ.get("ROS_DISTRO") in ["rolling", "jazzy", "kilted"]
driver.outputs(
    robot_command=Topic(name="/cmd_vel", msg_type="TwistStamped" if stamped else "Twist")
)

launcher = Launcher()
launcher.kompass(components=[planner, controller, mapper, driver], multi_processing=True)
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.robot = my_robot
launcher.bringup()
