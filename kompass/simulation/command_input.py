"""Listens to velocity commands, whichever of the two types they come in."""

from __future__ import annotations

from collections.abc import Callable

from geometry_msgs.msg import Twist, TwistStamped
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

from kompass.bus.node import Node

TOPIC = "/cmd_vel"
_TYPES = {"geometry_msgs/msg/TwistStamped": TwistStamped, "geometry_msgs/msg/Twist": Twist}

# With publishers of both types about, one that is silent this long gives way to the other. A
# publisher whose process was killed stays on the graph for a while; it must not hold the robot.
SILENCE = 1.0  # s


class CommandInput:
    """Subscribes to ``/cmd_vel`` with the type of its publishers.

    ROS 2 distributions disagree on the type, and one DDS participant cannot read a topic as two
    types. So the graph decides, and is asked again by every :meth:`follow_publishers`. With no
    publisher in sight the type stays what it was, TwistStamped at first, so that the robot shows up
    as a reader of commands.

    Parameters
    ----------
    node
        Owns the subscription.
    drive
        Called with v [m/s], omega [rad/s] and vy [m/s]; its ValueError becomes a warning.
    """

    def __init__(self, node: Node, drive: Callable[[float, float, float], None]) -> None:
        self._node = node
        self._drive = drive
        self._type: type[Twist] | type[TwistStamped] = TwistStamped
        self._subscription: Subscription | None = self._subscribe()
        self._heard = False
        self._quiet_since = 0.0
        self._mixed = False

    def follow_publishers(self, now: float) -> None:
        """Change over to the publishers' type when they have another one.

        Parameters
        ----------
        now
            Monotonic seconds.
        """
        if self._subscription is None:
            self._subscription = self._subscribe()
            self._quiet_since = now
            return
        if self._heard:
            self._heard = False
            self._quiet_since = now
        names = {info.topic_type for info in self._node.get_publishers_info_by_topic(TOPIC)}
        offered = [kind for name, kind in _TYPES.items() if name in names]
        mixed = len(offered) == len(_TYPES)
        if mixed and not self._mixed:
            self._node.get_logger().warning(
                f"{TOPIC} is published as Twist and as TwistStamped at once; only one of them is "
                "obeyed at a time. Make all publishers use one type."
            )
        self._mixed = mixed
        given_up = mixed and now - self._quiet_since > SILENCE
        others = [kind for kind in offered if kind is not self._type]
        if others and (given_up or self._type not in offered):
            self._type = others[0]
            self._node.get_logger().info(f"{TOPIC} is read as {self._type.__name__} from now on")
            # The executor lets go of the old reader only after this call, and until then the
            # participant refuses the new type: the next call subscribes.
            self._node.destroy_subscription(self._subscription)
            self._subscription = None

    def _subscribe(self) -> Subscription:
        return self._node.create_subscription(
            self._type, TOPIC, self._on_command, QoSProfile(depth=10)
        )

    def _on_command(self, message: Twist | TwistStamped) -> None:
        self._heard = True
        twist = message.twist if isinstance(message, TwistStamped) else message
        try:
            self._drive(twist.linear.x, twist.angular.z, twist.linear.y)
        except ValueError as error:
            self._node.get_logger().warning(f"{TOPIC} ignored: {error}", throttle_duration_sec=5.0)
