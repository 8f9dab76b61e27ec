"""A topic as recipes name it: name, message type, quality of service."""

import importlib
import importlib.util
from typing import Any

from pydantic import Field
from rclpy.exceptions import NameValidationException
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_topic_name import validate_topic_name

from kompass.expressions import Expression, MessageField, condition_of
from kompass.named_arguments import named_arguments
from kompass.settings import Settings

# Searched in this order for a bare type name; "package/Type" names the package itself.
MESSAGE_PACKAGES = (
    "std_msgs",
    "geometry_msgs",
    "nav_msgs",
    "sensor_msgs",
    "automatika_ros_sugar",
    "kompass_interfaces",
    "tf2_msgs",
    "vision_msgs",
)


def message_class(msg_type: str | type) -> type[Any]:
    """The ROS message class of a type name: "LaserScan" or "sensor_msgs/msg/LaserScan".

    Raises
    ------
    TypeError
        When it is neither a class nor a name.
    ValueError
        When there is no such message.
    """
    if isinstance(msg_type, type):
        if not hasattr(msg_type, "get_fields_and_field_types"):
            raise ValueError(f"msg_type = {msg_type!r} is not a ROS message class")
        return msg_type
    if not isinstance(msg_type, str):
        raise TypeError(
            f"msg_type = {msg_type!r} is no type; give its class or its name, as 'LaserScan'"
        )
    parts = msg_type.split("/")
    packages = (parts[0],) if len(parts) > 1 else MESSAGE_PACKAGES
    for package in packages:
        if importlib.util.find_spec(package) is None:
            continue
        found = getattr(importlib.import_module(f"{package}.msg"), parts[-1], None)
        if found is not None:
            return found  # type: ignore[no-any-return]
    raise ValueError(
        f"msg_type = {msg_type!r}: no such message in {', '.join(packages)}; "
        "name another package as 'package/Type', and install it"
    )


class QoSConfig(Settings):
    """Quality of service as recipes write it."""

    history: HistoryPolicy = HistoryPolicy.KEEP_LAST
    queue_size: int = Field(default=10, ge=0, le=1000)
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE

    def to_ros(self) -> QoSProfile:
        """The profile for rclpy."""
        return QoSProfile(
            history=self.history,
            depth=self.queue_size,
            reliability=self.reliability,
            durability=self.durability,
        )


LATCHED = QoSConfig(queue_size=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
# Matches publishers of either reliability, so a sensor's driver may be what it likes.
SENSOR = QoSConfig(queue_size=5, reliability=ReliabilityPolicy.BEST_EFFORT)


DATA_TIMEOUT = 1.0  # s
LONGEST_NAME = 240  # letters; DDS adds a few of its own to the 255 that it allows


def _checked_name(name: str) -> str:
    """A topic's name without the leading slash; raises as :class:`Topic`."""
    if not isinstance(name, str):
        raise TypeError(f"Topic name = {name!r}; give text, as in '/scan'")
    bare = name.strip().removeprefix("/")
    if not bare:
        raise ValueError(f"Topic name = {name!r} is empty")
    if len(bare) > LONGEST_NAME:
        raise ValueError(
            f"Topic name = '{bare[:20]}…' has {len(bare)} letters; give {LONGEST_NAME} at most"
        )
    try:
        if bare.startswith("~"):
            validate_topic_name(bare)
        else:
            validate_full_topic_name(f"/{bare}")
    except NameValidationException as error:
        why = str(error).splitlines()[0].partition(": ")[2].removesuffix(":")
        raise ValueError(
            f"Topic name = {name!r}: {why}; give letters, digits, '_' and '/', as in '/scan'"
        ) from None
    return bare


class Topic:
    """A named stream of messages.

    Names are equal with and without the leading slash; without a ``qos_profile`` the component
    that uses the topic chooses what fits the message. ``data_timeout`` is how long a message counts
    in events [s]: 1 s unless stated, and without end on a latched topic (``TRANSIENT_LOCAL``).

    Raises
    ------
    TypeError
        When the name is no text, or the type neither a class nor a name.
    ValueError
        When the name is empty or none that ROS knows, the type does not exist, or
        ``data_timeout`` is not positive.
    """

    @named_arguments
    def __init__(
        self,
        *,
        name: str,
        msg_type: str | type,
        qos_profile: QoSConfig | None = None,
        data_timeout: float | None = None,
    ) -> None:
        self.name = _checked_name(name)
        self.ros_msg_type = message_class(msg_type)
        if data_timeout is not None and data_timeout <= 0:
            raise ValueError(f"Topic {name!r}: data_timeout = {data_timeout!r} must be above 0 s")
        self.qos_profile = qos_profile
        durability = DurabilityPolicy.VOLATILE if qos_profile is None else qos_profile.durability
        latched = durability == DurabilityPolicy.TRANSIENT_LOCAL
        usual = None if latched else DATA_TIMEOUT
        self.data_timeout = usual if data_timeout is None else float(data_timeout)

    @property
    def msg_type(self) -> str:
        """Bare name of the message type."""
        return self.ros_msg_type.__name__

    @property
    def msg(self) -> MessageField:
        """The message, to be compared in an event: ``topic.msg.data > 5``."""
        return MessageField(self.name, self.ros_msg_type, self.data_timeout, ())

    def __and__(self, other: Any) -> Expression:
        combined: Expression = Expression(condition_of(self)) & other
        return combined

    def __or__(self, other: Any) -> Expression:
        combined: Expression = Expression(condition_of(self)) | other
        return combined

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Topic):
            return NotImplemented
        return (self.name, self.ros_msg_type) == (other.name, other.ros_msg_type)

    def __hash__(self) -> int:
        return hash((self.name, self.ros_msg_type))

    def __repr__(self) -> str:
        return f"Topic(name='/{self.name}', msg_type='{self.msg_type}')"


class AllowedTopics:
    """How many topics of which message types one key of a component takes."""

    def __init__(
        self, types: list[str], number_required: int = 1, number_optional: int = 0
    ) -> None:
        self.types = types
        self.number_required = number_required
        self.number_optional = number_optional

    def check(self, owner: str, key: str, topics: list[Topic]) -> None:
        """Raise TypeError or ValueError, naming the key, when the topics do not fit."""
        for topic in topics:
            if not isinstance(topic, Topic):
                raise TypeError(f"{owner}: {key} = {topic!r} is not a Topic")
            if topic.msg_type not in self.types:
                raise TypeError(
                    f"{owner}: {key} takes {' or '.join(self.types)}, "
                    f"not the {topic.msg_type} of '/{topic.name}'"
                )
        most = self.number_required + self.number_optional
        if not self.number_required <= len(topics) <= most:
            raise ValueError(
                f"{owner}: {key} takes {self.number_required} to {most} topics, not {len(topics)}"
            )
