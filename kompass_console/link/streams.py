"""What the robot measures and plans, read from the graph into the world."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

from geometry_msgs.msg import PolygonStamped
from kompass_interfaces.msg import GoalHindrance
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float32, String
from tf2_msgs.msg import TFMessage

from kompass_console.link.graph import convert
from kompass_console.link.graph.discovery import Graph, of_type, stream_topic
from kompass_console.link.graph.reader import Reader
from kompass_console.schema.models import StreamInfo, StreamKey
from kompass_console.schema.world import Latest, Pose, RobotMotion, Stamped, WorldModel
from kompass_console.settings import TopicOverrides

_RATE_OVER = 2.0  # s over which messages are counted
_BASE_FRAMES = ("base_link", "base_footprint")


@dataclass(frozen=True, slots=True)
class _Kind:
    """How the page calls a stream, and how old (s) it may be; None: it is sent once and kept."""

    label: str
    deadline: float | None


_KINDS: dict[StreamKey, _Kind] = {
    "odometry": _Kind("Position", 0.5),
    "scan": _Kind("Laser scan", 1.0),
    "map": _Kind("Map", None),
    "local_map": _Kind("Local map", 1.0),
    "path": _Kind("Path", None),
}


class Streams:
    """Readers for everything in the world but the goal."""

    def __init__(self, node: Node, world: WorldModel, overrides: TopicOverrides) -> None:
        self._world = world
        self._overrides: dict[StreamKey, str | None] = {
            "odometry": overrides.odometry,
            "scan": overrides.scan,
            "map": overrides.map,
            "local_map": overrides.local_map,
            "path": overrides.plan,
        }
        self._slots: dict[StreamKey, Latest[Any]] = {
            "odometry": world.motion,
            "scan": world.scan,
            "map": world.map,
            "local_map": world.local_map,
            "path": world.path,
        }
        self._readers: dict[StreamKey, Reader[Any]] = {
            "odometry": Reader(node, Odometry, convert.motion, self._moved, paths=convert.MOTION),
            "scan": Reader(node, LaserScan, convert.scan, world.scan.set),
            "map": Reader(node, OccupancyGrid, convert.grid, world.map.set, latched=True),
            "local_map": Reader(node, OccupancyGrid, convert.grid, world.local_map.set),
            "path": Reader(node, Path, convert.path, world.path.set, latched=True),
        }
        self._footprint = Reader(
            node, PolygonStamped, convert.polygon, world.footprint.set, latched=True
        )
        self._hindrance = Reader(
            node, GoalHindrance, convert.hindrance, world.hindrance.set, latched=True
        )
        self._description = Reader(
            node, String, lambda m: str(m.data), world.description.set, latched=True
        )
        self._mounts = Reader(node, TFMessage, _mounts_of, self._mounted, latched=True, depth=10)
        self._looked, self._counts = time.monotonic(), dict.fromkeys(_KINDS, 0)
        self._hertz: dict[StreamKey, float] = {}
        self._rate: Latest[float] = Latest()
        self._rates = Reader(node, Float32, lambda m: float(m.data), self._rate.set)

    @property
    def simulation_rate(self) -> Stamped[float] | None:
        """Simulated seconds per real second, as a simulator says."""
        return self._rate.get()

    @property
    def topics(self) -> set[str]:
        """All that are read, and drawn as what they are."""
        readers = (*self._readers.values(), self._footprint)
        return {reader.topic for reader in readers if reader.topic is not None}

    def refresh(self, published: Graph) -> None:
        """Read from the topics that are there now, and see how fast messages come."""
        self._measure()
        for key, reader in self._readers.items():
            topic = stream_topic(key, published, self._overrides[key])
            if reader.follow(topic):
                self._slots[key].clear()
        footprints = of_type(published, "geometry_msgs/msg/PolygonStamped")
        self._footprint.follow(next((n for n in footprints if n.endswith("footprint")), None))
        told = of_type(published, "kompass_interfaces/msg/GoalHindrance")
        if self._hindrance.follow(next(iter(told), None)):
            self._world.hindrance.clear()
        described = of_type(published, "std_msgs/msg/String")
        self._description.follow(
            next((n for n in described if n.endswith("robot_description")), None)
        )
        if "tf2_msgs/msg/TFMessage" in published.get("/tf_static", ()):
            self._mounts.follow("/tf_static")
        if "std_msgs/msg/Float32" in published.get("/simulator/rate", ()):
            self._rates.follow("/simulator/rate")

    def infos(self) -> list[StreamInfo]:
        """Every stream's topic and age."""
        infos = []
        for key, kind in _KINDS.items():
            stamped = self._slots[key].get()
            age = None if stamped is None else stamped.age()
            late = age is not None and kind.deadline is not None and age > kind.deadline
            # No path is a robot that has nothing to do; everything else has to be there.
            stale = late or (age is None and key != "path")
            infos.append(
                StreamInfo(
                    key=key,
                    label=kind.label,
                    topic=self._readers[key].topic,
                    age=age,
                    deadline=kind.deadline,
                    stale=stale,
                    rate=None if kind.deadline is None else self._hertz.get(key),
                )
            )
        return infos

    def _measure(self) -> None:
        now = time.monotonic()
        passed = now - self._looked
        if passed < _RATE_OVER:
            return
        counts = {key: reader.count for key, reader in self._readers.items()}
        self._hertz = {key: (counts[key] - self._counts[key]) / passed for key in counts}
        self._looked, self._counts = now, counts

    def _moved(self, motion: RobotMotion) -> None:
        self._world.history.add(motion.stamp, motion.pose)
        self._world.motion.set(motion)

    def _mounted(self, mounts: dict[str, Pose]) -> None:
        self._world.scan_mount = {**self._world.scan_mount, **mounts}


def _mounts_of(message: Any) -> dict[str, Pose]:
    """Sensor frame -> its pose on the robot, of those fixed to the robot's base."""
    mounts = {}
    for transform in message.transforms:
        if transform.header.frame_id.lstrip("/") in _BASE_FRAMES:
            translation, rotation = transform.transform.translation, transform.transform.rotation
            frame = transform.child_frame_id.lstrip("/")
            mounts[frame] = Pose(translation.x, translation.y, convert.yaw_of(rotation))
    return mounts
