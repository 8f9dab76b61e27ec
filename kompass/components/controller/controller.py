"""The controller: follows the path to its very end, or a target that a camera sees."""

from pathlib import Path as FilePath
from typing import Any, ClassVar

import numpy as np
from geometry_msgs.msg import PoseStamped, Twist
from kompass_interfaces.action import ControlPath, TrackVisionTarget
from kompass_interfaces.msg import DriveState, TwistArray
from numpy.typing import NDArray
from rclpy.action import CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.task import Future

from kompass.algorithms.following.command import Command, FollowStep
from kompass.algorithms.following.follower import NoCommand, PathFollower
from kompass.algorithms.geometry import Pose2D, compose, inverse, transform_points
from kompass.algorithms.mapping.cloud_memory import CloudMemory
from kompass.algorithms.mapping.cloud_view import CloudView
from kompass.algorithms.mapping.moving import MovingObstacles, seen_from
from kompass.components.base.actions import component_action
from kompass.components.base.component import Component
from kompass.components.base.component_config import ComponentRunType
from kompass.components.base.convert import grid_of, quaternion_msg
from kompass.components.base.location_source import LocationSource
from kompass.components.base.main_interfaces import ACTION_HOOK, failed_result
from kompass.components.base.parameter import ParameterError
from kompass.components.base.people import People
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
    make_tracker,
)
from kompass.components.controller.obstacle_source import HANDOVER, ObstacleSource
from kompass.components.controller.path_goal import (
    FROM_FILE,
    NoPath,
    PathGoal,
    TopicPath,
    check_goal,
    check_path,
    check_reach,
    poses_of_file,
    poses_of_message,
)
from kompass.components.controller.progress import Progress
from kompass.components.controller.vision_mode import (
    EXAMPLES,
    NEEDED,
    VISION_INPUTS,
    VisionMode,
)
from kompass.printable import printable
from kompass.rclpy_ext.topic import LATCHED, SENSOR, AllowedTopics, QoSConfig, Topic
from kompass.store.errors import StoreUnwritable
from kompass.store.paths import robot_folder

STILL = Command()
SENSORS = ("sensor_data", "local_map")
NAMES_OF_TRACKERS = tuple(algorithm.value for algorithm in NEEDED)
EDGES = 5.0  # m up to which followers are shown the edges of zones
FEEDBACK = 0.2  # s
LOOK = 0.05  # s between two looks at whether a path has come


