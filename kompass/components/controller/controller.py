"""The controller: follows the path, to its very end."""

from typing import Any, ClassVar

import numpy as np
from geometry_msgs.msg import PoseStamped, Twist
from kompass_interfaces.msg import DriveState, TwistArray
from numpy.typing import NDArray

from kompass.algorithms.following.command import Command, FollowStep
from kompass.algorithms.following.follower import NoCommand, PathFollower
from kompass.algorithms.geometry import Pose2D, compose, inverse, transform_points
from kompass.algorithms.mapping.cloud_memory import CloudMemory
from kompass.algorithms.mapping.cloud_view import CloudView
from kompass.algorithms.mapping.moving import MovingObstacles, seen_from
from kompass.components.base.actions import component_action
from kompass.components.base.component import Component
from kompass.components.base.component_config import ComponentRunType
from kompass.components.base.convert import grid_of, path_poses, quaternion_msg
from kompass.components.base.location_source import LocationSource
from kompass.components.base.seen import (
    MOST_SENSORS,
    SENSOR_INPUTS,
    cloud_memory,
    read_seen,
    stamp_of,
)
from kompass.components.base.zones_heard import ZonesHeard
from kompass.components.controller.config import CmdPublishType, ControllerConfig
from kompass.components.controller.controllers_id import ControllersID
from kompass.components.controller.follower_settings import (
    SECTIONS,
    FollowerSettings,
    make_follower,
)
from kompass.components.controller.obstacle_source import HANDOVER, ObstacleSource
from kompass.components.controller.progress import Progress
from kompass.rclpy_ext.topic import LATCHED, AllowedTopics, QoSConfig, Topic

STILL = Command()
SENSORS = ("sensor_data", "local_map")
EDGES = 5.0  # m up to which followers are shown the edges of zones
MOST_POSES = 20_000  # of a path: to look at more takes so long that the controller seems to hang


