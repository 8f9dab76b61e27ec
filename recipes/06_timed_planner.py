"""A planner without an action: it follows the newest goal, as long as there is one.

As a *Timed* component the planner takes goals from a topic and keeps the path fresh from where the
robot is: it plans anew when the robot has strayed from it, or the map has closed it. There is no
action to follow and to cancel; a new click simply replaces the old one.

    kompass-console run recipes/06_timed_planner.py --sim
"""

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

my_robot = RobotConfig(
    model_type=RobotType.DIFFERENTIAL_DRIVE,
    geometry_type=RobotGeometry.Type.CYLINDER,
    geometry_params=np.array([0.1, 0.3]),
    ctrl_vx_limits=LinearCtrlLimits(max_vel=0.22, max_acc=1.5, max_decel=2.5),
    ctrl_omega_limits=AngularCtrlLimits(max_vel=1.5, max_acc=3.0, max_decel=3.0),
)

planner = Planner(component_name="planner", config=PlannerConfig(loop_rate=2.0))
planner.run_type = "Timed"
planner.inputs(goal_point=Topic(name="/clicked_point", msg_type="PointStamped"))

controller = Controller(component_name="controller")
controller.algorithm = ControllersID.PURE_PURSUIT
mapper = LocalMapper(component_name="mapper")
driver = DriveManager(component_name="drive_manager")

launcher = Launcher()
# One process for all components instead of one for each: less memory, and a crash of one takes the
# others along (an exception does not: it becomes that component's status).
launcher.kompass(components=[planner, controller, mapper, driver], multi_processing=False)
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.robot = my_robot
launcher.bringup()
