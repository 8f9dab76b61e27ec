"""Listen to /tf and /tf_static for a component."""

from geometry_msgs.msg import TransformStamped
from rclpy.lifecycle import LifecycleNode
from tf2_msgs.msg import TFMessage

from kompass.algorithms.transforms import TransformBuffer, matrix_of
from kompass.rclpy_ext.topic import LATCHED, QoSConfig


class Transforms:
    """Static transforms always; moving ones only once somebody asks for a moving frame.

    /tf carries hundreds of messages a second on a real robot, and most components only need to
    know where their sensor is mounted.
    """

    def __init__(self, node: LifecycleNode) -> None:
        self.buffer = TransformBuffer()
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
        self.buffer.add(
            transform.header.frame_id,
            transform.child_frame_id,
            stamp.sec + stamp.nanosec * 1e-9,
            matrix_of((t.x, t.y, t.z), (q.x, q.y, q.z, q.w)),
            static=static,
        )
