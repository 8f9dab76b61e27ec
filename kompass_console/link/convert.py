"""ROS messages in, plain values out.

ValueError names the field when a message contradicts itself.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from kompass_console.schema.world import Grid, Motion, Pose, Scan


def seconds(stamp: Any) -> float:
    """builtin_interfaces/Time in s."""
    return float(stamp.sec) + float(stamp.nanosec) * 1e-9


def yaw_of(q: Any) -> float:
    """Heading (rad) of a quaternion message."""
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


def planar(pose: Any) -> Pose:
    """geometry_msgs/Pose seen from above."""
    yaw = yaw_of(pose.orientation)
    if not all(map(math.isfinite, (pose.position.x, pose.position.y, yaw))):
        raise ValueError("pose is not finite")
    return Pose(float(pose.position.x), float(pose.position.y), yaw)


def motion(message: Any) -> Motion:
    """nav_msgs/Odometry."""
    twist = message.twist.twist
    return Motion(
        planar(message.pose.pose),
        float(twist.linear.x),
        float(twist.angular.z),
        seconds(message.header.stamp),
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
    cells = np.frombuffer(message.data, dtype=np.int8)
    if info.width == 0 or info.height == 0 or len(cells) != info.width * info.height:
        raise ValueError(
            f"data has {len(cells)} cells, and info.width x info.height is "
            f"{info.width} x {info.height}"
        )
    if not info.resolution > 0.0:
        raise ValueError(f"info.resolution is {info.resolution} m; it must be positive")
    cells = cells.reshape(info.height, info.width).copy()
    return Grid(cells, float(info.resolution), planar(info.origin))


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
