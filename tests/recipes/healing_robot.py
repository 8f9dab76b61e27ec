"""For tests: the four components, with a rule for each way of healing that the tests provoke.

Events of the older API and of today's stand in one table.
"""

import os

import numpy as np
from automatika_ros_sugar.msg import ComponentStatus
from kompass_interfaces.action import MotionRecording
from nav2_msgs.srv import ClearEntireCostmap, LoadMap
from rclpy.qos import DurabilityPolicy

from kompass import event
from kompass.actions import Action, ComponentActions, LogInfo
from kompass.components import Controller, DriveManager, LocalMapper, Planner, PlannerConfig
from kompass.control import ControllersID
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotGeometry,
    RobotType,
)
from kompass.ros import Event, Launcher, QoSConfig, Topic
from kompass.share import map_path

planner = Planner(component_name="planner", config=PlannerConfig(loop_rate=2.0, patience=30.0))
planner.run_type = "ActionServer"
controller = Controller(component_name="controller")
controller.algorithm = ControllersID.PURE_PURSUIT
controller.direct_sensor = True
mapper = LocalMapper(component_name="mapper")
driver = DriveManager(component_name="drive_manager")
stamped = os.environ.get("ROS_DISTRO") in ["rolling", "jazzy", "kilted"]
driver.outputs(
    robot_command=Topic(name="/cmd_vel", msg_type="TwistStamped" if stamped else "Twist")
)
driver.on_fail(action=Action(driver.restart), max_retries=1)
driver.on_giveup(action=LogInfo(msg="the drive manager is given up"))
mapper.on_system_fail(action=LogInfo(msg="the mapper misses something"), max_retries=1)

unblock = Action(method=driver.move_to_unblock)
emergency = Topic(name="emergency_stop", msg_type="Bool")
armed = Topic(
    name="/test/armed",
    msg_type="Bool",
    qos_profile=QoSConfig(durability=DurabilityPolicy.TRANSIENT_LOCAL),
)
load_map = ComponentActions.send_srv_request(
    srv_name="/map_server/load_map",
    srv_type=LoadMap,
    srv_request_msg=LoadMap.Request(map_url=str(map_path("hexagon"))),
)
no_map = event.OnEqual(
    "no_map",
    planner.status_topic,
    ComponentStatus.STATUS_FAILURE_SYSTEM_LEVEL,
    "status",
    keep_event_delay=1.0,
)
start_blocked = Event(
    planner.status_topic.msg.status == ComponentStatus.STATUS_FAILURE_ALGORITHM_LEVEL,
    keep_event_delay=3.0,
)
stuck = event.OnEqual(
    "stuck",
    Topic(name="controller_status", msg_type="ComponentStatus"),
    ComponentStatus.STATUS_FAILURE_ALGORITHM_LEVEL,
    "status",
    keep_event_delay=1.0,
)
in_emergency = Event(emergency.msg.data.is_true() & armed.msg.data.is_true(), keep_event_delay=10.0)

point = Topic(name="/test/point", msg_type="PointStamped")
silent = Topic(name="/test/silent", msg_type="Bool")
first = Topic(name="/test/first", msg_type="Bool")
second = Topic(name="/test/second", msg_type="Int32")
odometry = Topic(name="/odometry/filtered", msg_type="Odometry")
speed = odometry.msg.twist.twist.linear.x
moving = (speed > 0.05) & armed.msg.data.is_true()
# The speed is measured with noise: moving above one bound, standing below another.
sets_off = Event(moving, on_change=True).as_rule("sets-off", clear=speed < 0.01)

launcher = Launcher()
launcher.kompass(
    components=[planner, controller, mapper, driver],
    events_actions={
        no_map: load_map,
        start_blocked: unblock,
        stuck: unblock,
        in_emergency: [ComponentActions.restart(component=planner), unblock],
        # Nodes that are not of this stack.
        event.OnAny("clear", Topic(name="/test/clear", msg_type="Empty")): (
            ComponentActions.send_srv_request(
                srv_name="/global_costmap/clear_entirely_global_costmap",
                srv_type=ClearEntireCostmap,
                srv_request_msg=ClearEntireCostmap.Request(),
            )
        ),
        event.OnAny("record", Topic(name="/test/record", msg_type="Empty")): (
            ComponentActions.send_action_goal(
                action_name="/stranger/record",
                action_type=MotionRecording,
                action_request_msg=MotionRecording.Goal(recording_period_secs=0.2),
            )
        ),
        event.OnAny("absent", Topic(name="/test/absent", msg_type="Empty")): (
            ComponentActions.send_srv_request(srv_name="/nobody/clear", srv_type=ClearEntireCostmap)
        ),
        # Three ways to say: each message.
        event.OnGreater("point_greater", point, 0, ["header", "stamp", "sec"]): LogInfo(msg="1"),
        event.OnAny("point_any", point): LogInfo(msg="2"),
        Event(point): LogInfo(msg="3"),
        # Conditions over several topics.
        Event(~silent.msg.data.is_true()): LogInfo(msg="not true"),
        Event(first.msg.data.is_true() & (second.msg.data > 0), on_change=True): LogInfo(msg="4"),
        Event(moving, on_change=True): LogInfo(msg="5"),
        sets_off: LogInfo(msg="6"),
    },
    activate_all_components_on_start=True,
    multi_processing=True,
)
launcher.inputs(location=odometry)
launcher.robot = RobotConfig(
    model_type=RobotType.DIFFERENTIAL_DRIVE,
    geometry_type=RobotGeometry.Type.CYLINDER,
    geometry_params=np.array([0.1, 0.3]),
    ctrl_vx_limits=LinearCtrlLimits(max_vel=0.22, max_acc=1.5, max_decel=2.5),
    ctrl_omega_limits=AngularCtrlLimits(max_vel=1.5, max_acc=3.0, max_decel=3.0),
)
launcher.bringup()