class Controller(Component):
    """Turns ``plan`` and ``location`` into commands; stops when its inputs stop.

    A path ends with its last pose, heading included. An empty path clears the old one. So does a
    person who presses STOP or takes the wheel: what publishes paths may be dead, or not know.

    ``<node>/control_path`` follows one path of a topic or a file to its end, and says how that
    ended. A path on ``plan`` takes over from it, so that a goal of a person comes first; while one
    of ``plan`` is followed it is refused. As ``ActionServer`` nothing but that action is followed.

    An algorithm that needs obstacles (DWA, DVZ, MPPI) sees them in ``local_map``, or, with
    ``use_direct_sensor``, in ``sensor_data``; only the one in use is subscribed to. For the others
    (Stanley, pure pursuit) neither is. Of several sensors each has to speak; what moves, MPPI
    learns from planar scans.

    VisionRGBFollower and VisionRGBDFollower follow no path but what a detector sees: the target of
    a goal of ``<node>/track_vision_target``, until that ends. They make it an ``ActionServer``.
    """

    config: ControllerConfig
    config_class = ControllerConfig
    needs_robot = True
    steps_in_any_run_type = True
    main_action_type = ControlPath
    serves_main_action_itself = True
    allowed_run_types = (ComponentRunType.TIMED, ComponentRunType.ACTION_SERVER)
    tells_missing_inputs = False
    allowed_inputs: ClassVar = {
        "plan": AllowedTopics(["Path"]),
        "location": AllowedTopics(["Odometry", "PoseStamped", "Pose"]),
        "sensor_data": AllowedTopics(SENSOR_INPUTS, 1, MOST_SENSORS),
        "local_map": AllowedTopics(["OccupancyGrid"]),
        "vision_detections": AllowedTopics(["Detection2DArray"], 0, 1),
        "depth_camera_info": AllowedTopics(["CameraInfo"], 0, 1),
        "depth_image": AllowedTopics(["Image"], 0, 1),
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
    # What comes from a camera is read as its drivers offer it.
    qos: ClassVar = {
        "plan": LATCHED,
        "local_map": QoSConfig(queue_size=1),
        "vision_detections": SENSOR,
        "depth_camera_info": SENSOR,
    }

    def __init__(self, component_name: str = "controller", **kwargs: Any) -> None:
        super().__init__(component_name, **kwargs)
        self._take_mode()

    # -- what a recipe says -------------------------------------------------------------------

    @property
    def algorithm(self) -> ControllersID:
        """What follows a path, or a target; a name may be assigned too.

        One that follows a target needs its inputs first, and makes the run type ``ActionServer``
        for as long as it is chosen.
        """
        return self.config.algorithm

    @algorithm.setter
    def algorithm(self, value: ControllersID | str) -> None:
        before = self.config.algorithm
        self.config.algorithm = value  # type: ignore[assignment]  # validated and converted
        problem = self._lacks_sight()
        if problem:
            self.config.algorithm = before
            raise ValueError(problem)
        self._take_mode()

    @property
    def _run_type_for_now(self) -> ComponentRunType | None:
        # A target is that of a goal.
        return ComponentRunType.ACTION_SERVER if self.config.algorithm.sees_target else None

    def _take_mode(self) -> None:
        """Have the main action be that of the algorithm."""
        sees = self.config.algorithm.sees_target
        self.action_type = TrackVisionTarget if sees else ControlPath

    def _lacks_sight(self) -> str:
        """What the algorithm needs to see with, and nobody has named; empty when all is there."""
        for key in NEEDED.get(self.config.algorithm, ()):
            if self.get_in_topic(key) is None:
                return (
                    f"{self.node_name}: algorithm = {self.config.algorithm.value} needs the input "
                    f"{key}; give it first, as in inputs({key}={EXAMPLES[key]})"
                )
        return ""

    def check_declaration(self) -> None:
        problem = self._lacks_sight()
        if problem:
            raise ValueError(problem)
        super().check_declaration()

    @property
    def direct_sensor(self) -> bool:
        """Whether DWA, DVZ and MPPI take obstacles from the scan; others need no sensor."""
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
        # A path of a topic, until it is known where the robot is: not looked at yet.
        self._unlooked: NDArray[np.float64] | None = None
        self._people = People()
        self._pursued: PathGoal | None = None  # of the action, whose path is followed
        self._progress = Progress()
        self._moving: dict[int, MovingObstacles] = {}  # by the index of their sensor
        self._clouds: dict[int, CloudMemory] = {}
        self._obstacles: ObstacleSource | None = None

    def wants_input(self, key: str) -> bool:
        if key in VISION_INPUTS:
            return self.config.algorithm.sees_target
        return key not in SENSORS

    def create_interfaces(self) -> None:
        name, sees = self.node_name, self.config.algorithm.sees_target
        path_action = f"{name}/control_path" if sees else self.main_action_name
        target_action = self.main_action_name if sees else f"{name}/track_vision_target"
        self._vision = VisionMode(
            self,
            (target_action, "track_vision_target"),
            location=lambda: self._location,
            locate=self._located,
            command=self._command,
            people=lambda: self._people,
        )
        self.node.create_subscription(
            DriveState, "drive_state", self._on_drive_state, LATCHED.to_ros()
        )
        self._zones = ZonesHeard(self.node)
        self._server = self.node.create_action_server(
            ControlPath,
            path_action,
            self._execute,
            goal_callback=lambda _goal: (
                GoalResponse.ACCEPT if self.is_active else GoalResponse.REJECT
            ),
            cancel_callback=lambda _handle: CancelResponse.ACCEPT,
        )

    def custom_on_activate(self) -> None:
        self._zones.mask_with(self.config.masks_in_force())
        self._location = LocationSource(self)
        self.input("plan").on_message = self._on_plan
        self._obstacles = ObstacleSource(
            self.node,
            lambda key: self._inputs[key],
            {"sensor_data": self._place_seen, "local_map": self._place_map},
        )
        self._obstacles.want(self._sensor)
        self._look_for_targets()

    def custom_on_deactivate(self) -> None:
        self._end(ControlPath.Result.OUTCOME_ERROR, "The controller was deactivated.")
        self._vision.end(TrackVisionTarget.Result.OUTCOME_ERROR, "The controller was deactivated.")
        self._halt()
        self._location.close()

    def _look_for_targets(self) -> None:
        """Follow targets if the algorithm does so, and with the settings that it has now."""
        sees = self.config.algorithm.sees_target
        for key in VISION_INPUTS:
            if self.get_in_topic(key) is not None:
                source = self.input(key)
                source.open(self.node) if sees else source.close(self.node)
        if not sees:
            text = f"{self.config.algorithm.value} follows a path now."
            self._vision.end(TrackVisionTarget.Result.OUTCOME_PREEMPTED, text)
            self._vision.use(None)
            return
        text = f"{self.config.algorithm.value} follows a target now."
        self._end(ControlPath.Result.OUTCOME_PREEMPTED, text)
        self._drop_path()
        section = self._section(self.config.algorithm)
        self._vision.use(make_tracker(section, self.config.described_robot))
        self._vision.listen()

    def on_config_changed(self, names: set[str]) -> None:
        problem = self._lacks_sight()
        if problem:
            raise ParameterError(problem)
        self._take_mode()
        if self.is_active and {"algorithm", "robot", *NAMES_OF_TRACKERS} & names:
            self._look_for_targets()
        self._zones.mask_with(self.config.masks_in_force())
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
        chosen = self.config.algorithm
        return make_follower(
            # Nothing is followed with it while the algorithm follows targets.
            self._section(ControllersID.STANLEY if chosen.sees_target else chosen),
            self.config.described_robot,
            goal_tolerance=self.config.goal_dist_tolerance,
            heading_tolerance=self.config.goal_orientation_tolerance,
        )

    @property
    def _sensor(self) -> str | None:
        """Key of the input that the algorithm sees obstacles in; None when it needs none."""
        chosen = self.config.algorithm
        if chosen.sees_target or not self._section(chosen).follower.needs_obstacles:
            return None
        return "sensor_data" if self.config.use_direct_sensor else "local_map"

    # -- inputs -------------------------------------------------------------------------------

    def _on_plan(self, message: Any) -> None:
        if self.run_type is ComponentRunType.ACTION_SERVER:
            return  # it is there for a goal that asks for it
        topic, pose = self.input("plan").topic.name, self._location.pose()
        try:
            poses = poses_of_message(message, self.frames.world)
            leads = len(poses) >= 2 and bool(np.all(np.isfinite(poses)))
            if leads and pose is not None:
                check_reach(poses, pose)
        except NoPath as error:
            self._refuse_path(error)
            return
        if not leads:
            if self._pursued is None:  # else the path is not the planner's, which has none
                self._drop_path()
            return
        self._end(ControlPath.Result.OUTCOME_PREEMPTED, f"A path on /{topic} took over.")
        self._set_path(poses)
        self._unlooked = poses if pose is None else None

    def _refuse_path(self, error: NoPath) -> None:
        if self._pursued is None:
            self._drop_path()
        self.warn(f"/{self.input('plan').topic.name}: a path is not followed: {error}")

    def _set_path(self, poses: NDArray[np.float64]) -> None:
        if not self._has_path:
            self._follower.reset()
        self._follower.set_path(poses)
        self._has_path, self._unlooked = True, None

    def _on_drive_state(self, state: DriveState) -> None:
        # The count tells of a STOP that was released while this process was held.
        if self._people.hear(state, self.clock.monotonic(), self.clock.wall()):
            self._end_by_people()
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

    # -- the action ---------------------------------------------------------------------------

    async def _execute(self, handle: ServerGoalHandle) -> ControlPath.Result:
        self.node.executor.create_task(self._server.expire_goals)
        try:
            result = await self._follow_for(handle)
        except Exception as error:  # noqa: BLE001 - becomes the status, and the result
            self.on_hook_error(ACTION_HOOK, error)
            result = failed_result(ControlPath, error)
            if self._pursued is not None and self._pursued.handle is handle:
                self._end(result.outcome, result.message)
            if handle.is_active:
                handle.abort()
        else:
            self.on_hook_done(ACTION_HOOK)
        return result

    async def _follow_for(self, handle: ServerGoalHandle) -> ControlPath.Result:
        """Follow the path of a goal to its end; how it ended."""
        try:
            poses = await self._path_of(handle.request)
        except NoPath as error:
            handle.abort()
            self.warn(f"no path is followed: {error}")
            return _ended(ControlPath.Result.OUTCOME_REFUSED, printable(f"{error}"))
        self._end(ControlPath.Result.OUTCOME_PREEMPTED, "A newer path took over.")
        ended = Future(executor=self.node.executor)
        self._pursued = pursued = PathGoal(handle, poses, ended)
        # The same path a second time is followed from its beginning, too.
        self._follower, self._incoming = self._make_follower(), None
        self._set_path(poses)
        while not ended.done():
            await self.sleep(FEEDBACK)
            if handle.is_cancel_requested and self._pursued is pursued:
                self._end(ControlPath.Result.OUTCOME_CANCELED, "Cancelled.")
        outcome, text, (distance, turn) = ended.result()
        result = _ended(outcome, text)
        result.destination_error.lateral_distance_error = distance
        result.destination_error.orientation_error = turn
        if outcome == ControlPath.Result.OUTCOME_ARRIVED:
            handle.succeed()
        elif outcome == ControlPath.Result.OUTCOME_CANCELED:
            handle.canceled()
        else:
            handle.abort()
        return result

    async def _path_of(self, goal: ControlPath.Goal) -> NDArray[np.float64]:
        """The path (N, 3) that a goal asks for, once it may be followed from here.

        Raises
        ------
        NoPath
            When it may not; says why.
        """
        check_goal(goal)
        asked = self._people.interruptions
        if self.config.algorithm.sees_target:
            chosen = self.config.algorithm.value
            raise NoPath(f"{chosen} follows no path; choose another one with set_algorithm")
        world = self.frames.world
        if goal.path_source == FROM_FILE:
            poses = poses_of_file(goal, self._paths_folder(), world)
        elif goal.path_name:
            poses = poses_of_message(await self._heard(goal.path_name), world)
        else:
            source = self.input("plan")
            if source.message is None:
                raise NoPath(f"path_name = '', and nothing has come on /{source.topic.name}")
            poses = poses_of_message(source.message, world)
        # Last, for all this may have changed while a path was waited for.
        refusal = self._people.refusal(self.clock.monotonic())
        if refusal:
            raise NoPath(refusal)
        if self._people.came_since(asked):
            raise NoPath("somebody pressed STOP, or took the wheel, since the path was asked for")
        if self._has_path and self._pursued is None:
            topic = self.input("plan").topic.name
            raise NoPath(f"the path of /{topic} is being followed; cancel its goal first")
        pose = self._location.pose()
        if pose is None or self.input("location").age() > self.config.location_timeout:
            raise NoPath("the robot does not know where it is")
        check_path(poses, pose, self._zones.now)
        return poses

    def _paths_folder(self) -> FilePath:
        given = self.config.paths_folder
        try:
            return robot_folder() / "paths" if given is None else FilePath(given).expanduser()
        except (StoreUnwritable, RuntimeError) as error:
            raise NoPath(f"there is no folder of paths: {error}") from None

    async def _heard(self, topic: str) -> Any:
        """The path of a topic."""
        source, limit = TopicPath(self.node, topic), self.config.topic_subscription_timeout
        until = self.clock.monotonic() + limit
        try:
            while source.message is None:
                if self.clock.monotonic() >= until:
                    raise NoPath(
                        f"path_name = {topic!r}: no path came within {limit:g} s; publish it "
                        "latched (transient local), or after the goal"
                    )
                await self.sleep(LOOK)
        finally:
            source.close()
        return source.message

    def _end(self, outcome: int, text: str) -> None:
        """End the goal that is pursued, and with it its path."""
        pursued, self._pursued = self._pursued, None
        if pursued is None:
            return
        pose = self._location.pose()
        errors = (np.inf, np.inf) if pose is None else pursued.errors(pose)
        self._drop_path()
        self.node.write_log("info", f"the path ended: {text}")
        pursued.ended.set_result((outcome, text, errors))

    def _end_by_people(self) -> None:
        people = self._people
        if people.stopped or not people.driven:
            told = people.stopped or "somebody pressed STOP, or took the wheel"
            text = f"Stopped: {told}."
            self._end(ControlPath.Result.OUTCOME_STOPPED, text)
            self._vision.end(TrackVisionTarget.Result.OUTCOME_STOPPED, text)
        else:
            text = f"Driven by hand: {people.driven}."
            self._end(ControlPath.Result.OUTCOME_PREEMPTED, text)
            self._vision.end(TrackVisionTarget.Result.OUTCOME_PREEMPTED, text)

    def _judge_pursued(self, pose: Pose2D | None) -> None:
        """Give up a path on which the robot has not got on for long, whatever the reason."""
        pursued = self._pursued
        if pursued is None:
            return
        now = self.clock.monotonic()
        at = pursued.last if pose is None else pose
        if at is None:
            return
        pursued.last = at
        if pursued.progress.stalled(at, now, turning=False) >= self.config.patience:
            text = f"No progress for {self.config.patience:g} s"
            why = "" if self.health.is_healthy else f": {self.health.message}"
            self._end(ControlPath.Result.OUTCOME_STUCK, f"{text}{why}.")

    def _tell_pursued(self, step: FollowStep, began: float) -> None:
        pursued, now = self._pursued, self.clock.monotonic()
        if pursued is None or now - pursued.told < FEEDBACK:
            return
        pursued.told = now
        feedback = ControlPath.Feedback(
            prediction_horizon=self.config.control_time_step, compute_time=now - began
        )
        feedback.global_path_deviation.lateral_distance_error = step.cross_track_error
        feedback.global_path_deviation.orientation_error = step.heading_error
        feedback.control = self._twist(step.command)
        feedback.control_list = self._twists(step.command)
        pursued.handle.publish_feedback(feedback)

    # -- the loop -----------------------------------------------------------------------------

    def _execution_step(self) -> None:
        if self.config.algorithm.sees_target:
            self._vision.step()
            return
        self._step()
        self._judge_pursued(self._location.pose())

    def _step(self) -> None:
        began = self.clock.monotonic()
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
        if self._has_path and self._unlooked is not None:
            path, self._unlooked = self._unlooked, None
            try:
                check_reach(path, pose)
            except NoPath as error:
                self._refuse_path(error)
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
        self._tell_pursued(step, began)
        if step.phase == "arrived":
            self._end(ControlPath.Result.OUTCOME_ARRIVED, "Arrived at the end of the path.")
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
            self.publish("multi_command", self._twists(command))
            return
        self.publish("command", self._twist(command))

    def _twists(self, command: Command) -> TwistArray:
        message = TwistArray(time_step=self.config.control_time_step)
        message.linear_velocities.x = [command.vx]
        message.linear_velocities.y = [command.vy]
        message.linear_velocities.z = [0.0]
        message.angular_velocities.x = [0.0]
        message.angular_velocities.y = [0.0]
        message.angular_velocities.z = [command.omega]
        return message

    def _twist(self, command: Command) -> Twist:
        twist = Twist()
        twist.linear.x, twist.linear.y, twist.angular.z = command.vx, command.vy, command.omega
        return twist

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


def _ended(outcome: int, text: str) -> ControlPath.Result:
    arrived = outcome == ControlPath.Result.OUTCOME_ARRIVED
    return ControlPath.Result(reached_end=arrived, outcome=outcome, message=text)
