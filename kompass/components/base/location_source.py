"""Where the robot is and where its sensors are mounted, for the components that move it."""

import math
from typing import Protocol

import numpy as np
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from kompass.algorithms.geometry import Pose2D, compose, inverse
from kompass.algorithms.transforms import Matrix, TransformError, TransformTree, matrix_of
from kompass.bus.clock import Clock
from kompass.bus.node import LifecycleNode
from kompass.components.base.convert import is_rotation, orientation_of, pose_of, speed_of
from kompass.components.base.ports import Input
from kompass.rclpy_ext.topic import LATCHED, QoSConfig
from kompass.robot import RobotFrames

LONGEST_STEP = 0.5  # s over which a speed tells where the robot was, or will be
STATIC_COMES = 2.0  # s in which static transforms are there; what is missing then may be moving
LONGEST_UNMOVED = 0.5  # s by which a moving frame may be older than what is placed by it


class TransformListener:
    """Listens to static transforms always; to moving ones only once somebody asks for them.

    /tf carries hundreds of messages a second on a real robot, and most components only need to
    know where their sensor is mounted.
    """

    def __init__(self, node: LifecycleNode) -> None:
        self.tree = TransformTree()
        self._node = node
        # Several nodes may publish latched static transforms: keep all of theirs.
        static = LATCHED.model_copy(update={"queue_size": 100})
        self._subscriptions = [
            node.create_subscription(TFMessage, "/tf_static", self._static, static.to_ros())
        ]
        self._moving_wanted = False

    def want_moving(self) -> None:
        """Listen to /tf from now on."""
        if not self._moving_wanted:
            self._moving_wanted = True
            qos = QoSConfig(queue_size=100).to_ros()
            self._subscriptions.append(
                self._node.create_subscription(TFMessage, "/tf", self._moving, qos)
            )

    def close(self) -> None:
        """Stop listening."""
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)
        self._subscriptions = []

    def _static(self, message: TFMessage) -> None:
        for transform in message.transforms:
            self._add(transform, static=True)

    def _moving(self, message: TFMessage) -> None:
        for transform in message.transforms:
            self._add(transform, static=False)

    def _add(self, transform: TransformStamped, *, static: bool) -> None:
        t, q = transform.transform.translation, transform.transform.rotation
        stamp = transform.header.stamp
        self.tree.add(
            transform.header.frame_id,
            transform.child_frame_id,
            stamp.sec + stamp.nanosec * 1e-9,
            matrix_of((t.x, t.y, t.z), (q.x, q.y, q.z, q.w)),
            static=static,
        )


class Located(Protocol):
    """What a location source needs of the component that holds it."""

    @property
    def node(self) -> LifecycleNode: ...
    @property
    def clock(self) -> Clock: ...
    @property
    def frames(self) -> RobotFrames: ...
    def input(self, key: str, index: int = 0) -> Input: ...
    def warn(self, text: str, every: float = 5.0) -> None: ...


