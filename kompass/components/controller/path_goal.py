"""A goal of ``ControlPath``: where its path comes from, and whether it can be followed."""

import math
from pathlib import Path as FilePath
from typing import Any

import numpy as np
from kompass_interfaces.action import ControlPath
from kompass_interfaces.msg import FollowPathRequest
from nav_msgs.msg import Path
from numpy.typing import NDArray
from rclpy.exceptions import NameValidationException
from rclpy.task import Future
from rclpy.validate_topic_name import validate_topic_name

from kompass.algorithms.geometry import Pose2D, wrap_angle
from kompass.algorithms.path_file import PathFileError, load_path
from kompass.bus.node import Node
from kompass.components.base.convert import path_poses
from kompass.components.controller.progress import Progress
from kompass.rclpy_ext.qos import best_for
from kompass.zones.in_force import ZonesInForce

FROM_TOPIC = FollowPathRequest.FOLLOW_PATH_FROM_ROS_TOPIC
FROM_FILE = FollowPathRequest.FOLLOW_PATH_FROM_XML_FILE
FARTHEST = 1.0  # m from the robot to the path
MOST_POSES = 20_000  # of a path: to look at more takes so long that the controller seems to hang
STRIDE = 0.05  # m between two places of a path that are looked at


class NoPath(Exception):
    """There is no path to follow; the message says why, and what to do."""


class PathGoal:
    """One goal that is pursued.

    Parameters
    ----------
    poses
        (N, 3) in the world's frame [m, m, rad].
    ended
        Gets outcome and reason.
    """

    def __init__(self, handle: Any, poses: NDArray[np.float64], ended: Future) -> None:
        self.handle, self.poses, self.ended = handle, poses, ended
        self.progress = Progress()
        self.last: Pose2D | None = None  # where the robot was when that was known
        self.told = -math.inf  # when feedback was given

    def errors(self, pose: Pose2D) -> tuple[float, float]:
        """Distance from the end [m], and difference to its heading [rad]."""
        x, y, yaw = (float(value) for value in self.poses[-1])
        return float(np.hypot(x - pose[0], y - pose[1])), float(wrap_angle(yaw - pose[2]))


class TopicPath:
    """Waits for one path on a topic.

    Raises
    ------
    NoPath
        When that is no name of a topic, or nobody publishes a path there.
    """

    def __init__(self, node: Node, topic: str) -> None:
        self.message: Path | None = None
        self._node = node
        try:
            validate_topic_name(topic)
            name = node.resolve_topic_name(topic)
        except (NameValidationException, ValueError) as error:
            why = str(error).splitlines()[0]
            raise NoPath(
                f"path_name = {topic!r}: {why}; give letters, digits, '_' and '/', as in '/taught'"
            ) from None
        infos = node.get_publishers_info_by_topic(name)
        kinds = sorted({info.topic_type for info in infos})
        if kinds != ["nav_msgs/msg/Path"]:
            found = " and ".join(kinds) if kinds else "nobody"
            raise NoPath(
                f"path_name = {topic!r}: {found} publishes there; give the topic of a nav_msgs/Path"
            )
        qos = best_for(infos).profile(1)
        self._subscription = node.create_subscription(Path, name, self._hear, qos)

    def _hear(self, message: Path) -> None:
        self.message = message

    def close(self) -> None:
        """Listen no more."""
        self._node.destroy_subscription(self._subscription)


def check_goal(goal: ControlPath.Goal) -> None:
    """Look at what a goal says, without its path.

    Raises
    ------
    NoPath
        When it cannot be meant, or not be done here.
    """
    if goal.path_source not in (FROM_TOPIC, FROM_FILE):
        raise NoPath(
            f"path_source = {goal.path_source}; give {FROM_TOPIC} (a topic) or {FROM_FILE} (a file)"
        )
    if goal.controller != 0:
        raise NoPath(
            f"controller = {goal.controller}; give 0, and choose the algorithm with set_algorithm"
        )
    if goal.path_source == FROM_FILE and not goal.path_name:
        raise NoPath("path_name = ''; give the name of the file")
    if goal.path_source == FROM_TOPIC and goal.path_file_location:
        raise NoPath(
            f"path_file_location = {goal.path_file_location!r} with a topic; give path_source = "
            f"{FROM_FILE} for a file"
        )


