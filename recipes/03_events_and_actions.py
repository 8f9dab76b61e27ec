"""Events and actions: the robot answers to what happens.

An *event* is a condition over messages; an *action* is what is done when it becomes, or is, true.
The launcher takes them as a dictionary. Here a click becomes a goal of the planner's action
server through a function of ours, and a stuck controller asks the drive manager to move free.

    kompass-console run recipes/03_events_and_actions.py --sim

Try it: send the robot somewhere, and have walls stand around it after 20 s:

    ... --sim --fault boxed_in:20

(The service /simulator/set_fault takes them away again; see README.md beside this file.)
What each rule did, and why, is in the console, and on the topic /monitor/firings.
"""

import numpy as np
from geometry_msgs.msg import PointStamped
from kompass_interfaces.action import PlanPath
from sugar.msg import ComponentStatus

from kompass.actions import Action, ComponentActions, LogInfo
from kompass.components import Controller, DriveManager, LocalMapper, Planner
from kompass.control import ControllersID
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotGeometry,
    RobotType,
)
from kompass.ros import Event, Launcher, Topic

my_robot = RobotConfig(
    model_type=RobotType.DIFFERENTIAL_DRIVE,
    geometry_type=RobotGeometry.Type.CYLINDER,
    geometry_params=np.array([0.1, 0.3]),
    ctrl_vx_limits=LinearCtrlLimits(max_vel=0.22, max_acc=1.5, max_decel=2.5),
    ctrl_omega_limits=AngularCtrlLimits(max_vel=1.5, max_acc=3.0, max_decel=3.0),
)

planner = Planner(component_name="planner")
planner.run_type = "ActionServer"
# DWA avoids what it sees, and says when there is no way out. (Pure pursuit looks at nothing.)
controller = Controller(component_name="controller")
controller.algorithm = ControllersID.DWA
controller.direct_sensor = True
mapper = LocalMapper(component_name="mapper")
driver = DriveManager(component_name="drive_manager")

# A topic alone is an event: each message.
clicked = Topic(name="/clicked_point", msg_type="PointStamped")
on_click = Event(clicked).as_rule("click-to-goal", name="Click → drive there")

# A comparison is an event too. The field's name and the type of the value are checked right here.
# Without more it fires for each message for which it is true; see also on_change and handle_once.
on_stuck = Event(
    controller.status_topic.msg.status == ComponentStatus.STATUS_FAILURE_ALGORITHM_LEVEL,
    keep_event_delay=30.0,  # not again within half a minute after the action has finished
).as_rule("stuck-unblock", name="Controller stuck → unblock")  # what people see in the console

# An action for any server of the ROS graph; here the planner's own.
send_goal = ComponentActions.send_action_goal(
    action_name="/planner/plan_path", action_type=PlanPath, action_request_msg=PlanPath.Goal()
)


def goal_of(*, msg: PointStamped, **_) -> PlanPath.Goal:
    """The goal of a click: there, 5 cm near, with any heading."""
    goal = PlanPath.Goal()
    goal.goal.position = msg.point
    goal.end_tolerance.lateral_distance_error = 0.05
    goal.end_tolerance.orientation_error = np.pi
    return goal


send_goal.event_parser(goal_of, output_mapping="action_request_msg")

launcher = Launcher()
launcher.kompass(
    components=[planner, controller, mapper, driver],
    events_actions={
        on_click: [LogInfo(msg="a click: there we go"), send_goal],
        on_stuck: Action(driver.move_to_unblock),
    },
    multi_processing=True,
)
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.robot = my_robot
launcher.bringup()
