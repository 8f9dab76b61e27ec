"""What is worth having in a recording besides what the rules look at."""

from collections.abc import Iterable
from typing import NamedTuple, Protocol

from kompass.rclpy_ext.topic import Topic

# Said by every stack, whatever its components.
COMMON = {
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "monitor/firings": "kompass_interfaces/msg/RuleFiring",
    "monitor/stack_state": "kompass_interfaces/msg/StackState",
    "drive_state": "kompass_interfaces/msg/DriveState",
    "/clicked_point": "geometry_msgs/msg/PointStamped",
    "/goal_pose": "geometry_msgs/msg/PoseStamped",
    "/initialpose": "geometry_msgs/msg/PoseWithCovarianceStamped",
    # Of the embedded robot: a recorded drive can be made a scenario of, with what broke in it.
    "/simulator/faults": "std_msgs/msg/String",
    # Which robot it was; and what shows a recording can draw it.
    "/robot_description": "std_msgs/msg/String",
}
# Large, and alike from one message to the next.
THINNED = {"nav_msgs/msg/OccupancyGrid": 1.0}
# Megabytes per second: a recorder of everything else would keep a minute of nothing but these.
LEFT_OUT = frozenset(
    {
        "sensor_msgs/msg/Image",
        "sensor_msgs/msg/CompressedImage",
        "sensor_msgs/msg/PointCloud2",
    }
)


class SampledTopic(NamedTuple):
    """A topic that the recorder listens to itself.

    Attributes
    ----------
    period
        Seconds between two messages that are kept at least; 0 to keep all.
    """

    name: str
    type: str
    period: float = 0.0


class HasTopics(Protocol):
    """What is asked of a component."""

    @property
    def inputs_keys(self) -> list[str]:
        """Keys of its inputs."""

    @property
    def outputs_keys(self) -> list[str]:
        """Keys of its outputs."""

    @property
    def status_topic(self) -> Topic:
        """Where it says how it is."""

    def get_in_topic(self, key: str) -> Topic | list[Topic] | None:
        """What an input key stands for."""

    def get_out_topic(self, key: str) -> Topic | list[Topic] | None:
        """What an output key stands for."""


def standard_topics(components: Iterable[HasTopics]) -> tuple[SampledTopic, ...]:
    """Inputs, outputs and health of components, and what every stack says."""
    found = {name.removeprefix("/"): SampledTopic(name, kind) for name, kind in COMMON.items()}
    for component in components:
        given = [component.get_in_topic(key) for key in component.inputs_keys]
        given += [component.get_out_topic(key) for key in component.outputs_keys]
        given.append(component.status_topic)
        for entry in given:
            for topic in entry if isinstance(entry, list) else [entry]:
                if topic is not None:
                    kind = _type_name(topic.ros_msg_type)
                    if kind not in LEFT_OUT:
                        tap = SampledTopic(topic.name, kind, THINNED.get(kind, 0.0))
                        found.setdefault(topic.name, tap)
    return tuple(found.values())


def _type_name(kind: type) -> str:
    package = kind.__module__.partition(".")[0]
    return f"{package}/msg/{kind.__name__}"
