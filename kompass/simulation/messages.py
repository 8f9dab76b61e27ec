"""The robot's readings as ROS messages."""

from __future__ import annotations

import array
import math

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Quaternion, TransformStamped
from nav_msgs.msg import Odometry
from numpy.typing import NDArray
from sensor_msgs.msg import Image, Imu, LaserScan, PointCloud2, PointField

from kompass.algorithms.geometry import quaternion_from_yaw
from kompass.simulation.physics.motion import BodyMotion, Matrix3
from kompass.simulation.physics.robot_model import LidarModel
from kompass.simulation.sensors import imu

# Where the covariances of x, y and yaw stand among those of (x, y, z, roll, pitch, yaw).
_PLANAR = np.array([0, 1, 5, 6, 7, 11, 30, 31, 35])
# Of what a planar robot does not measure: it is held on the floor.
_OFF_PLANE = 1e-9
_FLAT = np.zeros(36)
_FLAT[[14, 21, 28]] = _OFF_PLANE


def spatial_covariance(planar: Matrix3) -> NDArray[np.float64]:
    """(36,) row-major covariance of (x, y, z, roll, pitch, yaw) from that of (x, y, yaw)."""
    if not planar.any():
        return np.zeros(36)
    full = _FLAT.copy()
    full[_PLANAR] = planar.ravel()
    return full


def odometry(frame: str, child: str = "base_link") -> Odometry:
    """nav_msgs/Odometry in ``frame``, its twist in ``child``; see :func:`fill_odometry`."""
    message = Odometry()
    message.header.frame_id = frame
    message.child_frame_id = child
    return message


def fill_odometry(message: Odometry, motion: BodyMotion, stamp: Time) -> Odometry:
    """The same message with ``motion``: it costs a third of what making another does."""
    message.header.stamp = stamp
    x, y, yaw = motion.pose
    pose = message.pose.pose
    pose.position.x, pose.position.y = x, y
    _set_yaw(pose.orientation, yaw)
    twist = message.twist.twist
    twist.linear.x, twist.linear.y, twist.angular.z = motion.twist
    message.pose.covariance = spatial_covariance(motion.pose_covariance)
    message.twist.covariance = spatial_covariance(motion.twist_covariance)
    return message


def transform(parent: str, child: str, height: float = 0.0) -> TransformStamped:
    """Where ``child`` is in ``parent``: at its origin, ``height`` metres up."""
    message = TransformStamped()
    message.header.frame_id = parent
    message.child_frame_id = child
    message.transform.translation.z = height
    return message


def fill_transform(
    message: TransformStamped, pose: tuple[float, float, float], stamp: Time
) -> TransformStamped:
    """The same message with a planar pose (x, y, yaw)."""
    message.header.stamp = stamp
    translation = message.transform.translation
    translation.x, translation.y = pose[0], pose[1]
    _set_yaw(message.transform.rotation, pose[2])
    return message


def mounting(
    parent: str, child: str, place: tuple[float, float, float], yaw: float, down: float = 0.0
) -> TransformStamped:
    """Where a sensor is on the robot [m], turned left by ``yaw``, then down [rad]."""
    message = TransformStamped()
    message.header.frame_id = parent
    message.child_frame_id = child
    offset, turned = message.transform.translation, message.transform.rotation
    offset.x, offset.y, offset.z = place
    half, nod = yaw / 2, down / 2
    turned.w, turned.x = math.cos(half) * math.cos(nod), -math.sin(half) * math.sin(nod)
    turned.y, turned.z = math.cos(half) * math.sin(nod), math.sin(half) * math.cos(nod)
    return message


def point_cloud(points: NDArray[np.float32], stamp: Time, frame: str) -> PointCloud2:
    """``points`` (rows, columns, 3) as an organized sensor_msgs/PointCloud2."""
    rows, columns, _ = points.shape
    message = PointCloud2()
    message.header.stamp = stamp
    message.header.frame_id = frame
    message.height, message.width = rows, columns
    message.fields = [
        PointField(name=name, offset=4 * index, datatype=PointField.FLOAT32, count=1)
        for index, name in enumerate("xyz")
    ]
    message.point_step, message.row_step = 12, 12 * columns
    message.is_dense = False
    message.data = array.array("B", points.tobytes())
    return message


def picture(pixels: NDArray[np.uint8], stamp: Time, frame: str) -> Image:
    """``pixels`` (rows, columns, 3) of red, green and blue as sensor_msgs/Image."""
    rows, columns, _ = pixels.shape
    message = Image(height=rows, width=columns, encoding="rgb8", step=3 * columns)
    message.header.stamp = stamp
    message.header.frame_id = frame
    message.data = array.array("B", pixels.tobytes())
    return message


def laser_scan(
    ranges: NDArray[np.float32], stamp: Time, frame: str, period: float, lidar: LidarModel
) -> LaserScan:
    """``ranges`` (N,) as sensor_msgs/LaserScan, ``period`` seconds after the one before."""
    message = LaserScan()
    message.header.stamp = stamp
    message.header.frame_id = frame
    message.angle_increment = lidar.increment
    message.angle_min = lidar.first
    message.angle_max = lidar.first + (lidar.rays - 1) * lidar.increment
    message.time_increment = 0.0  # all rays are cast at the stamp
    message.scan_time = period
    message.range_min = lidar.range_min
    message.range_max = lidar.range_max
    message.ranges = array.array("f", ranges.tobytes())
    return message


def inertial(frame: str) -> Imu:
    """sensor_msgs/Imu in ``frame``; see :func:`fill_inertial`."""
    message = Imu()
    message.header.frame_id = frame
    message.orientation_covariance = _ORIENTATION.copy()
    message.angular_velocity_covariance = _RATE.copy()
    message.linear_acceleration_covariance = _ACCELERATION.copy()
    return message


def fill_inertial(message: Imu, reading: imu.ImuReading, stamp: Time) -> Imu:
    """The same message with ``reading``."""
    message.header.stamp = stamp
    orientation = message.orientation
    orientation.x, orientation.y, orientation.z, orientation.w = reading.orientation
    rate, acceleration = message.angular_velocity, message.linear_acceleration
    rate.x, rate.y, rate.z = reading.angular_velocity.tolist()
    acceleration.x, acceleration.y, acceleration.z = reading.linear_acceleration.tolist()
    return message


def _set_yaw(quaternion: Quaternion, yaw: float) -> None:
    quaternion.x, quaternion.y, quaternion.z, quaternion.w = quaternion_from_yaw(yaw)


def _diagonal(deviation: float) -> NDArray[np.float64]:
    return (np.eye(3) * deviation**2).ravel()


_ORIENTATION = _diagonal(imu.ORIENTATION_NOISE)
_RATE = _diagonal(imu.GYRO_NOISE)
_ACCELERATION = _diagonal(imu.ACCELERATION_NOISE)
