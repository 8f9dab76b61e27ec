"""Components that look after themselves.

Every component says how it is on its status topic. A *fallback* is what it does about its own
failure: it is tried while the failure lasts, and forgotten when the component is well again.

    kompass-console run recipes/02_self_healing.py --sim

Try it:

    ... --sim --fault kill:controller:20      the controller's process is killed after 20 s: it is
                                              started again, and the robot goes on
    ... --sim --fault lidar_unplugged:20      no scan any more: the drive manager stops the robot at
                                              once, restarts itself a few times, and gives up loudly

On a real robot, `kill -9` the process that the terminal calls "controller", or unplug the lidar.
"""

import numpy as np

from kompass.actions import Action, LogInfo
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

planner = Planner(component_name="planner", config=PlannerConfig(goals_from_topics=True))
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
driver = DriveManager(component_name="drive_manager")

# Whatever goes wrong with the drive manager and lasts for a second: start it afresh, at most three
# times in a row. on_fail stands for any kind of failure; on_algorithm_fail, on_component_fail and
# on_system_fail come before it. Health puts the count back to zero.
driver.on_fail(action=Action(driver.restart), max_retries=3)
# When that did not help, say so: a person must look.
driver.on_giveup(action=LogInfo(msg="the drive manager cannot be mended; look at the robot"))

# An ALGORITHM failure: the data is there, and no command was found. Another algorithm may find one.
controller.on_algorithm_fail(
    action=Action(controller.set_algorithm, kwargs={"algorithm_value": "Stanley"}), max_retries=1
)

launcher = Launcher()
launcher.kompass(components=[planner, controller, mapper, driver], multi_processing=True)
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.robot = my_robot
launcher.bringup()
