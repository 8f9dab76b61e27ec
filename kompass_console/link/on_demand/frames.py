"""Where frames of the robot are in the frame of the scene (TF)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from tf2_msgs.msg import TFMessage

from kompass.algorithms.transforms import Matrix, TransformError, TransformTree, matrix_of
from kompass_console.link.graph.convert import seconds
from kompass_console.link.on_demand.raw_topic import RawTopic
from kompass_console.schema.plain import LONGEST_LABEL, plain
from kompass_console.schema.world import Pose, WorldModel

_BASES = ("base_link", "base_footprint")
_MOST_FRAMES = 500
_LARGEST = 200_000  # bytes of one message
_WAIT = 100  # messages between two looks


class Frames:
    """Hears transforms for as long as it is open.

    Parameters
    ----------
    node
        As of :class:`RawTopic`.
    world
        Knows in which frame odometry is, and where the robot was.
    """

    def __init__(self, node: Node, world: WorldModel) -> None:
        self._world = world
        self._tree = TransformTree()
        self._names: set[str] = set()
        self._moving = RawTopic(node, "/tf", TFMessage, _WAIT)
        self._static = RawTopic(node, "/tf_static", TFMessage, _WAIT)

    def look(self) -> None:
        """Take in what has come."""
        for topic, static in ((self._static, True), (self._moving, False)):
            topic.fit()
            for raw in topic.take():
                if len(raw) <= _LARGEST:
                    for transform in deserialize_message(raw, TFMessage).transforms:
                        self._add(transform, static)

    def close(self) -> None:
        """Hear nothing any more, and forget what was heard."""
        self._moving.close()
        self._static.close()
        self._tree, self._names = TransformTree(), set()

    def place(self, frame: str, stamp: float) -> Matrix:
        """Matrix (4, 4) that takes points of a frame to the scene's, as it was at `stamp` (s).

        What is fixed to the robot is where the robot was then by its odometry, which knows of the
        last seconds; of other frames counts the newest transform.

        Raises
        ------
        TransformError
            When the frame is not connected to the scene's; the message is a sentence.
        """
        scene, frame = self._world.frame, frame.removeprefix("/")
        if frame in ("", scene):
            return np.eye(4)
        mount = self._mount(frame)
        robot = None if mount is None else self._robot(stamp)
        if mount is not None and robot is not None:
            return _planar(robot) @ mount
        try:
            return self._tree.lookup(scene, frame)
        except TransformError:
            raise TransformError(
                f"Its frame {plain(frame, LONGEST_LABEL)} is not connected to "
                f"{plain(scene, LONGEST_LABEL)}: no transform says where it is."
            ) from None

    def _mount(self, frame: str) -> Matrix | None:
        """Where a frame is that is fixed to the robot's base; None of all others."""
        for base in _BASES:
            try:
                mount = self._tree.lookup(base, frame)
            except TransformError:
                continue
            if math.isinf(self._tree.moved_at(base, frame)):
                return mount
        return None

    def _robot(self, stamp: float) -> Pose | None:
        at = self._world.history.at(stamp) if stamp > 0.0 else None
        motion = self._world.motion.get()
        return at if at is not None or motion is None else motion.value.pose

    def _add(self, message: Any, static: bool) -> None:
        parent, child = str(message.header.frame_id), str(message.child_frame_id)
        moved, turned = message.transform.translation, message.transform.rotation
        place = (moved.x, moved.y, moved.z)
        rotation = (turned.x, turned.y, turned.z, turned.w)
        length = math.hypot(*rotation)
        if not (math.isfinite(length) and length > 0.0 and all(map(math.isfinite, place))):
            return  # as tf2 does: it is no transform
        if child not in self._names and len(self._names) >= _MOST_FRAMES:
            return
        self._names.add(child)
        matrix = matrix_of(place, rotation)
        self._tree.add(parent, child, seconds(message.header.stamp), matrix, static=static)


def _planar(pose: Pose) -> Matrix:
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    matrix = np.eye(4)
    matrix[:2, :2] = [[c, -s], [s, c]]
    matrix[:2, 3] = pose.x, pose.y
    return matrix
