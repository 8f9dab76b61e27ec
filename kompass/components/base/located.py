"""What the moving components share: where the robot is, in the world's frame."""

import math

from kompass.algorithms.geometry import compose
from kompass.algorithms.transforms import TransformError
from kompass.components.base.component import Component
from kompass.components.base.convert import Pose2D, pose_of, speed_of
from kompass.components.base.transform_listener import Transforms


class Located(Component):
    """A component with a ``location`` input.

    The frame is the one that the message names, whatever the configuration says: a localiser that
    publishes in the world's frame needs no transform.
    """

    transforms: Transforms

    def custom_on_activate(self) -> None:
        self.transforms = Transforms(self.node)

    def custom_on_deactivate(self) -> None:
        self.transforms.close()

    def pose(self) -> Pose2D | None:
        """(x, y, yaw) in the world's frame, or None before it is known [m, m, rad]."""
        message = self.input("location").message
        if message is None:
            return None
        pose = pose_of(message)
        if not all(math.isfinite(value) for value in pose):
            return None
        frame = getattr(getattr(message, "header", None), "frame_id", "") or self.frames.odom
        if frame == self.frames.world:
            return pose
        self.transforms.want_moving()
        try:
            to_world = self.transforms.buffer.planar(self.frames.world, frame)
        except TransformError as error:
            self.warn(f"location is in '{frame}': {error}")
            return None
        x, y, yaw = compose(to_world, pose)
        return float(x), float(y), float(yaw)

    def speed(self) -> tuple[float, float, float]:
        """(vx, vy, omega) of the robot; zero when the location does not tell [m/s, rad/s]."""
        message = self.input("location").message
        return speed_of(message) if hasattr(message, "twist") else (0.0, 0.0, 0.0)

    def sensor_pose(self, frame: str) -> Pose2D:
        """Where a sensor is mounted, in the robot's frame.

        Raises
        ------
        TransformError
            When nothing has told yet.
        """
        if not frame or frame == self.frames.robot_base:
            return 0.0, 0.0, 0.0
        x, y, yaw = self.transforms.buffer.planar(self.frames.robot_base, frame)
        return x, y, yaw
