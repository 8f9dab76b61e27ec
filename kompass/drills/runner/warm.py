"""What takes time when it is first used; in the process that all drives are forked from, once.

To be imported last: it makes what has been imported before stay out of the drives' way.
"""

from __future__ import annotations

import gc
from typing import Any

from action_msgs.msg import GoalStatusArray
from automatika_ros_sugar.msg import ComponentStatus
from geometry_msgs.msg import PointStamped, PolygonStamped, PoseStamped, Twist, TwistStamped
from kompass_interfaces.msg import DriveState, RuleFiring, StackState, TwistArray
from lifecycle_msgs.msg import TransitionEvent
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rclpy.type_support import check_is_valid_msg_type
from sensor_msgs.msg import Imu, LaserScan
from std_msgs.msg import Bool, Float32, String, UInt32
from tf2_msgs.msg import TFMessage

from kompass.algorithms.map_file import load_map
from kompass.components import Controller, DriveManager, LocalMapper, MapServer, Planner
from kompass.share import map_path
from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.registry import world
from kompass.virtual.wire import copier

# What goes about in every drive.
MESSAGES: tuple[Any, ...] = (
    Bool, ComponentStatus, DriveState, Float32, GoalStatusArray, Imu, LaserScan, OccupancyGrid,
    Odometry, Path, PointStamped, PolygonStamped, PoseStamped, RuleFiring, StackState, String,
    TFMessage, TransitionEvent, Twist, TwistArray, TwistStamped, UInt32,
)  # fmt: skip


for kind in MESSAGES:
    check_is_valid_msg_type(kind)  # loads what serializes it
    copier(kind)
for component in (Planner, Controller, LocalMapper, DriveManager, MapServer):
    component()  # its class is looked at for what may be set on it
SimulatedRobot(world("hexagon"))
load_map(map_path("hexagon"))
# No collection in a drive looks at what is here for good, nor copies the pages that it lies on.
gc.collect()
gc.freeze()
