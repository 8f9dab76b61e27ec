"""For tests: the four components with the settings that are shipped, and the algorithm asked for.

The environment says which: ``TEST_ALGORITHM`` (DWA unless given), ``TEST_DIRECT_SENSOR``.
"""

import os

import numpy as np

from kompass.components import Controller, DriveManager, LocalMapper, Planner, PlannerConfig
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotGeometry,
    RobotType,
)
from kompass.ros import Launcher, Topic
from kompass.share import map_path

config_file = str(map_path("hexagon").parents[1] / "params" / "turtlebot3.yaml")

planner = Planner(component_name="planner", config=PlannerConfig(patience=8.0))
planner.run_type = "ActionServer"
controller = Controller(component_name="controller")
mapper = LocalMapper(component_name="mapper")
driver = DriveManager(component_name="drive_manager")

launcher = Launcher(config_file=config_file)
launcher.kompass(components=[planner, controller, mapper, driver], multi_processing=True)
controller.algorithm = os.environ.get("TEST_ALGORITHM", "DWA")
controller.direct_sensor = bool(os.environ.get("TEST_DIRECT_SENSOR"))
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.robot = RobotConfig(
    model_type=RobotType.DIFFERENTIAL_DRIVE,
    geometry_type=RobotGeometry.Type.CYLINDER,
    geometry_params=np.array([0.1, 0.3]),
    ctrl_vx_limits=LinearCtrlLimits(max_vel=0.2, max_acc=1.5, max_decel=2.5),
    ctrl_omega_limits=AngularCtrlLimits(
        max_vel=0.4, max_acc=2.0, max_decel=2.0, max_steer=np.pi / 3
    ),
)
launcher.bringup()
