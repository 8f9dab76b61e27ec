"""Call the services of other nodes when something happens.

The planner without a map is a SYSTEM failure: something outside is missing. The answer is a call to
the map server, which is no component of ours: any service of the ROS graph can be called so.

    kompass-console run recipes/05_external_services.py --sim --fault map_withheld

With that fault the map server starts without a map: the rule has it loaded, and the planner is
healthy. The other rule clears the costmap of another node (the embedded robot brings a stand-in for
Nav2's) when the planner finds no way, as when the map shows an obstacle where the robot stands:

    ... --sim --fault start_occupied:20
"""

import numpy as np
from nav2_msgs.srv import ClearEntireCostmap, LoadMap
from sugar.msg import ComponentStatus

from kompass.actions import ComponentActions
from kompass.components import Controller, DriveManager, LocalMapper, Planner, PlannerConfig
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotGeometry,
    RobotType,
)
from kompass.ros import Event, Launcher, Topic
from kompass.share import map_path

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
mapper = LocalMapper(component_name="mapper")
driver = DriveManager(component_name="drive_manager")

# The request is a message like any other, filled in when the recipe is read.
load_map = ComponentActions.send_srv_request(
    srv_name="/map_server/load_map",
    srv_type=LoadMap,
    srv_request_msg=LoadMap.Request(map_url=str(map_path("hexagon"))),
)
no_map = Event(
    planner.status_topic.msg.status == ComponentStatus.STATUS_FAILURE_SYSTEM_LEVEL,
    keep_event_delay=5.0,
).as_rule("no-map", name="No map → have it loaded")

# A costmap may hold what is long gone. Clearing it costs little, so it is worth a try.
clear_costmap = ComponentActions.send_srv_request(
    srv_name="/global_costmap/clear_entirely_global_costmap",
    srv_type=ClearEntireCostmap,
    srv_request_msg=ClearEntireCostmap.Request(),
)
no_way = Event(
    planner.status_topic.msg.status == ComponentStatus.STATUS_FAILURE_ALGORITHM_LEVEL,
    keep_event_delay=10.0,
).as_rule("no-way", name="No way → clear the costmap")

launcher = Launcher()
launcher.kompass(
    components=[planner, controller, mapper, driver],
    events_actions={no_map: load_map, no_way: clear_costmap},
    multi_processing=True,
)
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.robot = my_robot
launcher.bringup()
