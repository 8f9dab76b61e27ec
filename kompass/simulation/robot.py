"""The embedded robot: MuJoCo physics, its drive and its sensors, on simulated time only."""

from __future__ import annotations

import math
from collections.abc import Iterable

import mujoco
import numpy as np
from numpy.typing import NDArray

from kompass.simulation.physics.barriers import Barrier
from kompass.simulation.physics.drive import DifferentialDrive
from kompass.simulation.physics.mjcf import BARRIER_STORE, TIMESTEP, model_text
from kompass.simulation.physics.motion import BodyMotion
from kompass.simulation.physics.parts import Odometer, PoseSource, RangeFinder, WheelDrive
from kompass.simulation.sensors.bumper import Bumper
from kompass.simulation.sensors.imu import Imu, ImuReading
from kompass.simulation.sensors.lidar import Lidar
from kompass.simulation.sensors.localizer import Localizer
from kompass.simulation.sensors.wheel_odometry import WheelOdometry
from kompass.simulation.worlds.world import World

# Encoders and localizer are sampled at this period of simulated time, however ``step`` is called.
SAMPLE_STEPS = 10
SAMPLE_PERIOD = SAMPLE_STEPS * TIMESTEP
_SETTLING_STEPS = 250  # the wheels sink a few micrometres into the floor first


class SimulatedRobot:
    """A differential-drive robot in a world.

    It starts at rest at the start pose of its world. Every source of noise has its own stream
    drawn from ``seed``, so the same seed and the same calls give the same run, and replacing one
    sensor leaves the others as they were.

    Parameters
    ----------
    world
        Where the robot is.
    seed
        Of all noise and of the base's calibration errors.

    Attributes
    ----------
    world
        Where the robot is.
    drive, lidar, imu_sensor, wheels, localizer, bumper
        Its parts, which may be exchanged for objects that behave otherwise.
    """

    def __init__(self, world: World, seed: int = 0) -> None:
        self.world = world
        self._model = mujoco.MjModel.from_xml_string(model_text(world))
        self._data = mujoco.MjData(self._model)
        lidar, imu, wheels, localizer = (
            np.random.default_rng(stream) for stream in np.random.SeedSequence(seed).spawn(4)
        )
        self.drive: WheelDrive = DifferentialDrive()
        self.lidar: RangeFinder = Lidar(self._model, self._data, lidar)
        self.imu_sensor = Imu(self._model, self._data, imu)
        self.wheels: Odometer = WheelOdometry(wheels)
        self.localizer: PoseSource = Localizer(localizer, SAMPLE_PERIOD)
        self.bumper = Bumper()

        self._touch = self._data.sensor("shell").data
        self._left, self._right = (
            int(self._model.joint(name).qposadr[0]) for name in ("left", "right")
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

    def put_up(self, barriers: Iterable[Barrier]) -> None:
        """Have walls stand beside the robot, where it is now."""
        pose = self.truth().pose
        for barrier in barriers:
            x, y, yaw = barrier.place(pose)
            self._put(barrier, (x, y, 0.0), yaw)

    def take_down(self, barriers: Iterable[Barrier]) -> None:
        """Take walls away."""
        for barrier in barriers:
            self._put(barrier, (0.0, 0.0, BARRIER_STORE), 0.0)

    def _put(self, barrier: Barrier, position: tuple[float, float, float], yaw: float) -> None:
        index = int(self._model.body(barrier.name).mocapid[0])
        self._data.mocap_pos[index] = position
        self._data.mocap_quat[index] = [math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]
        # The lidar sees it from its next scan on, whether or not time passes in between.
        mujoco.mj_kinematics(self._model, self._data)

    def command(self, v: float, omega: float) -> None:
        """Drive with ``v`` (m/s) and ``omega`` (rad/s); see :meth:`DifferentialDrive.command`."""
        self.drive.command(v, omega, self.time)

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
        for _ in range(count):
            self._data.ctrl[:] = self.drive.wheel_speeds(self.time)
            mujoco.mj_step(self._model, self._data)
            self._steps += 1
            self.bumper.update(bool(self._touch[0] > 0.0), self.time)
            if self._steps % SAMPLE_STEPS == 0:
                self._sample()

    def scan(self) -> NDArray[np.float32]:
        """Lidar ranges (360,) in metres from straight ahead anticlockwise; +inf = no return.

        Raises
        ------
        NoReading
            A faulty lidar says nothing this time; so may ``wheel_odometry`` and
            ``filtered``.
        """
        return self.lidar.scan()

    def imu(self) -> ImuReading:
        """The newest inertial reading."""
        return self.imu_sensor.read()

    def wheel_odometry(self) -> BodyMotion:
        """What the encoders say: pose in ``odom``, drifting, with its covariance."""
        return self.wheels.read()

    def filtered(self) -> BodyMotion:
        """What a localizer says: pose in ``map``, within millimetres of the truth."""
        return self.localizer.read()

    def truth(self) -> BodyMotion:
        """Where the robot is in ``map`` and how it moves, exactly."""
        x, y, _, w, i, j, k = (float(part) for part in self._data.qpos[:7])
        yaw = math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k))
        east, north = (float(part) for part in self._data.qvel[:2])
        cos, sin = math.cos(yaw), math.sin(yaw)
        omega = float(self._data.qvel[5])  # a free joint's rotation is in the body's frame
        return BodyMotion((x, y, yaw), (cos * east + sin * north, cos * north - sin * east, omega))

    def _sample(self) -> None:
        qpos = self._data.qpos
        self.wheels.update(float(qpos[self._left]), float(qpos[self._right]), SAMPLE_PERIOD)
        self.localizer.update(self.truth())
