"""See with several sensors: what one of them looks over, another one meets.

A lidar sees what stands in its plane, and nothing lower: no step, no pallet, no box. A depth camera
does (sensor_msgs/PointCloud2), as far as it looks, and a second scanner looks where the first one
cannot. Here the planner plans around what any of them has seen. The drive manager lets the robot go
only as long as all of them speak, and where none shows something in the way. No map is needed.

    kompass-console run recipes/09_several_sensors.py --sim --robot turtlebot3-plus

The robot of that name has a lidar of 270 degrees on top, a scanner low behind, which sees what it
backs into, and a depth camera ahead. Where each is mounted comes from the frame that its messages
name, and /tf_static. Of the cloud counts what is between cloud_min_height and the robot's height.

Try it: add --fault low_box:30, and send it across the room before that. A box of 10 cm stands in
its way then, which the lidar does not see, and the robot goes round it.
"""

import numpy as np

from kompass.components import (
    Controller,
    ControllerConfig,
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
from kompass.ros import Launcher, Topic

my_robot = RobotConfig(
    model_type=RobotType.DIFFERENTIAL_DRIVE,
    geometry_type=RobotGeometry.Type.CYLINDER,
    geometry_params=np.array([0.1, 0.2]),
    ctrl_vx_limits=LinearCtrlLimits(max_vel=0.22, max_acc=1.5, max_decel=2.5),
    ctrl_omega_limits=AngularCtrlLimits(max_vel=1.5, max_acc=3.0, max_decel=3.0),
)

planner = Planner(
    component_name="planner", config=PlannerConfig(use_sensor=True, goals_from_topics=True)
)
planner.run_type = "ActionServer"
planner.inputs(
    goal_point=[
        Topic(name="/goal_pose", msg_type="PoseStamped"),
        Topic(name="/clicked_point", msg_type="PointStamped"),
    ]
)

controller = Controller(
    component_name="controller", config=ControllerConfig(algorithm=ControllersID.DWA)
)
mapper = LocalMapper(component_name="mapper")
driver = DriveManager(
    component_name="drive_manager", config=DriveManagerConfig(cloud_min_height=0.05)
)

launcher = Launcher()
launcher.kompass(components=[planner, controller, mapper, driver], multi_processing=True)
launcher.inputs(
    location=Topic(name="/odometry/filtered", msg_type="Odometry"),
    # All components that look around take these; each names what it does not hear.
    sensor_data=[
        Topic(name="/scan", msg_type="LaserScan"),
        Topic(name="/rear_scan", msg_type="LaserScan"),
        Topic(name="/camera/points", msg_type="PointCloud2"),
    ],
)
launcher.robot = my_robot
launcher.bringup()
