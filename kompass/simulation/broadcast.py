"""Publishes what a real base publishes, and what only a simulator knows."""

from __future__ import annotations

import math
from contextlib import suppress

from builtin_interfaces.msg import Time as StampMessage
from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from sensor_msgs.msg import BatteryState, Image, Imu, LaserScan, PointCloud2
from std_msgs.msg import Float32, String, UInt32
from tf2_msgs.msg import TFMessage

from kompass.algorithms.geometry import compose, inverse
from kompass.bus.node import Node, Publisher
from kompass.rclpy_ext.qos import LATCHED_PROFILE
from kompass.simulation import messages
from kompass.simulation.battery import voltage
from kompass.simulation.description import description
from kompass.simulation.physics.parts import NoReading
from kompass.simulation.physics.robot_model import PICTURE, POINTS, REAR_SCAN
from kompass.simulation.robot import SimulatedRobot

MAP, ODOM, BASE, LIDAR, IMU = "map", "odom", "base_link", "LDS-01", "imu_link"
REAR, CAMERA = "rear_scanner", "camera_link"

_RELIABLE = QoSProfile(depth=10)
_SENSOR = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
_TRANSFORMS = QoSProfile(depth=100)


class Broadcast:
    """All publishers of the embedded robot.

    Parameters
    ----------
    always
        Whether to send also what nobody has subscribed to: for who hears of all that is sent.
    """

    def __init__(self, node: Node, robot: SimulatedRobot, *, always: bool = False) -> None:
        self._robot, self._always = robot, always
        self._clock = node.get_clock()
        publisher = node.create_publisher
        self._scan = publisher(LaserScan, "/scan", _SENSOR)
        self._rear = self._cloud = self._picture = None
        if robot.rear is not None:
            self._rear = publisher(LaserScan, REAR_SCAN, _SENSOR)
        if robot.camera is not None:
            self._cloud = publisher(PointCloud2, POINTS, _SENSOR)
        if robot.picture_camera is not None:
            self._picture = publisher(Image, PICTURE, _SENSOR)
        self._imu = publisher(Imu, "/imu", _SENSOR)
        self._filtered = publisher(Odometry, "/odometry/filtered", _RELIABLE)
        self._wheels = publisher(Odometry, "/odom", _RELIABLE)
        self._truth = publisher(Odometry, "/simulator/ground_truth", _RELIABLE)
        self._tf = publisher(TFMessage, "/tf", _TRANSFORMS)
        self._tf_static = publisher(TFMessage, "/tf_static", LATCHED_PROFILE)
        self._description = publisher(String, "/robot_description", LATCHED_PROFILE)
        self._rate = publisher(Float32, "/simulator/rate", _RELIABLE)
        self._contacts = publisher(UInt32, "/simulator/contacts", LATCHED_PROFILE)
        self._person_contacts = publisher(UInt32, "/simulator/person_contacts", LATCHED_PROFILE)
        self._battery = publisher(BatteryState, "/battery_state", _RELIABLE)
        self._published_contacts = (-1, -1)
        # Filled again and again: publishing one takes it as it is in that moment.
        self._truth_message = messages.odometry(MAP)
        self._filtered_message = messages.odometry(MAP)
        self._wheels_message = messages.odometry(ODOM)
        self._imu_message = messages.inertial(IMU)
        self._correction = messages.transform(MAP, ODOM)
        self._motion = messages.transform(ODOM, BASE)
        self._tf_message = TFMessage(transforms=[self._correction, self._motion])
        self._announce_sensors()
        self._description.publish(String(data=description(robot.kind)))

    def motion(self) -> None:
        """Odometry of every kind, transforms and inertial readings: once per control period."""
        now = self._clock.now()
        stamp = now.to_msg()
        fill = messages.fill_odometry
        if self._is_heard(self._truth):
            self._truth.publish(fill(self._truth_message, self._robot.truth(), stamp))
        inertial = self._robot.imu()  # its noise is the same whether or not somebody listens
        if self._is_heard(self._imu):
            self._imu.publish(messages.fill_inertial(self._imu_message, inertial, stamp))
        if (self._robot.contacts, self._robot.person_contacts) != self._published_contacts:
            self.contacts()
        with suppress(NoReading):
            self._odometry(now)

    def _odometry(self, now: Time) -> None:
        wheels, filtered = self._robot.wheel_odometry(), self._robot.filtered()
        # Both are of one age: the faults that make them late make both late.
        stamp = _stamp(now, filtered.age)
        fill = messages.fill_odometry
        self._filtered.publish(fill(self._filtered_message, filtered, stamp))
        if self._is_heard(self._wheels):
            self._wheels.publish(fill(self._wheels_message, wheels, stamp))
        if not self._is_heard(self._tf):
            return
        correction = compose(filtered.pose, inverse(wheels.pose))
        x, y, yaw = (float(part) for part in correction)
        messages.fill_transform(self._correction, (x, y, yaw), stamp)
        messages.fill_transform(self._motion, wheels.pose, stamp)
        self._tf.publish(self._tf_message)

    def cloud(self) -> None:
        """One image of the depth camera, where there is one."""
        camera, publisher = self._robot.camera, self._cloud
        if camera is None or publisher is None or not self._is_heard(publisher):
            return
        stamp = self._clock.now().to_msg()
        publisher.publish(messages.point_cloud(camera.points(), stamp, CAMERA))

    def picture(self) -> None:
        """One picture in colours, where there is such a camera and somebody looks.

        Who hears of all that is sent is no reason: it would cost a drill more than all its physics.
        """
        camera, publisher = self._robot.picture_camera, self._picture
        if camera is None or publisher is None or publisher.get_subscription_count() == 0:
            return
        stamp = self._clock.now().to_msg()
        publisher.publish(messages.picture(camera.picture(), stamp, CAMERA))

    def scan(self, period: float) -> None:
        """One turn of the lidars, ``period`` seconds after the one before."""
        now = self._clock.now()
        with suppress(NoReading):
            ranges = self._robot.scan()
            stamp = _stamp(now, self._robot.scan_age)
            self._scan.publish(
                messages.laser_scan(ranges, stamp, LIDAR, period, self._robot.kind.lidar)
            )
        rear, kind = self._robot.rear, self._robot.kind.rear
        if rear is not None and kind is not None and self._rear is not None:
            self._rear.publish(
                messages.laser_scan(rear.scan(), now.to_msg(), REAR, period, kind.lidar)
            )

    def rate(self, rate: float) -> None:
        """Simulated seconds per real second."""
        self._rate.publish(Float32(data=rate))

    def contacts(self) -> None:
        """How often the robot has touched something, and how often that was a person."""
        contacts, with_people = self._robot.contacts, self._robot.person_contacts
        self._published_contacts = (contacts, with_people)
        self._contacts.publish(UInt32(data=contacts))
        self._person_contacts.publish(UInt32(data=with_people))

    def battery(self) -> None:
        """How full the battery is."""
        battery = self._robot.battery
        status = (
            BatteryState.POWER_SUPPLY_STATUS_CHARGING
            if battery.charging
            else BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
        )
        message = BatteryState(
            percentage=battery.charge,
            voltage=voltage(battery.charge),
            power_supply_status=status,
            present=True,
        )
        message.header.stamp = self._clock.now().to_msg()
        self._battery.publish(message)

    def _is_heard(self, publisher: Publisher) -> bool:
        """Whether a message is worth making: fifty times a second that is most of the work."""
        return self._always or publisher.get_subscription_count() > 0

    def _announce_sensors(self) -> None:
        stamp = self._clock.now().to_msg()
        origin = (0.0, 0.0, 0.0)
        sensors = (
            messages.transform(BASE, LIDAR, self._robot.kind.lidar.height),
            messages.transform(BASE, IMU, self._robot.kind.imu_height),
        )
        found = [messages.fill_transform(one, origin, stamp) for one in sensors]
        rear, camera = self._robot.kind.rear, self._robot.kind.camera
        more = []
        if rear is not None:
            place = (-rear.behind, 0.0, rear.lidar.height)
            more.append(messages.mounting(BASE, REAR, place, math.pi))
        if camera is not None:
            place = (camera.ahead, 0.0, camera.height)
            more.append(messages.mounting(BASE, CAMERA, place, 0.0, camera.down))
        for one in more:
            one.header.stamp = stamp
        self._tf_static.publish(TFMessage(transforms=[*found, *more]))


def _stamp(now: Time, age: float) -> StampMessage:
    """When it was measured what is published ``age`` seconds late."""
    return (now - Duration(nanoseconds=round(age * 1e9)) if age else now).to_msg()