class LocationSource:
    """The robot's pose and speed by the input ``location`` of a component, while it is active.

    The frame is the one that the message names, whatever the configuration says: a localiser that
    publishes in the world's frame needs no transform.
    """

    def __init__(self, component: Located) -> None:
        self._component = component
        self._transforms = TransformListener(component.node)
        self._sought = math.inf  # since when a sensor's frame leads nowhere

    def close(self) -> None:
        """Stop listening to transforms."""
        self._transforms.close()

    def pose(self) -> Pose2D | None:
        """(x, y, yaw) in the world's frame, or None before it is known [m, m, rad]."""
        message, frames = self._component.input("location").fields, self._component.frames
        if message is None:
            return None
        pose = pose_of(message)
        if not all(math.isfinite(value) for value in pose):
            return None
        if not is_rotation(orientation_of(message)):
            return None
        frame = getattr(getattr(message, "header", None), "frame_id", "") or frames.odom
        if frame == frames.world:
            return pose
        self._transforms.want_moving()
        try:
            to_world = self._transforms.tree.planar(frames.world, frame)
        except TransformError as error:
            self._component.warn(f"location is in '{frame}': {error}")
            return None
        x, y, yaw = compose(to_world, pose)
        return float(x), float(y), float(yaw)

    def fault(self) -> str:
        """Why the newest location tells neither place nor speed, in a clause; empty when it does.

        Without a location there is no fault.
        """
        message = self._component.input("location").fields
        if message is None:
            return ""
        x, y, yaw = pose_of(message)
        vx, vy, omega = self.speed()
        told = {"x": x, "y": y, "yaw": yaw, "vx": vx, "vy": vy, "omega": omega}
        wrong = next((name for name, value in told.items() if not math.isfinite(value)), None)
        if wrong is None:
            q = orientation_of(message)
            if is_rotation(q):
                return ""
            return (
                f"its orientation ({q.x:g}, {q.y:g}, {q.z:g}, {q.w:g}) is none, which has the "
                "length 1; look at who publishes it"
            )
        return f"{wrong} = {told[wrong]} is no finite number; look at who publishes it"

    def pose_at(self, stamp: float) -> Pose2D | None:
        """As :meth:`pose`, moved on or back by the robot's speed to when something was measured.

        Parameters
        ----------
        stamp
            Of what was measured [s]; one that is 0, or more than ``LONGEST_STEP`` away from that of
            the location, tells nothing.
        """
        pose = self.pose()
        if pose is None:
            return None
        x, y, yaw = compose(pose, inverse(self.moved_since(stamp)))
        return float(x), float(y), float(yaw)

    def moved_since(self, stamp: float) -> Pose2D:
        """Where the robot is now, by its speed, in its frame of when something was measured.

        *Now* is the stamp of the location. A location that jumps moves nothing here.

        Parameters
        ----------
        stamp
            As of :meth:`pose_at`; of one that tells nothing the robot has not moved since.
        """
        header = getattr(self._component.input("location").fields, "header", None)
        if header is None or stamp == 0.0:
            return 0.0, 0.0, 0.0
        step = header.stamp.sec + 1e-9 * header.stamp.nanosec - stamp
        vx, vy, omega = self.speed()
        if abs(step) > LONGEST_STEP or not all(map(math.isfinite, (vx, vy, omega))):
            return 0.0, 0.0, 0.0
        # Half of the turn before the way, and half of it after: a good chord of the arc.
        half = 0.5 * omega * step
        cos, sin = math.cos(half), math.sin(half)
        return step * (cos * vx - sin * vy), step * (sin * vx + cos * vy), 2.0 * half

    def speed(self) -> tuple[float, float, float]:
        """(vx, vy, omega) of the robot; zero when the location does not tell [m/s, rad/s]."""
        message = self._component.input("location").fields
        return speed_of(message) if hasattr(message, "twist") else (0.0, 0.0, 0.0)

    def mounting(self, frame: str, stamp: float) -> Matrix:
        """Matrix (4, 4) that takes points of a sensor's frame to the robot's.

        A frame that static transforms do not lead to for a while may be one that moves, as that of
        a camera on a neck; from then on moving ones are listened to, too.

        Parameters
        ----------
        stamp
            When it was measured what is to be placed [s].

        Raises
        ------
        TransformError
            When nothing has told yet, or not for so long that the sensor may be elsewhere.
        """
        base = self._component.frames.robot_base
        if not frame or frame == base:
            return np.eye(4)
        try:
            mounted = self._transforms.tree.lookup(base, frame)
        except TransformError:
            now = self._component.clock.monotonic()
            self._sought = min(self._sought, now)
            if now - self._sought > STATIC_COMES:
                self._transforms.want_moving()
            raise
        self._sought = math.inf
        if stamp - self._transforms.tree.moved_at(base, frame) > LONGEST_UNMOVED:
            # Not by how much: a sentence that changes ten times a second cannot be read.
            raise TransformError(
                f"the transform from '{frame}' to '{base}', which moves, is more than "
                f"{LONGEST_UNMOVED:g} s older than what was measured there"
            )
        return mounted
