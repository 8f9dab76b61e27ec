"""The embedded robots: what their bodies, wheels and lidars are like."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

REAR_SCAN, POINTS, PICTURE = "/rear_scan", "/camera/points", "/camera/image"
SENSORS = frozenset({REAR_SCAN, POINTS, PICTURE})  # that some of the robots have
_SPACING = 0.02  # m between points of an outline


@dataclass(frozen=True)
class LidarModel:
    """A planar lidar on the robot's axis.

    Attributes
    ----------
    rays
        How many a scan has; ray k looks along ``first + k * increment``.
    first, increment
        Radians anticlockwise from the robot's x axis.
    range_min, range_max
        Between them it measures [m].
    noise
        Standard deviation of one range [m].
    height
        Above the floor [m].
    """

    rays: int
    first: float
    increment: float
    range_min: float
    range_max: float
    noise: float
    height: float

    @property
    def saturated(self) -> float:
        """Reported for anything closer than it can measure [m].

        It lies just inside the valid interval, so that no reader mistakes an obstacle that touches
        the robot for free space.
        """
        return self.range_min + 0.001

    @property
    def angles(self) -> NDArray[np.float64]:
        """In which the rays look [rad], (rays,)."""
        return self.first + np.arange(self.rays, dtype=np.float64) * self.increment


@dataclass(frozen=True)
class RearScanner:
    """A planar scanner that looks back.

    Attributes
    ----------
    lidar
        What it is like; its angles are from where it looks.
    behind
        How far behind the robot's axis [m].
    """

    lidar: LidarModel
    behind: float


@dataclass(frozen=True)
class PictureModel:
    """A camera that takes pictures in colours, where the depth camera is.

    Attributes
    ----------
    rows, columns
        Of its picture.
    width_angle, height_angle
        That it sees across and upright [rad].
    range_max
        As far as it sees anything [m].
    """

    rows: int
    columns: int
    width_angle: float
    height_angle: float
    range_max: float


@dataclass(frozen=True)
class CameraModel:
    """A depth camera that looks ahead.

    Attributes
    ----------
    rows, columns
        Of its image.
    width_angle, height_angle
        That it sees across and upright [rad].
    down
        By how much it looks down [rad].
    ahead, height
        Where it is, from the robot's axis and above the floor [m].
    range_min, range_max
        Between them it measures [m].
    noise
        Standard deviation of one distance [m].
    picture
        What it shows in colours; None of one that only measures.
    """

    rows: int
    columns: int
    width_angle: float
    height_angle: float
    down: float
    ahead: float
    height: float
    range_min: float
    range_max: float
    noise: float
    picture: PictureModel | None = None


@dataclass(frozen=True)
class Steering:
    """Two wheels ahead that are steered, each towards the one centre of the turn (Ackermann).

    Attributes
    ----------
    wheel_base
        From the driven axle to the steered one [m].
    most
        Steering angle of the wheel that would be midway between the two [rad].
    rate
        With which it changes [rad/s].
    gain
        Of the servos [N·m per rad].
    """

    wheel_base: float
    most: float
    rate: float
    gain: float

    @property
    def turning_radius(self) -> float:
        """Of the tightest turn, of ``base_link`` [m]."""
        return self.wheel_base / math.tan(self.most)


@dataclass(frozen=True)
class OmniWheels:
    """Three wheels around the body, whose rollers let each slide along its axle.

    Attributes
    ----------
    away
        Of the wheels from the middle [m].
    directions
        In which they are: left, right, behind [rad].
    max_side_speed
        To which commands are cut [m/s].
    """

    away: float
    directions: tuple[float, float, float]
    max_side_speed: float


@dataclass(frozen=True)
class RobotModel:
    """A robot on two driven wheels and two casters, unless it is steered or has omni wheels.

    ``base_link`` lies on the floor midway between the driven wheels, x forward.

    Attributes
    ----------
    name
        What ``--robot NAME`` calls it.
    title
        One line for people.
    radius
        Of a round body; of a box, of the circle around it [m].
    box
        (length, width) of a body that is a box [m]; None for a round one.
    middle
        Of the body, ahead of ``base_link`` [m].
    body_height
        Of its top above the floor [m].
    body_mass
        Without the wheels [kg].
    mass_center
        Of the body, from ``base_link`` [m]. It lies behind the axle by more than the motors shift
        the weight, so that the robot never nods.
    wheel_radius, wheel_separation, wheel_mass
        [m], [m], [kg]
    wheel_edge
        Half axis of the wheels' ellipsoids across [m].
    wheel_torque
        Most of each motor [N·m].
    wheel_gain
        Of the motors' speed control [N·m per rad/s].
    caster_offset, caster_radius
        Of the casters before and behind the axle [m].
    front_caster_gap
        Of the front one above the floor [m]: it only catches a nod.
    imu_height
        Above the floor [m].
    max_speed, max_turn_rate
        To which commands are cut [m/s], [rad/s].
    usual_speed
        That those who drive it allow it [m/s].
    lidar
        On top.
    rear, camera
        Sensors that not every robot has.
    steering, omni
        How it moves, where that is not by the difference of two wheels.
    """

    name: str
    title: str
    radius: float
    box: tuple[float, float] | None
    body_height: float
    body_mass: float
    mass_center: tuple[float, float, float]
    wheel_radius: float
    wheel_separation: float
    wheel_mass: float
    wheel_edge: float
    wheel_torque: float
    wheel_gain: float
    caster_offset: float
    caster_radius: float
    front_caster_gap: float
    imu_height: float
    max_speed: float
    max_turn_rate: float
    usual_speed: float
    lidar: LidarModel
    rear: RearScanner | None = None
    camera: CameraModel | None = None
    middle: float = 0.0
    steering: Steering | None = None
    omni: OmniWheels | None = None

    @property
    def model_type(self) -> str:
        """How it moves, as a recipe's ``model_type`` has it."""
        if self.steering is not None:
            return "ACKERMANN"
        return "DIFFERENTIAL_DRIVE" if self.omni is None else "OMNI"

    @property
    def sensors(self) -> frozenset[str]:
        """Topics of those that not every robot has."""
        found = {REAR_SCAN} if self.rear is not None else set()
        if self.camera is not None:
            found.add(POINTS)
            if self.camera.picture is not None:
                found.add(PICTURE)
        return frozenset(found)

    @property
    def half_width(self) -> float:
        """From the middle of the body to its nearest side: what a way must be wider than [m]."""
        return self.radius if self.box is None else min(self.box) / 2

    def outline(self, pose: tuple[float, float, float]) -> NDArray[np.float64]:
        """Points around the body at a pose (x, y, yaw) in the map, (N, 2), 2 cm or less apart."""
        x, y, yaw = pose
        if self.box is None:
            count = math.ceil(math.tau * self.radius / _SPACING)
            angles = np.arange(count) * (math.tau / count)
            return np.column_stack(
                [x + self.radius * np.cos(angles), y + self.radius * np.sin(angles)]
            )
        half = np.array(self.box) / 2
        corners = half * [[1, 1], [-1, 1], [-1, -1], [1, -1], [1, 1]] + [self.middle, 0.0]
        sides = [
            np.linspace(one, other, math.ceil(math.dist(one, other) / _SPACING), endpoint=False)
            for one, other in itertools.pairwise(corners)
        ]
        body = np.concatenate(sides)
        cos, sin = math.cos(yaw), math.sin(yaw)
        return np.asarray(body @ np.array([[cos, sin], [-sin, cos]]) + (x, y))

    def gap(self, pose: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance between the body and points [m]; negative for points inside of it.

        Parameters
        ----------
        pose
            (N, 3) poses (x, y, yaw) in the map.
        points
            (M, 2) in the map.

        Returns
        -------
        NDArray[np.float64]
            (N, M).
        """
        away = points[None, :, :] - pose[:, None, :2]
        if self.box is None:
            return np.asarray(np.hypot(away[..., 0], away[..., 1]) - self.radius)
        cos, sin = np.cos(pose[:, 2, None]), np.sin(pose[:, 2, None])
        ahead = np.abs(cos * away[..., 0] + sin * away[..., 1] - self.middle) - self.box[0] / 2
        aside = np.abs(cos * away[..., 1] - sin * away[..., 0]) - self.box[1] / 2
        outside = np.hypot(np.maximum(ahead, 0.0), np.maximum(aside, 0.0))
        return np.asarray(outside + np.minimum(np.maximum(ahead, aside), 0.0))


TURTLEBOT3 = RobotModel(
    name="turtlebot3",
    title="TurtleBot3-sized: round, 0.10 m in radius, 0.3 m/s, a lidar all around to 3.5 m",
    radius=0.10,
    box=None,
    body_height=0.20,
    body_mass=0.94,
    mass_center=(-0.02, 0.0, 0.06),
    wheel_radius=0.033,
    wheel_separation=0.16,
    wheel_mass=0.03,
    wheel_edge=0.009,
    # 0.3 m/s in about 0.15 s: 2 x 0.04 N·m / 0.033 m drive 1 kg with 2.4 m/s².
    wheel_torque=0.04,
    wheel_gain=0.05,
    caster_offset=0.075,
    caster_radius=0.012,
    front_caster_gap=0.001,
    imu_height=0.07,
    max_speed=0.3,
    max_turn_rate=1.9,
    usual_speed=0.22,
    # Like the LDS-01.
    lidar=LidarModel(360, 0.0, math.tau / 360, 0.12, 3.5, 0.005, 0.17),
)

_JACKAL_BOX = (0.508, 0.430)
JACKAL = RobotModel(
    name="jackal",
    title="Jackal-sized: a box of 0.508 x 0.430 m, 2 m/s, a lidar of 270 degrees to 10 m",
    radius=math.hypot(*_JACKAL_BOX) / 2,
    box=_JACKAL_BOX,
    body_height=0.25,
    body_mass=16.0,
    mass_center=(-0.04, 0.0, 0.06),
    wheel_radius=0.098,
    wheel_separation=0.376,
    wheel_mass=0.4,
    wheel_edge=0.03,
    # 17 kg with 4 m/s²: 2 x 3.4 N·m / 0.098 m.
    wheel_torque=3.4,
    wheel_gain=3.0,
    caster_offset=0.20,
    caster_radius=0.03,
    front_caster_gap=0.0,
    imu_height=0.07,
    max_speed=2.0,
    max_turn_rate=4.0,
    usual_speed=2.0,
    lidar=LidarModel(541, -math.radians(135.0), math.radians(0.5), 0.10, 10.0, 0.005, 0.30),
)

TURTLEBOT3_PLUS = replace(
    TURTLEBOT3,
    name="turtlebot3-plus",
    title="TurtleBot3-sized: a lidar of 270 degrees, a scanner behind, a depth and colour camera",
    lidar=LidarModel(271, -math.radians(135.0), math.radians(1.0), 0.12, 3.5, 0.005, 0.17),
    rear=RearScanner(
        LidarModel(181, -math.radians(90.0), math.radians(1.0), 0.04, 3.5, 0.005, 0.06), 0.07
    ),
    # It sees the floor from a quarter of a metre before the robot's axis on.
    camera=CameraModel(
        rows=36,
        columns=72,
        width_angle=math.radians(87.0),
        height_angle=math.radians(58.0),
        down=math.radians(20.0),
        ahead=0.08,
        height=0.18,
        range_min=0.1,
        range_max=3.0,
        noise=0.003,
        # 20,000 rays: each picture takes 5 to 15 ms of a processor.
        picture=PictureModel(120, 160, math.radians(87.0), math.radians(70.0), 25.0),
    ),
)

_CAR_BOX, _CAR_MIDDLE = (0.60, 0.40), 0.20
ACKERMANN = RobotModel(
    name="ackermann",
    title="A car of 0.60 x 0.40 m: wheels steered by 0.6 rad, 0.40 m before the axle that drives; "
    "1.5 m/s, a lidar all around to 10 m",
    radius=math.hypot(_CAR_MIDDLE + _CAR_BOX[0] / 2, _CAR_BOX[1] / 2),
    box=_CAR_BOX,
    middle=_CAR_MIDDLE,
    body_height=0.25,
    body_mass=12.0,
    mass_center=(0.18, 0.0, 0.08),
    wheel_radius=0.075,
    wheel_separation=0.33,
    wheel_mass=0.4,
    wheel_edge=0.025,
    # 14 kg with 3 m/s²: 2 x 1.6 N·m / 0.075 m.
    wheel_torque=1.6,
    wheel_gain=2.0,
    caster_offset=0.0,
    caster_radius=0.0,
    front_caster_gap=0.0,
    imu_height=0.07,
    max_speed=1.5,
    max_turn_rate=math.inf,  # what speed and steering make of it
    usual_speed=1.0,
    lidar=LidarModel(720, 0.0, math.tau / 720, 0.10, 10.0, 0.005, 0.285),
    steering=Steering(wheel_base=0.40, most=0.6, rate=4.0, gain=30.0),
)

OMNI = RobotModel(
    name="omni",
    title="On three omni wheels: round, 0.20 m in radius, 1 m/s any way, a lidar all around to "
    "10 m",
    radius=0.20,
    box=None,
    body_height=0.25,
    body_mass=9.0,
    mass_center=(0.0, 0.0, 0.06),
    wheel_radius=0.05,
    wheel_separation=0.30,
    wheel_mass=0.0,
    wheel_edge=0.02,
    # Two of three wheels drive it ahead: 9 kg with 3 m/s² and some more.
    wheel_torque=1.0,
    wheel_gain=1.5,
    caster_offset=0.15,
    caster_radius=0.02,
    front_caster_gap=0.0,
    imu_height=0.07,
    max_speed=1.0,
    max_turn_rate=3.0,
    usual_speed=1.0,
    lidar=LidarModel(720, 0.0, math.tau / 720, 0.10, 10.0, 0.005, 0.265),
    omni=OmniWheels(0.16, (math.pi / 3, -math.pi / 3, math.pi), max_side_speed=1.0),
)

_ROBOTS = {model.name: model for model in (TURTLEBOT3, JACKAL, TURTLEBOT3_PLUS, ACKERMANN, OMNI)}


def robot_names() -> tuple[str, ...]:
    """The names that :func:`robot_model` knows, the default first."""
    return tuple(_ROBOTS)


def robot_like(model_type: str, heard: Iterable[str]) -> RobotModel:
    """The embedded robot for a recipe, where nobody has chosen one.

    Parameters
    ----------
    model_type
        How the recipe's robot moves; empty where nobody described it.
    heard
        Topics that the recipe listens to: it has the sensors, if any robot that moves so has them.
    """
    alike = [one for one in _ROBOTS.values() if one.model_type == model_type] or [TURTLEBOT3]
    wanted = SENSORS & set(heard)
    return next((one for one in alike if wanted <= one.sensors), alike[0])


def robot_model(name: str) -> RobotModel:
    """The embedded robot called ``name``.

    Raises
    ------
    ValueError
        There is none; the message lists those there are.
    """
    found = _ROBOTS.get(name)
    if found is None:
        known = ", ".join(robot_names())
        raise ValueError(f"robot is {name!r}, which does not exist; choose one of: {known}")
    return found
