"""The embedded robot: MuJoCo physics, its drive and its sensors, on simulated time only."""

from __future__ import annotations

import math
import zlib
from collections.abc import Collection, Iterable

import mujoco
import numpy as np
from numpy.typing import NDArray

from kompass.simulation.battery import Battery
from kompass.simulation.physics.barriers import Barrier
from kompass.simulation.physics.drive import drive_of
from kompass.simulation.physics.mjcf import (
    DRIVEN_WHEELS,
    GLASS_GROUP,
    SOLID_GROUP,
    STORE,
    TIMESTEP,
    door_body,
    model_text,
    solid_geom,
)
from kompass.simulation.physics.motion import BodyMotion
from kompass.simulation.physics.parts import (
    Odometer,
    PoseSource,
    PowerSource,
    RangeFinder,
    WheelDrive,
)
from kompass.simulation.physics.person import Person
from kompass.simulation.physics.robot_model import TURTLEBOT3, RobotModel
from kompass.simulation.sensors.bumper import Bumper
from kompass.simulation.sensors.depth_camera import DepthCamera
from kompass.simulation.sensors.imu import Imu, ImuReading
from kompass.simulation.sensors.lidar import Lidar
from kompass.simulation.sensors.localizer import Localizer
from kompass.simulation.sensors.picture_camera import PictureCamera
from kompass.simulation.sensors.wheel_odometry import OmniOdometry, WheelOdometry
from kompass.simulation.worlds.shapes import Box
from kompass.simulation.worlds.world import World

# Encoders and localizer are sampled at this period of simulated time, however ``step`` is called.
SAMPLE_STEPS = 10
SAMPLE_PERIOD = SAMPLE_STEPS * TIMESTEP
_CHANCE_STREAM = 4  # after those of the four sensors
_SETTLING_STEPS = 250  # the wheels sink a few micrometres into the floor first