def poses_of_file(goal: ControlPath.Goal, folder: FilePath, world: str) -> NDArray[np.float64]:
    """The path (N, 3) of a goal's file [m, m, rad].

    Parameters
    ----------
    folder
        From which a relative location sets out.

    Raises
    ------
    NoPath
        When there is none that can be used.
    """
    try:
        saved = load_path(folder / goal.path_file_location / goal.path_name)
    except PathFileError as error:
        raise NoPath(str(error)) from None
    check_frame(saved.frame, world)
    return saved.poses


def poses_of_message(message: Path, world: str) -> NDArray[np.float64]:
    """The path (N, 3) of a message; raises as :func:`poses_of_file`."""
    if len(message.poses) > MOST_POSES:
        raise NoPath(f"the path has {len(message.poses)} poses; give at most {MOST_POSES}")
    check_frame(message.header.frame_id, world)
    return path_poses(message)


def check_frame(frame: str, world: str) -> None:
    """Look whether a path is in the frame that it is followed in.

    Raises
    ------
    NoPath
        It is in another one.
    """
    if frame.removeprefix("/") not in ("", world):
        raise NoPath(f"the path is in frame '{frame}'; give it in '{world}'")


def check_path(poses: NDArray[np.float64], pose: Pose2D, zones: ZonesInForce) -> None:
    """Look whether a path can be followed from where the robot is.

    Raises
    ------
    NoPath
        It has too few or too many poses, or one that is not finite, leads nowhere or through a
        keep-out zone, or is too far away.
    """
    if not 2 <= len(poses) <= MOST_POSES:
        raise NoPath(f"the path has {len(poses)} poses; give from 2 to {MOST_POSES}")
    if not np.isfinite(poses).all():
        row = int(np.argmin(np.isfinite(poses).all(axis=1)))
        raise NoPath(f"pose {row} of the path is {poses[row].tolist()}; give finite numbers")
    length = float(_steps(poses).sum())
    if length < STRIDE:
        raise NoPath(f"the path is {length:.3f} m long; give at least {STRIDE:g} m")
    places = check_reach(poses, pose)
    if not zones:
        return
    for x, y in places:
        zone = zones.barred(float(x), float(y))
        if zone is not None:
            raise NoPath(
                f"the path leads through the keep-out zone {zone.name!r}, at ({x:z.2f}, {y:z.2f})"
            )


def check_reach(poses: NDArray[np.float64], pose: Pose2D) -> NDArray[np.float64]:
    """Look whether a path (N, 3), N ≥ 2, all of it finite, is near the robot, and no longer than
    can be meant.

    Returns
    -------
    NDArray[np.float64]
        Places (M, 2) along it, ``STRIDE`` apart.

    Raises
    ------
    NoPath
        It is not.
    """
    steps = _steps(poses)
    if steps.sum() > STRIDE * MOST_POSES:
        raise NoPath(
            f"the path is {steps.sum():.0f} m long; give at most {STRIDE * MOST_POSES:.0f} m"
        )
    places = _closely(poses, steps)
    away = float(np.hypot(places[:, 0] - pose[0], places[:, 1] - pose[1]).min())
    if away > FARTHEST:
        raise NoPath(
            f"the robot is {away:.2f} m away from the path; drive to within {FARTHEST:g} m of it"
        )
    return places


def _steps(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Lengths (N - 1,) of the steps of a path [m]; infinite where they are too long for numbers."""
    with np.errstate(over="ignore"):
        lengths: NDArray[np.float64] = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    return lengths


def _closely(poses: NDArray[np.float64], steps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places (M, 2) along a path, ``STRIDE`` apart."""
    along = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.append(np.arange(0.0, along[-1], STRIDE), along[-1])
    return np.column_stack([np.interp(at, along, poses[:, axis]) for axis in (0, 1)])
