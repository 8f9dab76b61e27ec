"""ROS messages in, plain values out.

ValueError names the field when a message contradicts itself.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from kompass.algorithms.geometry import yaw_from_quaternion
from kompass.algorithms.grid import Grid
from kompass_console.schema.plain import plain
from kompass_console.schema.world import MAP_FRAME, HindranceMark, Pose, RobotMotion, Scan


def seconds(stamp: Any) -> float:
    """builtin_interfaces/Time in s."""
    return float(stamp.sec) + float(stamp.nanosec) * 1e-9


def yaw_of(q: Any) -> float:
    """Heading (rad) of a quaternion message."""
    return yaw_from_quaternion(q.x, q.y, q.z, q.w)


def planar(pose: Any) -> Pose:
    """geometry_msgs/Pose seen from above."""
    yaw = yaw_of(pose.orientation)
    if not all(map(math.isfinite, (pose.position.x, pose.position.y, yaw))):
        raise ValueError("pose is not finite")
    return Pose(float(pose.position.x), float(pose.position.y), yaw)


# What `motion` looks at.
MOTION = (
    ("header", "stamp", "sec"),
    ("header", "stamp", "nanosec"),
    ("header", "frame_id"),
    *(("pose", "pose", "position", axis) for axis in "xy"),
    *(("pose", "pose", "orientation", part) for part in "xyzw"),
    ("twist", "twist", "linear", "x"),
    ("twist", "twist", "angular", "z"),
)


def motion(message: Any) -> RobotMotion:
    """nav_msgs/Odometry."""
    twist = message.twist.twist
    return RobotMotion(
        planar(message.pose.pose),
        float(twist.linear.x),
        float(twist.angular.z),
        seconds(message.header.stamp),
        str(message.header.frame_id).removeprefix("/") or MAP_FRAME,
    )


def scan(message: Any) -> Scan:
    """sensor_msgs/LaserScan."""
    return Scan(
        ranges=np.array(message.ranges, dtype=np.float32),
        angle_min=float(message.angle_min),
        angle_increment=float(message.angle_increment),
        range_min=float(message.range_min),
        range_max=float(message.range_max),
        stamp=seconds(message.header.stamp),
        frame=str(message.header.frame_id),
    )


def grid(message: Any) -> Grid:
    """nav_msgs/OccupancyGrid."""
    info = message.info
    origin = planar(info.origin)
    return Grid.from_row_major(message.data, info.width, info.height, info.resolution, origin)


def path(message: Any) -> npt.NDArray[np.float64]:
    """nav_msgs/Path as points (N, 2) in m."""
    points = [(p.pose.position.x, p.pose.position.y) for p in message.poses]
    line = np.array(points, dtype=np.float64).reshape(-1, 2)
    if not np.isfinite(line).all():
        raise ValueError("poses are not all finite")
    return line


def polygon(message: Any) -> npt.NDArray[np.float64]:
    """geometry_msgs/PolygonStamped as points (N, 2) in m."""
    points = np.array([(p.x, p.y) for p in message.polygon.points], dtype=np.float64)
    if len(points) < 3 or not np.isfinite(points).all():
        raise ValueError(f"polygon.points has {len(points)} usable points; it needs three")
    return points


def hindrance(message: Any) -> HindranceMark | None:
    """kompass_interfaces/GoalHindrance -> what is in the way; None when nothing is.

    Raises
    ------
    ValueError
        When its place is none.
    """
    if message.kind == "":
        return None
    x, y = float(message.place.x), float(message.place.y)
    if not (math.isfinite(x) and math.isfinite(y)):
        raise ValueError(f"place = ({x}, {y}); both must be finite")
    return HindranceMark(x, y, plain(message.text))