class Controller(Component):
    """Turns ``plan`` and ``location`` into commands; stops when its inputs stop.

    A path ends with its last pose, heading included. An empty path clears the old one. So does a
    person who presses STOP or takes the wheel: what publishes paths may be dead, or not know.

    An algorithm that needs obstacles (DWA, MPPI) sees them in ``local_map``, or, with
    ``use_direct_sensor``, in ``sensor_data``; only the one in use is subscribed to. For the others
    (Stanley, pure pursuit) neither is. Of several sensors each has to speak; what moves, MPPI
    learns from planar scans.
    """

    config: ControllerConfig
    config_class = ControllerConfig
    needs_robot = True
    allowed_run_types = (ComponentRunType.TIMED,)
    tells_missing_inputs = False
    allowed_inputs: ClassVar = {
        "plan": AllowedTopics(["Path"]),
        "location": AllowedTopics(["Odometry", "PoseStamped", "Pose"]),
        "sensor_data": AllowedTopics(SENSOR_INPUTS, 1, MOST_SENSORS),
        "local_map": AllowedTopics(["OccupancyGrid"]),
    }
    allowed_outputs: ClassVar = {
        "command": AllowedTopics(["Twist"]),
        "multi_command": AllowedTopics(["TwistArray"]),
        "tracked_point": AllowedTopics(["PoseStamped"]),
    }
    default_inputs: ClassVar = {
        "plan": [Topic(name="/plan", msg_type="Path")],
        "location": [Topic(name="/odom", msg_type="Odometry")],
        "sensor_data": [Topic(name="/scan", msg_type="LaserScan")],
        "local_map": [Topic(name="/local_map/occupancy_layer", msg_type="OccupancyGrid")],
    }
    default_outputs: ClassVar = {
        "command": [Topic(name="/control", msg_type="Twist")],
        "multi_command": [Topic(name="/control_list", msg_type="TwistArray")],
        "tracked_point": [Topic(name="/tracked_point", msg_type="PoseStamped")],
    }
    qos: ClassVar = {"plan": LATCHED, "local_map": QoSConfig(queue_size=1)}

    def __init__(self, component_name: str = "controller", **kwargs: Any) -> None:
        super().__init__(component_name, **kwargs)

    # -- what a recipe says -------------------------------------------------------------------

    @property
    def algorithm(self) -> ControllersID:
        """The path-following algorithm; a name may be assigned too."""
        return self.config.algorithm

    @algorithm.setter
    def algorithm(self, value: ControllersID | str) -> None:
        self.config.algorithm = value  # type: ignore[assignment]  # validated and converted

    @property
    def direct_sensor(self) -> bool:
        """Whether DWA and MPPI take obstacles from the scan; other algorithms need no sensor."""
        return self.config.use_direct_sensor

    @direct_sensor.setter
    def direct_sensor(self, value: bool) -> None:
        self.config.use_direct_sensor = value

    @property
    def algorithms_config(self) -> dict[str, FollowerSettings]:
        """Settings of the algorithms by name; one, a list or a mapping may be assigned."""
        return {algorithm.value: self._section(algorithm) for algorithm in SECTIONS}

    @algorithms_config.setter
    def algorithms_config(self, value: Any) -> None:
        if isinstance(value, dict):
            for name, section in value.items():
                setattr(self.config, ControllersID(name).value, section)
            return
        for section in value if isinstance(value, list | tuple) else [value]:
            if not isinstance(section, FollowerSettings):
                names = ", ".join(kind.__name__ for kind in SECTIONS.values())
                raise TypeError(f"{self.node_name}: {section!r} is none of {names}")
            setattr(self.config, section.section, section)

    @component_action
    def set_algorithm(self, algorithm_value: ControllersID | str) -> bool:
        """Follow the same path with another algorithm from now on."""
        return self.set_param("algorithm", algorithm_value)

    def _section(self, algorithm: ControllersID) -> FollowerSettings:
        section: FollowerSettings = getattr(self.config, algorithm.value)
        return section

    # -- life ---------------------------------------------------------------------------------

    def init_variables(self) -> None:
        if not self.lacks_robot:  # without one it is not configured
            self._follower = self._make_follower()
        self._incoming: PathFollower[Any] | None = None
        self._incoming_since = 0.0
        self._has_path = False
        self._interruptions: int | None = None  # by people, as the drive manager counts them
        self._progress = Progress()
        self._moving: dict[int, MovingObstacles] = {}  # by the index of their sensor
        self._clouds: dict[int, CloudMemory] = {}
        self._obstacles: ObstacleSource | None = None

    def wants_input(self, key: str) -> bool:
        return key not in SENSORS

    def create_interfaces(self) -> None:
        self.node.create_subscription(
            DriveState, "drive_state", self._on_drive_state, LATCHED.to_ros()
        )
        self._zones = ZonesHeard(self.node)

    def custom_on_activate(self) -> None:
        self._location = LocationSource(self)
        self.input("plan").on_message = self._on_plan
        self._obstacles = ObstacleSource(
            self.node,
            lambda key: self._inputs[key],
            {"sensor_data": self._place_seen, "local_map": self._place_map},
        )
        self._obstacles.want(self._sensor)

    def custom_on_deactivate(self) -> None:
        self._halt()
        self._location.close()

    def on_config_changed(self, names: set[str]) -> None:
        follower = self._make_follower()
        self._clouds = {}  # which may be read otherwise from now on
        if self._obstacles is not None and self.is_active:
            self._obstacles.want(self._sensor)
        sees = self._follower.needs_obstacles
        if follower.needs_obstacles and not sees and self._has_path:
            # The old one drives on until the new one can see.
            self._incoming, self._incoming_since = follower, self.clock.monotonic()
            return
        self._change_to(follower)

    def _change_to(self, follower: PathFollower[Any]) -> None:
        follower.take_over(self._follower)
        self._follower, self._incoming = follower, None

    def _make_follower(self) -> PathFollower[Any]:
        return make_follower(
            self._section(self.config.algorithm),
            self.config.described_robot,
            goal_tolerance=self.config.goal_dist_tolerance,
            heading_tolerance=self.config.goal_orientation_tolerance,
        )

    @property
    def _sensor(self) -> str | None:
        """Key of the input that the algorithm sees obstacles in; None when it needs none."""
        if not self._section(self.config.algorithm).follower.needs_obstacles:
            return None
        return "sensor_data" if self.config.use_direct_sensor else "local_map"

    # -- inputs -------------------------------------------------------------------------------

    def _on_plan(self, message: Any) -> None:
        if len(message.poses) > MOST_POSES:
            self._drop_path()
            self.warn(
                f"/{self.input('plan').topic.name}: a path of {len(message.poses)} poses is not "
                f"followed; send one of at most {MOST_POSES}"
            )
            return
        poses = path_poses(message)
        if len(poses) < 2 or not np.all(np.isfinite(poses)):
            self._drop_path()
            return
        if not self._has_path:
            self._follower.reset()
        self._follower.set_path(poses)
        self._has_path = True

    def _on_drive_state(self, state: DriveState) -> None:
        before, self._interruptions = self._interruptions, state.interruptions
        # The count tells of a STOP that was released while this process was held.
        if state.stopped or state.driven_by or before not in (None, state.interruptions):
            self._drop_path()

    def _drop_path(self) -> None:
        if self.is_active:
            self._halt()
        self._has_path = False

    def _place_seen(self, index: int, message: Any) -> NDArray[np.float64]:
        seen = read_seen(message, self._location, self.config)
        # At 2 m/s and while it turns the robot is elsewhere when the next location comes.
        pose = self._location.pose_at(stamp_of(message))
        if pose is None:
            raise LookupError("the robot does not know where it is")
        now = self.clock.monotonic()
        points = transform_points(pose, seen.points)
        if isinstance(seen, CloudView):
            memory = self._clouds.setdefault(index, cloud_memory(self.config))
            memory.see(seen, pose, now)
            return np.concatenate([points, memory.points(now)])
        if self._follower.looks_ahead_in_time:
            x, y, yaw = (float(value) for value in compose(pose, seen.sensor))
            moving = self._moving.setdefault(index, MovingObstacles())
            moving.see(*seen.rays, (x, y, yaw), now)
        return points

    def _place_map(self, _index: int, message: Any) -> NDArray[np.float64]:
        frame = message.header.frame_id
        if frame and frame != self.frames.world:
            raise ValueError(f"it is in frame '{frame}', not in '{self.frames.world}'")
        grid = grid_of(message)
        rows, cols = np.nonzero(grid.occupied())
        return grid.cell_to_world(np.column_stack([cols, rows]))

    # -- the loop -----------------------------------------------------------------------------

    def _execution_step(self) -> None:
        if self._incoming is not None and self._obstacles is not None:
            sees = self._obstacles.points(self.config.sensor_timeout) is not None
            if sees or self.clock.monotonic() - self._incoming_since > HANDOVER:
                self._change_to(self._incoming)
        pose = self._located()
        seen = self._seen() if pose is not None else None
        if pose is None or seen is None:
            # InputPorts that have never spoken get their time; the robot stands meanwhile.
            if self._has_path:
                self._halt()
                self._follower.reset()
            self._progress.reset()
            return
        if not self._has_path:
            self._progress.reset()
            self.health.set_healthy()
            return
        vx, vy, omega = self._location.speed()
        period = 1.0 / self.config.loop_rate
        try:
            points = transform_points(inverse(pose), self._with_zones(seen, pose))
            moving = seen_from(pose, self._moving_now())
            step = self._follower.step(pose, vx, omega, period, points, moving, vy)
        except NoCommand as error:
            self.health.set_fail_algorithm([self.config.algorithm.value], str(error))
            self._halt()
            self._follower.reset()
            self._progress.reset()
            return
        self._judge_progress(step, pose)
        self._command(step.command)
        self._publish_tracked_point(step, pose)
        if step.phase == "arrived":
            self._has_path = False

    def _judge_progress(self, step: FollowStep, pose: Pose2D) -> None:
        """Commands that lead nowhere are a failure too; they go on, for the way may come free."""
        turning = step.phase in ("turning", "aligning")
        stalled = self._progress.stalled(pose, self.clock.monotonic(), turning=turning)
        if step.phase == "arrived" or stalled < self.config.progress_timeout:
            self.health.set_healthy()
            return
        algorithm = self.config.algorithm.value
        self.health.set_fail_algorithm([algorithm], f"no progress for {stalled:.0f} s")

    def _located(self) -> Pose2D | None:
        """The pose, or None with the reason in the health."""
        source = self.input("location")
        pose = self._location.pose()
        if pose is not None and source.age() <= self.config.location_timeout:
            return pose
        topic = f"/{source.topic.name}"
        if self.awaits(source):
            self.health.set_healthy(f"waiting for {topic}")
        else:
            text = "the robot does not know where it is"
            if source.silence() <= self.config.location_timeout < source.age():
                text += f": {source.too_old(self.config.location_timeout)}"
            self.health.set_fail_system(topics=[topic], message=text)
        return None

    def _seen(self) -> NDArray[np.float64] | None:
        """Obstacles (N, 2) in the world's frame, or None with the reason in the health."""
        if (
            self._obstacles is None
            or not self._obstacles.inputs
            or not self._follower.needs_obstacles
        ):
            return np.empty((0, 2))
        limit = self.config.sensor_timeout
        points = self._obstacles.points(limit)
        if points is not None:
            return points
        silent = self._obstacles.silent(limit)
        topics = [f"/{source.topic.name}" for source in silent]
        if self.is_starting and all(
            problem or self.awaits(source) for source, problem in silent.items()
        ):
            self.health.set_healthy(f"waiting for {', '.join(topics)}")
            return None
        several = len(self._obstacles.inputs) > 1
        reasons = []
        for topic, (source, problem) in zip(topics, silent.items(), strict=True):
            old = source.too_old(limit) or f"nothing on {topic}"
            told = f"{topic}: {problem}" if problem and several else problem
            reasons.append(told or f"{old}, to see obstacles with")
        self.health.set_fail_system(topics=topics, message="; ".join(reasons))
        return None

    def _moving_now(self) -> NDArray[np.float64]:
        """What moves, (M, 5) in the world's frame, by each of the scanners."""
        now = self.clock.monotonic()
        moving = [each.at(now) for each in self._moving.values()]
        return np.concatenate([np.empty((0, 5)), *moving])

    def _with_zones(self, seen: NDArray[np.float64], pose: Pose2D) -> NDArray[np.float64]:
        """What is seen (N, 2), and the edges of keep-out zones, which are as much in the way."""
        if not (self._zones.now and self._follower.needs_obstacles):
            return seen
        return np.concatenate([seen, self._zones.now.in_the_way(pose[0], pose[1], EDGES)])

    def _halt(self) -> None:
        if self._has_path:
            self._command(STILL)

    def _command(self, command: Command) -> None:
        if self.config.ctrl_publish_type is CmdPublishType.TWIST_ARRAY:
            message = TwistArray(time_step=self.config.control_time_step)
            message.linear_velocities.x = [command.vx]
            message.linear_velocities.y = [command.vy]
            message.linear_velocities.z = [0.0]
            message.angular_velocities.x = [0.0]
            message.angular_velocities.y = [0.0]
            message.angular_velocities.z = [command.omega]
            self.publish("multi_command", message)
            return
        twist = Twist()
        twist.linear.x, twist.linear.y, twist.angular.z = command.vx, command.vy, command.omega
        self.publish("command", twist)

    def _publish_tracked_point(self, step: FollowStep, pose: Pose2D) -> None:
        tracker = self._follower.tracker
        if tracker is None:
            return
        x, y = (float(value) for value in tracker.point_at(step.progress)[:2])
        message = PoseStamped()
        message.header.frame_id = self.frames.world
        message.header.stamp = self.node.get_clock().now().to_msg()
        message.pose.position.x, message.pose.position.y = x, y
        message.pose.orientation = quaternion_msg(pose[2] + step.heading_error)
        self.publish("tracked_point", message)
