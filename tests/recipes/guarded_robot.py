"""For tests: the four components, with a rule that nobody may take away, and one name opened."""

import os

import numpy as np

from kompass.actions import LogInfo
from kompass.components import (
    Controller,
    DriveManager,
    DriveManagerConfig,
    LocalMapper,
    Planner,
    PlannerConfig,
)
from kompass.control import ControllersID
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotGeometry,
    RobotType,
)
from kompass.ros import Event, Launcher, Topic

planner = Planner(component_name="planner", config=PlannerConfig(loop_rate=2.0))
planner.run_type = "ActionServer"
controller = Controller(component_name="controller")
controller.algorithm = ControllersID.PURE_PURSUIT
mapper = LocalMapper(component_name="mapper")
# Where a test commands it beside the controller, it is told to let it.
driver = DriveManager(
    component_name="drive_manager",
    config=DriveManagerConfig(command_publishers=int(os.environ.get("COMMAND_PUBLISHERS", "1"))),
)

emergency = Topic(name="emergency_stop", msg_type="Bool")
blocked = Event(emergency.msg.data == True).as_rule("keep", protected=True)  # noqa: E712

launcher = Launcher()
launcher.kompass(
    components=[planner, controller, mapper, driver],
    events_actions={blocked: LogInfo(msg="the way is blocked")},
    multi_processing=True,
)
launcher.open_to_rules(topics=["/lights"])
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.robot = RobotConfig(
    model_type=RobotType.DIFFERENTIAL_DRIVE,
    geometry_type=RobotGeometry.Type.CYLINDER,
    geometry_params=np.array([0.1, 0.3]),
    ctrl_vx_limits=LinearCtrlLimits(max_vel=0.22, max_acc=1.5, max_decel=2.5),
    ctrl_omega_limits=AngularCtrlLimits(max_vel=1.5, max_acc=3.0, max_decel=3.0),
)
launcher.bringup()