class SimulatedRobot:
    """One of the embedded robots in a world.

    It starts at rest at the start pose of its world. Every source of noise has its own stream
    drawn from ``seed``, so the same seed and the same calls give the same run, and replacing one
    sensor leaves the others as they were.

    Parameters
    ----------
    world
        Where the robot is.
    seed
        Of all noise and of the base's calibration errors.
    kind
        Which of the embedded robots it is.

    Attributes
    ----------
    world
        Where the robot is.
    kind
        Which robot it is.
    battery, drive, lidar, imu_sensor, wheels, localizer, bumper
        Its parts, which may be exchanged for objects that behave otherwise.
    rear, camera, picture_camera
        A scanner that looks back, a depth camera and one for colours, where the robot has them.
    slip
        How much further the (left, right) wheel has turned than its rolling says, per turn. The
        encoders count it; the drive has to leave it out.
    """

    def __init__(self, world: World, seed: int = 0, kind: RobotModel = TURTLEBOT3) -> None:
        self.world, self.kind = world, kind
        self._seed = seed
        self._model = mujoco.MjModel.from_xml_string(model_text(world, kind))
        self._data = mujoco.MjData(self._model)
        lidar, imu, wheels, localizer = (
            np.random.default_rng(stream) for stream in np.random.SeedSequence(seed).spawn(4)
        )
        self.battery: PowerSource = Battery(world.start[:2])
        self.drive: WheelDrive = drive_of(kind)
        self._lidar = Lidar(self._model, self._data, lidar, kind.lidar)
        self.lidar: RangeFinder = self._lidar
        self.rear: RangeFinder | None = None
        if kind.rear is not None:
            stream = self.chance("rear")
            self.rear = Lidar(self._model, self._data, stream, kind.rear.lidar, "rear")
        self.camera: DepthCamera | None = None
        if kind.camera is not None:
            stream = self.chance("camera")
            self.camera = DepthCamera(self._model, self._data, stream, kind.camera)
        self.picture_camera: PictureCamera | None = None
        if kind.camera is not None and kind.camera.picture is not None:
            self.picture_camera = PictureCamera(self._model, self._data, kind.camera.picture)
        self.imu_sensor = Imu(self._model, self._data, imu)
        self.wheels: Odometer
        if kind.omni is None:
            self.wheels = WheelOdometry(wheels, kind)
        else:
            self.wheels = OmniOdometry(wheels, kind, kind.omni)
        self.localizer: PoseSource = Localizer(localizer, SAMPLE_PERIOD)
        self.bumper = Bumper()
        self.slip = (0.0, 0.0)
        self._slipped = (0.0, 0.0)  # rad, of both wheels since the start
        self._rolled = (0.0, 0.0)  # rad, as of the last sample
        self._turned = [0.0, 0.0, 0.0]  # rad, of omni wheels since the start
        self._people: dict[str, Person] = {}
        self._person_bumper = Bumper()

        self._touch = self._data.sensor("shell").data
        if kind.omni is None:
            self._left, self._right = (
                int(self._model.joint(name).qposadr[0]) for name in DRIVEN_WHEELS
            )
        self._steps = 0
        self._left_over = 0.0
        self.place(world.start)

    @property
    def time(self) -> float:
        """Simulated seconds since the start."""
        return self._steps * TIMESTEP

    @property
    def contacts(self) -> int:
        """How often the shell has touched a wall or an obstacle since the start."""
        return self.bumper.episodes

    @property
    def person_contacts(self) -> int:
        """How often the shell has touched a person; ``contacts`` counts these, too."""
        return self._person_bumper.episodes

    def chance(self, purpose: str) -> np.random.Generator:
        """A stream of chance of its own for a purpose: the same for the same seed and purpose."""
        key = (_CHANCE_STREAM, zlib.crc32(purpose.encode()))
        return np.random.default_rng(np.random.SeedSequence(self._seed, spawn_key=key))

    def place(self, pose: tuple[float, float, float]) -> None:
        """Set the robot down at rest at ``pose`` (x, y, yaw) in ``map``.

        The wheels do not notice: wheel odometry goes on from where it was.
        """
        x, y, yaw = pose
        data = self._data
        data.qpos[:7] = [x, y, 0.0, math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]
        data.qvel[:] = 0.0
        data.ctrl[:] = 0.0
        mujoco.mj_step(self._model, data, _SETTLING_STEPS)
        data.qvel[:] = 0.0
        mujoco.mj_forward(self._model, data)
        self._sample()

    def relocate(self, pose: tuple[float, float, float]) -> None:
        """Have the localizer believe that the robot is at ``pose`` (x, y, yaw) in ``map`` now.

        Raises
        ------
        NoReading
            A faulty localizer says nothing that could be corrected.
        """
        self.localizer.relocate(pose)

    def put_up(self, barriers: Iterable[Barrier], *, ahead: float = 0.0) -> None:
        """Have walls stand beside the robot, where it is now, or where it is so far ahead [m]."""
        x, y, yaw = self.truth().pose
        pose = (x + ahead * math.cos(yaw), y + ahead * math.sin(yaw), yaw)
        for barrier in barriers:
            self._put(barrier.name, barrier.place(pose))

    def take_down(self, barriers: Iterable[Barrier]) -> None:
        """Take walls away."""
        for barrier in barriers:
            self._store(barrier.name)

    def close_door(self, door: Box) -> None:
        """Close one of the world's doorways, at once."""
        self._put(door_body(door.name), (*door.center, door.yaw))

    def open_door(self, door: Box) -> None:
        """Open it again."""
        self._store(door_body(door.name))

    def let_in(self, person: Person) -> None:
        """Have a person walk, from the next step on."""
        self._people[person.name] = person
        self._put(person.name, (*person.position, 0.0))

    def send_away(self, person: Person) -> None:
        """Have a person be gone."""
        del self._people[person.name]
        self._store(person.name)

    def set_surfaces(self, glass: Collection[str], mirrors: Collection[str]) -> None:
        """Make walls and obstacles of glass or of mirrors, and all others as they are.

        Parameters
        ----------
        glass
            Names of the world's solids that the lidar sees through; they count before mirrors.
        mirrors
            Names of those that throw its rays back.
        """
        geoms = {
            shape.name: self._model.geom(solid_geom(shape.name)) for shape in self.world.solids
        }
        for name, geom in geoms.items():
            geom.group[0] = GLASS_GROUP if name in glass else SOLID_GROUP
        self._lidar.mirrors = tuple(int(geoms[name].id) for name in mirrors)

    def _put(self, name: str, pose: tuple[float, float, float], height: float = 0.0) -> None:
        x, y, yaw = pose
        index = int(self._model.body(name).mocapid[0])
        self._data.mocap_pos[index] = (x, y, height)
        self._data.mocap_quat[index] = [math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]
        # The lidar sees it from its next scan on, whether or not time passes in between.
        mujoco.mj_kinematics(self._model, self._data)

    def _store(self, name: str) -> None:
        self._put(name, (0.0, 0.0, 0.0), STORE)

    def command(self, v: float, omega: float, vy: float = 0.0) -> None:
        """Drive with ``v``, ``vy`` (m/s) and ``omega`` (rad/s), as far as it can.

        Raises
        ------
        ValueError
            One of them is not finite; the robot keeps its last command until it runs out.
        """
        self.drive.command(v, omega, self.time, vy)

    def step(self, dt: float) -> None:
        """Let ``dt`` seconds of simulated time pass.

        What is left of ``dt`` after whole physics steps is kept for the next call.

        Raises
        ------
        ValueError
            ``dt`` is negative or not finite.
        """
        if not (math.isfinite(dt) and dt >= 0.0):
            raise ValueError(f"dt is {dt!r}; give a finite time of 0 s or more")
        self._left_over += dt
        count = int(self._left_over / TIMESTEP + 1e-6)
        self._left_over -= count * TIMESTEP
        model, data, touch, ctrl = self._model, self._data, self._touch, self._data.ctrl
        omni = self.kind.omni is not None
        for _ in range(count):
            ctrl[:] = self.drive.wheel_speeds(self._steps * TIMESTEP)
            mujoco.mj_step(model, data)
            self._steps += 1
            if omni:
                for wheel, speed in enumerate(data.actuator_velocity.tolist()):
                    self._turned[wheel] += speed * TIMESTEP
            if touch[0] > 0.0:
                self.bumper.update(True, self.time)
                if self._people:
                    self._person_bumper.update(self._touches_person(), self.time)
            if self._steps % SAMPLE_STEPS == 0:
                self._sample()
                if self._people:
                    self._walk()

    def scan(self) -> NDArray[np.float32]:
        """Lidar ranges (rays,) in metres, anticlockwise; +inf = no return.

        Raises
        ------
        NoReading
            A faulty lidar says nothing this time; so may ``wheel_odometry`` and
            ``filtered``.
        """
        return self.lidar.scan()

    @property
    def scan_age(self) -> float:
        """Seconds since the scan was measured that ``scan`` has returned last."""
        return self.lidar.age

    def imu(self) -> ImuReading:
        """The newest inertial reading."""
        return self.imu_sensor.read()

    def wheel_odometry(self) -> BodyMotion:
        """What the encoders say: pose in ``odom``, drifting, with its covariance."""
        return self.wheels.read()

    def filtered(self) -> BodyMotion:
        """What a localizer says: pose in ``map``.

        Within millimetres of the truth, unless it is faulty or was told otherwise.
        """
        return self.localizer.read()

    def truth(self) -> BodyMotion:
        """Where the robot is in ``map`` and how it moves, exactly."""
        x, y, _, w, i, j, k = self._data.qpos[:7].tolist()
        yaw = math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k))
        # A free joint's rotation is in the body's frame.
        east, north, _, _, _, omega = self._data.qvel[:6].tolist()
        cos, sin = math.cos(yaw), math.sin(yaw)
        return BodyMotion((x, y, yaw), (cos * east + sin * north, cos * north - sin * east, omega))

    def _sample(self) -> None:
        qpos, behind = self._data.qpos, 0.0
        if self.kind.omni is None:
            left, right = float(qpos[self._left]), float(qpos[self._right])
        else:
            left, right, behind = self._turned
        if self.slip != (0.0, 0.0):
            self._slipped = (
                self._slipped[0] + self.slip[0] * (left - self._rolled[0]),
                self._slipped[1] + self.slip[1] * (right - self._rolled[1]),
            )
        self._rolled = left, right
        left, right = left + self._slipped[0], right + self._slipped[1]
        self.wheels.update(left, right, SAMPLE_PERIOD, behind)
        self.localizer.update(self.truth())

    def _walk(self) -> None:
        x, y, _ = self.truth().pose
        for person in self._people.values():
            person.advance((x, y), SAMPLE_PERIOD, self.kind.radius)
            self._put(person.name, (*person.position, 0.0))

    def _touches_person(self) -> bool:
        shell = self._model.geom("shell").id
        people = [self._model.geom(name).id for name in self._people]
        pairs = self._data.contact.geom
        return bool((np.isin(pairs, people).any(axis=1) & (pairs == shell).any(axis=1)).any())
