"""Between ROS messages and the arrays of the algorithms."""

from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, PoseStamped, Quaternion
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from numpy.typing import NDArray

from kompass.algorithms.geometry import Pose2D, quaternion_from_yaw, yaw_from_quaternion
from kompass.algorithms.grid import Grid


def pose_of(message: Any) -> Pose2D:
    """(x, y, yaw) of an Odometry, PoseStamped or Pose [m, m, rad]."""
    pose = _pose_in(message)
    return pose.position.x, pose.position.y, yaw_of(pose.orientation)


def orientation_of(message: Any) -> Quaternion:
    """The orientation of an Odometry, PoseStamped or Pose."""
    return _pose_in(message).orientation


def _pose_in(message: Any) -> Any:
    pose = message
    while hasattr(pose, "pose"):
        pose = pose.pose
    return pose


def yaw_of(q: Quaternion) -> float:
    """Yaw of an orientation [rad]."""
    return float(yaw_from_quaternion(q.x, q.y, q.z, q.w))


def is_rotation(q: Quaternion) -> bool:
    """Whether an orientation is one: of about length 1, which all zeros are not."""
    return bool(abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0) < 0.1)


def quaternion_msg(yaw: float) -> Quaternion:
    """Orientation of a yaw [rad]."""
    x, y, z, w = (float(value) for value in quaternion_from_yaw(yaw))
    return Quaternion(x=x, y=y, z=z, w=w)


def speed_of(odometry: Odometry) -> tuple[float, float, float]:
    """(vx, vy, omega) in the robot's frame [m/s, m/s, rad/s]."""
    twist = odometry.twist.twist
    return twist.linear.x, twist.linear.y, twist.angular.z


def path_msg(poses: NDArray[np.float64], frame: str, stamp: Time) -> Path:
    """A Path of poses of shape (N, 3)."""
    path = Path()
    path.header.frame_id = frame
    path.header.stamp = stamp
    for x, y, yaw in poses:
        pose = PoseStamped(header=path.header)
        pose.pose.position = Point(x=float(x), y=float(y))
        pose.pose.orientation = quaternion_msg(float(yaw))
        path.poses.append(pose)
    return path


def path_poses(path: Path) -> NDArray[np.float64]:
    """Poses of shape (N, 3) of a Path."""
    return np.array([pose_of(pose) for pose in path.poses], dtype=np.float64).reshape(-1, 3)


def grid_of(message: OccupancyGrid) -> Grid:
    """The grid of an OccupancyGrid."""
    info = message.info
    origin = (info.origin.position.x, info.origin.position.y, yaw_of(info.origin.orientation))
    return Grid.from_row_major(
        np.asarray(message.data, dtype=np.int8), info.width, info.height, info.resolution, origin
    )


def grid_msg(grid: Grid, frame: str, stamp: Time) -> OccupancyGrid:
    """The OccupancyGrid of a grid."""
    message = OccupancyGrid()
    message.header.frame_id = frame
    message.header.stamp = stamp
    message.info.map_load_time = stamp
    message.info.resolution = float(grid.resolution)
    message.info.height, message.info.width = (int(n) for n in grid.cells.shape)
    x, y, yaw = grid.origin
    message.info.origin.position = Point(x=float(x), y=float(y))
    message.info.origin.orientation = quaternion_msg(yaw)
    # The bytes of an int8 array are what array.array('b') holds: no copy cell by cell.
    message.data.frombytes(np.ascontiguousarray(grid.cells, dtype=np.int8).tobytes())
    return message
