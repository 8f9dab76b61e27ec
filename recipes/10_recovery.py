"""Help before giving up: the recovery ladder.

A goal is given up when the robot has got nowhere for a while: the planner's ``patience``. Before
that, ``launcher.recovery()`` has it try to help itself, step after step, each a rule that the page
shows and changes like any other:

    20 % of the patience    forget what was seen and is out of sight
    30 %                    back off, as far as the scan has measured that nothing is there
    40 %                    turn to where there is room
    50 %                    plan around what is in the way, with more room beside the path
    60 %                    the same with less
    70 %                    wait, up to 30 seconds, for the way to come free
    100 %                   the goal is given up: an alarm says what is in the way, where, and
                            since when

While a step helps, the patience does not run on; when the robot gets on, it begins anew.

    kompass-console run recipes/10_recovery.py --sim

Try it, each with a goal under way:

    ... --sim --fault person_ahead:20:25     somebody steps into the way and stands there: the robot
                                             gives way, looks for a way around, waits, and goes on
    ... --sim --fault boxed_in:20:40         walls stand around it: nothing helps but to wait
    ... --sim --fault wheel_blocked:20       nothing helps: the goal ends with its reason, and an
                                             alarm
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

planner = Planner(
    component_name="planner",
    # The steps are shares of it: 15 s, unless stated.
    config=PlannerConfig(goals_from_topics=True, patience=20.0),
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
driver = DriveManager(component_name="drive_manager")

launcher = Launcher()
launcher.kompass(components=[planner, controller, mapper, driver], multi_processing=True)
launcher.recovery()
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.robot = my_robot
launcher.bringup()
