"""The global planner: goals in, checked paths out, and every goal comes to an end."""

import math
from functools import partial
from typing import Any, ClassVar

import numpy as np
from geometry_msgs.msg import Point, PoseStamped
from kompass_interfaces.action import PlanPath
from kompass_interfaces.msg import DriveState, GoalHindrance
from kompass_interfaces.srv import CheckGoal
from nav_msgs.msg import Path
from rclpy.action import CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.task import Future
from std_msgs.msg import Bool, String

from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, Pose2D
from kompass.algorithms.grid import Grid
from kompass.algorithms.planning.car_planner import CarPlanner
from kompass.algorithms.planning.failure import PlanningFailure, Reason, code_of
from kompass.algorithms.planning.outline_planner import OutlinePlanner
from kompass.algorithms.planning.planner import GlobalPlanner, Plan
from kompass.algorithms.planning.shorten import path_length
from kompass.algorithms.safety.standstill import Standstill
from kompass.algorithms.transforms import TransformError
from kompass.components.base.actions import ActionRefused, component_action
from kompass.components.base.component import Component
from kompass.components.base.component_config import ComponentRunType
from kompass.components.base.convert import grid_of, path_msg, pose_of, quaternion_msg
from kompass.components.base.location_source import LocationSource
from kompass.components.base.main_interfaces import ACTION_HOOK, failed_result
from kompass.components.base.people import People
from kompass.components.base.seen import MOST_SENSORS, SENSOR_INPUTS, read_seen
from kompass.components.base.zones_heard import ZonesHeard
from kompass.components.planner.config import PlannerConfig, usable_planner
from kompass.components.planner.goal_check import check_goal
from kompass.components.planner.goal_fault import goal_fault, pose_fault
from kompass.components.planner.goal_progress import (
    FREE_HEADING,
    GoalOutcome,
    GoalProgress,
    Tolerance,
)
from kompass.components.planner.goal_reports import GOAL_REPORTS, REPORTS
from kompass.components.planner.hindrance import OUT_OF_SIGHT, Hindrance, find
from kompass.components.planner.live_map import LiveMap
from kompass.components.planner.neighbourhood import cut
from kompass.printable import printable
from kompass.rclpy_ext.topic import LATCHED, AllowedTopics, Topic
from kompass.timeline.goal import GoalReport, Outcome
from kompass.zones.in_force import ZonesInForce

REPORTED: dict[GoalOutcome, Outcome] = {
    GoalOutcome.ARRIVED: "arrived",
    GoalOutcome.REFUSED: "refused",
    GoalOutcome.BLOCKED: "blocked",
    GoalOutcome.STOPPED: "stopped",
    GoalOutcome.PREEMPTED: "preempted",
    GoalOutcome.CANCELED: "canceled",
    GoalOutcome.STUCK: "stuck",
    GoalOutcome.ERROR: "error",
}
PROGRESS_RATE = 10.0  # Hz, only while a goal is pursued
FEEDBACK_EVERY = 2  # turns of the progress timer
REPLAN_EVERY = 5  # of these turns: twice a second
HINDRANCE = "goal_hindrance"  # topic
SET_OFF = 4.0  # s that a robot has to set off on a path that was planned to help it
FIRST_SCAN = 1.0  # s in which one must come, where the planner begins to look
MOST_NAMED = 3  # keep-out zones in one sentence
RETRY = 1.0  # s from finding no way to looking again
NEWER = "A newer goal took over."
STRAYED = 0.5  # m
# A car is led along curves a little wider than its tightest one, so that it can steer back to them.
ROOM_TO_STEER = 1.1
BESIDE = 0.3  # m from the end of its path within which one has driven all of it
BETTER = 0.1  # share of the way that another path must save to take the place of a good one
DETOUR = 3.0  # m by which a way round nearby may be longer before one elsewhere is looked for
BORDER = 0.5  # m by which a way that is mended stays away from the end of what is looked at
# The algorithm was given all it needs and has no answer. A goal in a wall is not that.
ALGORITHM_FAILURES: tuple[Reason, ...] = ("start_blocked", "no_path", "unreachable")
# May come of a model that does not reach far enough.
WIDER: tuple[Reason, ...] = ("no_path", "unreachable", "start_blocked", "too_close")
# Of the clearance: what is asked for first, and what else when that leaves no way.
NARROWER = (0.5, 0.0)
START_SLACK = 1.5  # cells that a robot may stand nearer to what was seen than its radius
# May pass by itself or by somebody's recovery; worth waiting for.
MAY_PASS: tuple[Reason, ...] = ("no_map", "no_pose", "start_blocked", "no_path")


class Planner(Component):
    """Plans on the map, replans when the map closes the way, and says how each goal ended.

    With ``use_sensor`` it plans around what ``sensor_data`` has shown as well, and without a map
    on that alone: what was never seen counts as free. Twice a second, and as soon as the path has
    lost half of its clearance, it looks for another, while the robot drives on; a path that still
    holds stays, unless another is a tenth shorter. Where the clearance leaves no way it takes one
    with half of it, or one that the body just fits through.

    As ``ActionServer`` it serves ``<node>/plan_path``; as ``Timed`` or ``Event`` it takes goals
    from ``goal_point``. ``<node>/check_goal`` answers without moving anything.

    Where the robot does not get on, ``goal_hindrance`` says what is in the way, where, since when,
    and how much of the ``patience`` is used up. Rules answer that: what takes its time to help,
    motions of the drive manager and :meth:`wait_for_way`, does not count.
    """

    config: PlannerConfig
    config_class = PlannerConfig
    needs_robot = True
    steps_in_any_run_type = True
    allowed_run_types = (
        ComponentRunType.TIMED,
        ComponentRunType.ACTION_SERVER,
        ComponentRunType.EVENT,
    )
    allowed_inputs: ClassVar = {
        "map": AllowedTopics(["OccupancyGrid"]),
        "goal_point": AllowedTopics(["PoseStamped", "PointStamped", "Odometry"], 1, 2),
        "location": AllowedTopics(["Odometry", "PoseStamped", "Pose"]),
        "sensor_data": AllowedTopics(SENSOR_INPUTS, 1, MOST_SENSORS),
    }
    allowed_outputs: ClassVar = {
        "plan": AllowedTopics(["Path"]),
        "reached_end": AllowedTopics(["Bool"]),
    }
    default_inputs: ClassVar = {
        "map": [Topic(name="/map", msg_type="OccupancyGrid")],
        "goal_point": [Topic(name="/goal", msg_type="PointStamped")],
        "location": [Topic(name="/odom", msg_type="Odometry")],
        "sensor_data": [Topic(name="/scan", msg_type="LaserScan")],
    }
    default_outputs: ClassVar = {
        "plan": [Topic(name="/plan", msg_type="Path")],
        "reached_end": [Topic(name="/reached_end", msg_type="Bool")],
    }
    qos: ClassVar = {"map": LATCHED, "plan": LATCHED}
    main_action_type = PlanPath
    serves_main_action_itself = True
    tells_missing_inputs = False
    ignored_inputs: ClassVar = {"map_layer": "the key is 'map'"}

    def __init__(self, component_name: str = "planner", **kwargs: Any) -> None:
        super().__init__(component_name, **kwargs)

    @property
    def longest_step(self) -> float:
        return self.config.chosen_timeout + 2.0  # it is simplified and checked after it is found

    def init_variables(self) -> None:
        self._planner: GlobalPlanner | None = None
        self._live: LiveMap | None = None
        self._map: Grid | None = None  # without a live one
        self._off_map = ""  # which mask does not lie on it, in a sentence
        self._failed = -math.inf  # when it found no way
        self._led = -math.inf  # when a car was led anew from where it was
        self._kept = self.config.clearance  # by the path that is driven [m]
        self._pursued: GoalProgress | None = None
        self._handle: ServerGoalHandle | None = None
        self._ended: Future | None = None
        self._turn = 0
        self._people = People()
        self._because = ""
        self._standstill = Standstill()
        self._scout: LiveMap | None = None  # looks while a goal is hindered, if nothing else does
        self._found: Hindrance | None = None
        self._clearance: float | None = None  # for the goal that is pursued [m]
        self._moved_by = self._held_by = self._why = ""
        self._waiting = 0  # actions for which the patience stands still
        self._followed = 0.0

    @property
    def _serves_action(self) -> bool:
        return self.run_type is ComponentRunType.ACTION_SERVER

    def create_interfaces(self) -> None:
        name = self.node_name
        self.node.create_service(CheckGoal, f"{name}/check_goal", self._on_check_goal)
        self.node.create_subscription(
            DriveState, "drive_state", self._on_drive_state, LATCHED.to_ros()
        )
        self._zones = ZonesHeard(self.node, self._on_zones)
        self._hindrances = self.node.create_publisher(GoalHindrance, HINDRANCE, LATCHED.to_ros())
        self._reports = self.node.create_publisher(String, GOAL_REPORTS, REPORTS.to_ros())
        if self._serves_action:
            self._server = self.node.create_action_server(
                PlanPath,
                self.main_action_name,
                self._execute,
                goal_callback=lambda _goal: (
                    GoalResponse.ACCEPT if self.is_active else GoalResponse.REJECT
                ),
                cancel_callback=lambda _handle: CancelResponse.ACCEPT,
            )
            self._client = self.node.create_action_client(PlanPath, self.main_action_name)

    def wants_input(self, key: str) -> bool:
        return key != "sensor_data" or self.config.use_sensor

    def custom_on_activate(self) -> None:
        self._zones.mask_with(self.config.masks_in_force())
        self._location = LocationSource(self)
        self._watch()
        self.input("map").on_message = self._on_map
        self.input("location").on_message = self._on_location
        if not self._serves_action or self.config.goals_from_topics:
            for source in self._inputs["goal_point"]:
                source.on_message = self._on_goal_message
        self._progress = self.create_timer(1.0 / PROGRESS_RATE, self._follow)
        self._progress.cancel()
        self._tell_hindrance(None)
        # What one before it pursued has failed with its process; nobody watches over that path.
        self.publish("plan", self._path_msg(np.empty((0, 3))))

    def custom_on_deactivate(self) -> None:
        self._end(GoalOutcome.ERROR, "The planner was deactivated.")
        self._location.close()

    # -- inputs -------------------------------------------------------------------------------

    def on_config_changed(self, names: set[str]) -> None:
        if {"masks", "robot"} & names:
            self._zones.mask_with(self.config.masks_in_force())
            self._on_zones()
        if self.is_active and {"use_sensor", "obstacle_memory"} & names:
            self._watch()
        message = self.input("map").message
        if message is not None:
            self._on_map(message)

    def _watch(self) -> None:
        """Begin to listen to the sensor, or end it, as it is set."""
        self._scout = None
        if not self.config.use_sensor:
            self._live = None
            self._look_away()
            return
        self._live = self._look()

    def _look(self) -> LiveMap:
        """Listen to the sensors, and make what takes in what they show."""
        for index, source in enumerate(self._inputs["sensor_data"]):
            source.on_message = partial(self._on_seen, index)
            source.open(self.node)
        made = LiveMap(self.config.obstacle_memory)
        if self._map is not None:
            made.set_map(self._map)
        return made

    def _look_away(self) -> None:
        for source in self._inputs["sensor_data"]:
            source.close(self.node)

    @property
    def _looking(self) -> LiveMap | None:
        return self._live or self._scout

    def _on_seen(self, index: int, message: Any) -> None:
        if self._looking is not None:
            self._looking.wait_with(self.input("sensor_data", index).topic.name, message)

    def _take_seen_in(self) -> None:
        """Once it is known where the robot was when it was made."""
        live, pose = self._looking, self._location.pose()
        if live is None or pose is None:
            return
        now = self.clock.monotonic()
        stamped = getattr(self.input("location").fields, "header", None)
        read = partial(read_seen, location=self._location, settings=self.config)
        for topic, message in live.locate(pose, stamped):
            try:
                live.see(topic, message, read, now)
            except (TransformError, ValueError) as error:
                self.warn(f"/{topic}: {error}")
        pursued = self._pursued
        if pursued is None or pursued.path is None or live is not self._live:
            return
        near = self.config.described_robot.radius + self._kept / 2
        if live.threatens(pursued.ahead(pose), near):
            self._replan(now)

    def _on_map(self, message: Any) -> None:
        try:
            grid = grid_of(message)
        except ValueError as error:
            self.health.set_fail_system(topics=["/map"], message=str(error))
            return
        self._map = grid
        self._off_map = self._zones.now.off(grid)
        if self._looking is not None:
            self._looking.set_map(grid)
        if self._live is None:
            self._planner = self._planner_on(grid)

    def _on_zones(self) -> None:
        """Others are in force: what leads through them is no path any more."""
        self._planner = None
        pursued = self._pursued
        if not self.is_active or pursued is None or pursued.path is None:
            return
        pose = self._location.pose()
        if pose is None:
            return
        try:
            planner, _ = self._ready(pursued.goal)
            holds = not planner.blocked(pursued.ahead(pose))
        except PlanningFailure:
            holds = False
        if not holds:
            self._plan(self.clock.monotonic())

    def _planner_on(
        self, grid: Grid, start_slack: float = 0.0, zones: ZonesInForce | None = None
    ) -> GlobalPlanner:
        grid = (self._zones.now if zones is None else zones).occupy(grid)
        robot = self.config.described_robot
        body = Footprint(robot.footprint)
        if robot.turning_radius > 0:
            return CarPlanner(
                grid,
                footprint=body,
                turning_radius=ROOM_TO_STEER * robot.turning_radius,
                clearance=self._wanted_clearance,
                least=None if self._live is None else 0.0,
                unknown_is_obstacle=self.config.unknown_is_obstacle,
                points_per_meter=self.config.points_per_meter,
                start_slack=start_slack,
            )
        if not body.is_round:
            return OutlinePlanner(
                grid,
                footprint=body,
                clearance=self._wanted_clearance,
                least=None if self._live is None else 0.0,
                unknown_is_obstacle=self.config.unknown_is_obstacle,
                points_per_meter=self.config.points_per_meter,
                start_slack=start_slack,
            )
        return GlobalPlanner(
            grid,
            robot_radius=robot.radius,
            clearance=self._wanted_clearance,
            unknown_is_obstacle=self.config.unknown_is_obstacle,
            points_per_meter=self.config.points_per_meter,
            planner_id=usable_planner(self.config.chosen_planner),
            timeout=self.config.chosen_timeout,
            start_slack=start_slack,
        )

    @property
    def _wanted_clearance(self) -> float:
        return self.config.clearance if self._clearance is None else self._clearance

    def _on_location(self, _message: Any) -> None:
        self._standstill.update(self._location.speed(), self.clock.monotonic())
        self._take_seen_in()

    def _on_drive_state(self, state: DriveState) -> None:
        people = self._people
        over = people.hear(state, self.clock.monotonic(), self.clock.wall())
        self._moved_by, self._held_by = state.manoeuvre, state.limited_by
        held = state.limited_by
        self._because = f"; the drive manager holds the robot back: {held}" if held else ""
        if people.stopped:
            self._end(GoalOutcome.STOPPED, f"Stopped: {people.stopped}.")
        elif people.driven:
            self._end(GoalOutcome.PREEMPTED, f"Driven by hand: {state.driven_by} took the wheel.")
        elif over:
            # It began and ended while this process was held.
            told = "Stopped: somebody pressed STOP, or took the wheel, while the planner was held."
            self._end(GoalOutcome.STOPPED, told)

    def _on_goal_message(self, message: Any) -> None:
        """A goal on a topic: pursued here, or sent to our own action, where all can follow it."""
        frame = message.header.frame_id
        if frame and frame.removeprefix("/") != self.frames.world:
            self.warn(f"a goal in frame '{frame}' was ignored; send it in '{self.frames.world}'")
            return
        goal = PlanPath.Goal()
        tolerance = goal.end_tolerance
        tolerance.lateral_distance_error = self.config.distance_tolerance
        if hasattr(message, "point"):
            goal.goal.position = message.point
            tolerance.orientation_error = FREE_HEADING
        else:
            goal.goal.position.x, goal.goal.position.y, yaw = pose_of(message)
            goal.goal.orientation = quaternion_msg(yaw)
            tolerance.orientation_error = self.config.orientation_tolerance
        if self._serves_action:
            self._client.send_goal_async(goal)
        elif fault := goal_fault(goal):
            self.warn(fault)
        else:
            self._end(GoalOutcome.PREEMPTED, NEWER)
            self._begin(goal)

    @component_action(active=True)
    async def trigger_main_action_server(
        self,
        goal_x: float,
        goal_y: float,
        tolerance_dist: float = 0.1,
        tolerance_ori: float = 0.1,
        *,
        goal_orientation: float | None = None,
    ) -> bool:
        """Send the planner's own action a goal; True when it is accepted.

        Without a name, the third and fourth argument are tolerances, as recipes mean them.

        Parameters
        ----------
        goal_x, goal_y
            In the world's frame [m].
        goal_orientation
            Heading to arrive with [rad]; None for any.
        tolerance_dist, tolerance_ori
            How near is there [m], [rad].
        """
        if not self._serves_action:
            return self.fails('run_type is not "ActionServer", so there is no action')
        goal = PlanPath.Goal()
        goal.goal.position.x, goal.goal.position.y = float(goal_x), float(goal_y)
        goal.goal.orientation = quaternion_msg(goal_orientation or 0.0)
        goal.end_tolerance.lateral_distance_error = float(tolerance_dist)
        free = goal_orientation is None
        goal.end_tolerance.orientation_error = FREE_HEADING if free else float(tolerance_ori)
        if fault := goal_fault(goal):
            return self.fails(fault)
        handle = await self._client.send_goal_async(goal)
        return bool(handle.accepted) or self.fails("the goal was not accepted")

    # -- the action ---------------------------------------------------------------------------

    async def _execute(self, handle: ServerGoalHandle) -> PlanPath.Result:
        self.node.executor.create_task(self._server.expire_goals)
        try:
            result = await self._pursue(handle)
        except Exception as error:  # noqa: BLE001 - becomes the status, and the result
            self.on_hook_error(ACTION_HOOK, error)
            result = failed_result(PlanPath, error)
            if self._handle is handle:
                self._end(GoalOutcome.ERROR, result.message)
                self._handle = self._ended = None
            if handle.is_active:
                handle.abort()
        else:
            self.on_hook_done(ACTION_HOOK)
        return result

    async def _pursue(self, handle: ServerGoalHandle) -> PlanPath.Result:
        """Pursue a goal to its end; how it ended."""
        if fault := goal_fault(handle.request):
            handle.abort()
            refused = int(GoalOutcome.REFUSED)
            return PlanPath.Result(reached_end=False, outcome=refused, message=fault)
        self._end(GoalOutcome.PREEMPTED, NEWER)
        self._handle, self._ended = handle, Future(executor=self.node.executor)
        ended = self._ended
        self._begin(handle.request)
        outcome, message, displacement = await ended
        result = PlanPath.Result(
            reached_end=outcome is GoalOutcome.ARRIVED, outcome=int(outcome), message=message
        )
        result.end_displacement.lateral_distance_error = displacement[0]
        result.end_displacement.orientation_error = displacement[1]
        if outcome is GoalOutcome.ARRIVED:
            handle.succeed()
        elif outcome is GoalOutcome.CANCELED:
            handle.canceled()
        else:
            handle.abort()
        return result

    def _begin(self, goal: PlanPath.Goal) -> None:
        stated = goal.end_tolerance
        tolerance = Tolerance(
            stated.lateral_distance_error or self.config.distance_tolerance,
            stated.orientation_error or self.config.orientation_tolerance,
        )
        self._pursued = GoalProgress(pose_of(goal.goal), tolerance, self.config.patience)
        self._goal_id = f"{self.node_name} {int(1e6 * self.clock.wall())}"
        self._report(self._pursued)
        self._tell_hindrance(None)
        people = self._people
        if people.stopped:
            told = f"{people.stopped}; a person must release it before a new goal."
            self._end(GoalOutcome.STOPPED, told)
            return
        if people.driven:
            told = f"{people.driven}; the wheel must be given up before a new goal."
            self._end(GoalOutcome.REFUSED, told)
            return
        now = self.clock.monotonic()
        if people.were_missed(now):
            # It may have been asked for before; what came first cannot be told from the goal.
            told = "STOP was pressed, or the wheel taken, and given up again while the planner was"
            self._end(GoalOutcome.STOPPED, f"{told} held; send the goal again if it is wanted.")
            return
        self._plan(now)
        if self._pursued is not None:
            self._progress.reset()

    def _report(
        self, goal: GoalProgress, outcome: GoalOutcome | None = None, message: str = ""
    ) -> None:
        """Tell whoever keeps a record that a goal is pursued, or how it ended."""
        x, y, yaw = goal.goal
        report = GoalReport(
            planner=self.node_name,
            id=self._goal_id,
            x=x,
            y=y,
            yaw=yaw if goal.tolerance.heading_matters else None,
            time=self.clock.wall(),
            outcome="" if outcome is None else REPORTED[outcome],
            message=printable(message),
        )
        self._reports.publish(String(data=report.model_dump_json()))

    def _end(self, outcome: GoalOutcome, message: str, *, hindered: bool = False) -> None:
        pursued, self._pursued = self._pursued, None
        if pursued is None:
            return
        self._progress.cancel()
        pose = self._location.pose()
        displacement = pursued.errors(pose) if pose is not None else (math.inf, math.inf)
        self.publish("plan", self._path_msg(np.empty((0, 3))))
        self.publish("reached_end", Bool(data=outcome is GoalOutcome.ARRIVED))
        self.node.write_log("info", f"goal ended: {outcome.name}: {message}")
        self._report(pursued, outcome, message)
        self._forget_help()
        if not hindered:
            self._tell_hindrance(None)
        self._handle = None
        if self._ended is not None:
            self._ended.set_result((outcome, message, displacement))
            self._ended = None

    # -- planning -----------------------------------------------------------------------------

    def _plan(self, now: float) -> None:
        """Plan to the goal that is pursued, or judge why not."""
        pursued = self._pursued
        assert pursued is not None
        try:
            plan = self._find(pursued)
        except PlanningFailure as failure:
            self._fail(pursued, failure, now)
            return
        self.health.set_healthy()
        pursued.planned(plan.poses, now)
        self._drive(plan)

    def _drive(self, plan: Plan) -> None:
        self._kept = min(self._wanted_clearance, max(0.0, plan.room))
        self.publish("plan", self._path_msg(plan.poses))

    def _fail(self, pursued: GoalProgress, failure: PlanningFailure, now: float) -> None:
        """There is no way: stand, and wait for one as long as patience lasts."""
        self._failed, self._why = now, failure.message
        self._judge(failure)
        over = pursued.unplanned(now)
        self.publish("plan", self._path_msg(np.empty((0, 3))))
        # On the way, even a goal that is now out of reach may come back: a door, a person.
        may_pass = failure.reason in MAY_PASS or self._only_remembered(pursued, failure)
        if over or not (pursued.under_way or may_pass):
            self._give_up(pursued, now)

    def _only_remembered(self, pursued: GoalProgress, failure: PlanningFailure) -> bool:
        """Whether nothing but what was seen, and is out of sight, keeps a goal out of reach."""
        pose = self._location.pose()
        if self._live is None or pose is None or failure.reason not in WIDER:
            return False
        grid = self._live.model.grid(self.clock.monotonic(), seen_within=OUT_OF_SIGHT)
        try:
            self._planner_on(grid, self._start_slack).check(pose, pursued.goal[:2])
        except PlanningFailure:
            return False
        return True

    def _replan(self, now: float) -> None:
        """Look for a better path than the one that is driven."""
        pursued, live, pose = self._pursued, self._live, self._location.pose()
        if pursued is None or live is None or pose is None:
            return
        if pursued.path is None:
            if now - self._failed >= RETRY:
                self._plan(now)
            return
        ahead = pursued.ahead(pose)
        if not live.is_worth_a_plan(now) and not pursued.strayed(pose, STRAYED):
            return
        if self._mend(pursued, live, ahead, now) and not live.is_worth_all(now):
            return
        ahead = pursued.ahead(pose)  # which may be another one by now
        planner = None
        try:
            planner, _ = self._ready(pursued.goal)
            holds = not (planner.blocked(ahead, self._kept / 2) or pursued.strayed(pose, STRAYED))
            # Only a way with all of the clearance is better than one that holds.
            most = (1.0 - BETTER) * planner.cost(ahead) if holds else math.inf
            plan = self._find(pursued, narrow=not holds, most=most)
        except PlanningFailure as failure:
            # A path that the body still fits through is better than none.
            if planner is None or planner.blocked(ahead):
                self._fail(pursued, failure, now)
            return
        finally:
            live.planned(now)
        self.health.set_healthy()
        if holds and planner.cost(plan.poses) > (1.0 - BETTER) * planner.cost(ahead):
            return
        pursued.replanned(plan.poses, pose)
        self._drive(plan)

    def _mend(self, pursued: GoalProgress, live: LiveMap, ahead: Floats, now: float) -> bool:
        """Judge, and better, the path around the robot, where a map is too large for more.

        What has come or gone is near the robot, which sees no further: the path beyond was looked
        at before. False where what is near cannot tell.
        """
        body = self.config.described_robot
        if not live.neighbourhood or body.turning_radius > 0:
            return False
        try:
            pose = self._pose()
            around = live.model.grid_around(pose[:2], live.neighbourhood, now)
        except (PlanningFailure, ValueError):
            return False  # nobody knows where the robot is, or it is off the map: told by who plans
        radius = live.neighbourhood - body.radius - self._wanted_clearance - BORDER
        parts = cut(ahead, pose, radius)
        if len(parts.near) < 2:
            return False
        planner = self._planner_on(around, self._start_slack)
        if any(planner.blocked(piece, self._kept / 2) for piece in parts.visits):
            return False
        strayed = pursued.strayed(pose, STRAYED)
        holds = not (strayed or planner.blocked(parts.near, self._kept / 2))
        x, y, yaw = (float(value) for value in parts.near[-1])
        there = pursued.tolerance.heading_matters and not len(parts.rest)
        try:
            plan = planner.plan(pose, (x, y, yaw if there else None))
        except PlanningFailure:
            if holds:
                live.mended(now)
            return holds
        longer = path_length(plan.poses[:, :2]) - path_length(parts.near[:, :2])
        if not holds and longer > DETOUR:
            return False
        live.mended(now)
        saved = planner.cost(parts.near) - planner.cost(plan.poses)
        if holds and saved < BETTER * (planner.cost(parts.near) + path_length(parts.rest[:, :2])):
            return True
        self.health.set_healthy()
        pursued.replanned(np.concatenate([plan.poses, parts.rest]), pose)
        # What was left of the clearance beyond is what it was.
        self._kept = min(self._kept, max(0.0, plan.room))
        self.publish("plan", self._path_msg(pursued.path))
        return True

    def _find(self, pursued: GoalProgress, *, narrow: bool = True, most: float = math.inf) -> Plan:
        """A path; of one that would cost more than ``most`` a car's planner need not know."""
        try:
            return self._search(pursued, narrow=narrow, most=most)
        except PlanningFailure as failure:
            if most == math.inf:
                self._blame_zone(failure, pursued.goal)
            raise

    def _search(self, pursued: GoalProgress, *, narrow: bool, most: float) -> Plan:
        x, y, yaw = pursued.goal
        heading = yaw if pursued.tolerance.heading_matters else None
        planner, pose = self._ready(pursued.goal)
        try:
            if isinstance(planner, CarPlanner):
                return planner.plan(pose, (x, y, heading), most)
            return planner.plan(pose, (x, y, heading))
        except PlanningFailure as failure:
            if self._live is None or failure.reason not in WIDER or not narrow:
                raise
            told = failure
        # A planner that weighs narrow ways against long ones has looked at them all.
        for share in () if isinstance(planner, OutlinePlanner) else NARROWER:
            try:
                narrower = planner.with_clearance(share * self._wanted_clearance)
                return narrower.plan(pose, (x, y, heading))
            except PlanningFailure as failure:
                told = failure
        # The way round may lead further away than was thought of so far.
        if not self._live.widen():
            raise told
        return self._search(pursued, narrow=True, most=most)

    def _blame_zone(self, failure: PlanningFailure, goal: Pose2D) -> None:
        """Raise a failure anew, with the keep-out zone's name, where that is why."""
        pose = self._location.pose()
        if failure.reason in ("occupied", "too_close"):
            place = goal
        elif failure.reason == "start_blocked" and pose is not None:
            place = pose
        else:
            self._blame_closed_way(failure, pose, goal)
            return
        zones, near = self._zones.now, self.config.described_robot.radius + self.config.clearance
        zone = zones.barred(*place[:2], near)
        if zone is None:
            return
        # In whole sentences: the page knows them by their words, in other languages.
        at, name = f"({place[0]:z.2f}, {place[1]:z.2f})", repr(zone.name)
        inside, close = (
            (
                f"The goal {at} is inside the keep-out zone {name}.",
                f"The goal {at} is too close to the keep-out zone {name}.",
            )
            if place is goal
            else (
                f"The robot is inside the keep-out zone {name}; drive it away by hand.",
                f"The robot is too close to the keep-out zone {name}; drive it away by hand.",
            )
        )
        told = inside if zones.barred(*place[:2]) is zone else close
        raise PlanningFailure(failure.reason, told, failure.nearest)

    def _blame_closed_way(
        self, failure: PlanningFailure, pose: Pose2D | None, goal: Pose2D
    ) -> None:
        """Raise a failure anew where there would be a way without the keep-out zones."""
        names = self._zones.now.barred_names
        grid = self._map if self._live is None else self._live.model.grid(self.clock.monotonic())
        closed = failure.reason in ("no_path", "unreachable")
        if not closed or not names or grid is None or pose is None:
            return
        try:
            self._planner_on(grid, self._start_slack, ZonesInForce()).check(pose, goal[:2])
        except PlanningFailure:
            return
        shown = ", ".join(repr(name) for name in names[:MOST_NAMED])
        more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        told = f"{failure.message} Keep-out zones close it: {shown}{more}."
        raise PlanningFailure(failure.reason, told, failure.nearest)

    @property
    def _start_slack(self) -> float:
        return 0.0 if self._live is None else START_SLACK * self._live.model.resolution

    def _ready(self, goal: Pose2D | None = None) -> tuple[GlobalPlanner, Pose2D]:
        if self._live is None and self._map is None:
            raise PlanningFailure("no_map", "There is no map yet.")
        pose = self._pose()
        if self._live is None:
            if self._planner is None and self._map is not None:
                self._planner = self._planner_on(self._map)
        else:
            now = self.clock.monotonic()
            grid = self._live.grid(pose, goal, now)
            if grid is not None or self._planner is None:
                self._planner = self._planner_on(
                    grid or self._live.model.grid(now), self._start_slack
                )
        assert self._planner is not None
        return self._planner, pose

    def _pose(self) -> Pose2D:
        if self._off_map:
            raise PlanningFailure("no_map", self._off_map)
        pose = self._location.pose()
        if pose is None or self.input("location").age() > self.config.location_timeout:
            raise PlanningFailure("no_pose", "The robot does not know where it is.")
        return pose

    def _judge(self, failure: PlanningFailure) -> None:
        if failure.reason == "no_map":
            topic = self._topics_in["map"][0].name
            self.health.set_fail_system(topics=[f"/{topic}"], message=failure.message)
        elif failure.reason == "no_pose":
            topic = self._topics_in["location"][0].name
            self.health.set_fail_system(topics=[f"/{topic}"], message=failure.message)
        elif failure.reason in ALGORITHM_FAILURES:
            self.health.set_fail_algorithm([self.config.chosen_planner], failure.message)
        self.publish_status()

    def _execution_step(self) -> None:
        """The slow loop: is the map there, does the path still hold?"""
        now = self.clock.monotonic()
        pursued = self._pursued
        if pursued is None:
            self._judge_inputs()
            return
        if pursued.path is None:
            if self._live is None or now - self._failed >= RETRY:
                self._plan(now)
            return
        if self._live is not None:
            return  # it looks more often than this
        pose = self._location.pose()
        if pose is None or self._planner is None:
            return
        if self._planner.blocked(pursued.ahead(pose)) or pursued.strayed(pose, STRAYED):
            self._plan(now)

    def _judge_inputs(self) -> None:
        try:
            if self._live is None:
                self._ready()
            else:
                self._pose()  # a planner for what is seen is only made for a goal
        except PlanningFailure as failure:
            self._judge(failure)
        else:
            self.health.set_healthy()

    def _follow(self) -> None:
        """The fast loop, only while a goal is pursued: canceled, arrived, stuck, feedback."""
        pursued = self._pursued
        if pursued is None:
            return
        if self._handle is not None and self._handle.is_cancel_requested:
            self._end(GoalOutcome.CANCELED, "Cancelled.")
            return
        pose, now = self._location.pose(), self.clock.monotonic()
        if pose is None:
            return
        standing = self._standstill.reached(now, self.config.location_timeout)
        if pursued.arrived(pose, standing, now):
            distance, _ = pursued.errors(pose)
            self._end(GoalOutcome.ARRIVED, f"Arrived, {100 * distance:.0f} cm off.")
            return
        self._lead_car(pursued, pose, now, standing=standing)
        elapsed, self._followed = now - self._followed, now
        if self._moved_by or self._waiting:
            pursued.pause(min(elapsed, 2.0 / PROGRESS_RATE))
        stuck = pursued.stuck(pose, now)
        if pursued.patience_used(pose, now) >= 1.0 or stuck:
            self._give_up(pursued, now)
            return
        self._turn += 1
        if self._turn % REPLAN_EVERY == 0:
            self._look_for_hindrance(pursued, pose, now)
            if self._live is not None:
                self._replan(now)
        if self._handle is not None and self._turn % FEEDBACK_EVERY == 0:
            self._handle.publish_feedback(self._feedback(pursued, pose))

    def _lead_car(self, pursued: GoalProgress, pose: Pose2D, now: float, *, standing: bool) -> None:
        """Lead a car anew from the very pose that it has, where its path does not lead it on.

        That is where it has driven all of its path, but for what it cannot put right there; where
        it is so far off it that it could not come back to it; and where it does not get on, by
        whatever has come too close to it. To be led alone is no progress.
        """
        path, planner = pursued.path, self._planner
        if path is None or not isinstance(planner, CarPlanner) or self._moved_by:
            return
        if now - self._failed < RETRY or now - self._led < RETRY:
            return
        ended = standing and math.dist(path[-1, :2], pose[:2]) <= BESIDE
        ahead, radius = pursued.ahead(pose), self.config.described_robot.turning_radius
        if not (ended or pursued.is_hindered) and (
            self._turn % REPLAN_EVERY or not planner.loses(pose, ahead, radius)
        ):
            return
        self._led = now
        try:
            plan = self._find(pursued)
        except PlanningFailure as failure:
            # A path that the body still fits through is better than none.
            if ended or planner.blocked(ahead):
                self._fail(pursued, failure, now)
            return
        pursued.replanned(plan.poses, pose)
        self._drive(plan)

    def _give_up(self, pursued: GoalProgress, now: float) -> None:
        """End a goal that its patience is over with, or that there is no way to."""
        pose = self._location.pose()
        if pursued.path is not None:
            outcome = GoalOutcome.STUCK
            text = f"No progress for {self.config.patience:.0f} s{self._because}."
            self.health.set_fail_algorithm([self.config.chosen_planner], text)
        else:
            outcome = GoalOutcome.BLOCKED if pursued.under_way else GoalOutcome.REFUSED
            text = self._why
        hindered = pose is not None and (pursued.under_way or pursued.is_hindered)
        if pose is not None and hindered:
            self._found = self._hindrance(pursued, pose, now)
            radius = self.config.described_robot.radius
            if self._found.kind != "unknown" or not (self._because and pursued.path is not None):
                text = f"{text} {self._found.told(pose, radius, now)}"
            self._tell_hindrance(pursued, given_up=True)
        self._end(outcome, text, hindered=hindered)

    # -- what is in the way -------------------------------------------------------------------

    def _look_for_hindrance(self, pursued: GoalProgress, pose: Pose2D, now: float) -> None:
        if pursued.is_hindered:
            if self._looking is None:
                self._scout = self._look()
            self._found = self._hindrance(pursued, pose, now)
            self._tell_hindrance(pursued)
        elif self._found is not None:
            self._close_scout()
            self._tell_hindrance(None)

    def _hindrance(self, pursued: GoalProgress, pose: Pose2D, now: float) -> Hindrance:
        return find(
            self._looking,
            self._zones.now,
            pursued.ahead(pose),
            pose,
            self.config.described_robot.radius,
            self._kept / 2,
            self._held_by,
            self._found,
            now,
        )

    def _tell_hindrance(self, pursued: GoalProgress | None, *, given_up: bool = False) -> None:
        """Tell what is in the way, or, without a goal, that nothing is."""
        message = GoalHindrance()
        message.header.frame_id = self.frames.world
        message.header.stamp = self.node.get_clock().now().to_msg()
        found, pose, now = self._found, self._location.pose(), self.clock.monotonic()
        if pursued is None or found is None or pose is None:
            self._found = None
        else:
            radius = self.config.described_robot.radius
            message.patience_used = pursued.patience_used(pose, now)
            message.given_up = given_up
            message.kind, message.text = found.kind, printable(found.told(pose, radius, now))
            message.place = Point(x=found.place[0], y=found.place[1])
            message.distance = found.distance(pose, radius)
            message.direction = found.direction(pose)
            message.lasted = now - found.since
        self._hindrances.publish(message)

    def _close_scout(self) -> None:
        if self._scout is not None:
            self._scout = None
            if not self.config.use_sensor and self._live is None:
                self._look_away()

    def _forget_help(self) -> None:
        """What was done for a goal ends with it."""
        self._close_scout()
        if self._live is not None and not self.config.use_sensor:
            self._live = None
            self._look_away()
            self._clearance, self._planner = None, None
        elif self._clearance is not None:
            self._clearance = self._planner = None

    # -- help, for rules ----------------------------------------------------------------------

    @component_action(active=True)
    def clear_obstacles(self, unseen_for: float = OUT_OF_SIGHT) -> str:
        """Forget what was seen, and what no ray has come to since; the map stays.

        Parameters
        ----------
        unseen_for
            How long nothing must have come to it [s].
        """
        if self._live is None:
            return "it plans on the map alone; there is nothing to forget"
        now = self.clock.monotonic()
        cells = self._live.forget(unseen_for, now)
        if cells and self._pursued is not None and self._pursued.path is None:
            self._plan(now)
        return f"forgot {cells} cells" if cells else "all that it remembers is in sight"

    @component_action(active=True)
    async def replan(self, clearance: float | None = None) -> str | bool:
        """Plan the way to the goal anew, around what the scan shows, until the goal ends.

        A planner that plans on the map alone otherwise looks from then on. The way from before
        stays where there is no other.

        Parameters
        ----------
        clearance
            Between footprint and obstacle [m]; as it was unless given.
        """
        if clearance is not None and not 0.0 <= clearance <= 10.0:
            raise ActionRefused(f"replan: clearance = {clearance} m; give 0 to 10")
        pursued = self._pursued
        if pursued is None:
            return self.fails("no goal is pursued")
        if self._live is None:
            self._scout = self._scout or self._look()
            until = self.clock.monotonic() + FIRST_SCAN
            sensors = self._inputs["sensor_data"]
            while self.clock.monotonic() < until and not all(one.got_msg for one in sensors):
                await self.sleep(0.1)
            if self._pursued is not pursued:
                return self.fails("the goal has ended")
            self._live, self._scout = self._scout, None
        before, self._planner = self._clearance, None
        self._clearance = before if clearance is None else clearance
        try:
            plan = self._find(pursued, narrow=False)
        except PlanningFailure as failure:
            self._clearance, self._planner = before, None
            return self.fails(failure.message)
        self.health.set_healthy()
        pose = self._pose()
        if pursued.path is None:
            pursued.planned(plan.poses, self.clock.monotonic())
        else:
            pursued.replanned(plan.poses, pose)
        self._drive(plan)
        await self._helped(pursued, SET_OFF)
        return f"{plan.length:.1f} m, with {plan.room:.2f} m of room"

    @component_action(active=True)
    async def wait_for_way(self, longest: float = 30.0) -> str | bool:
        """Wait until the robot gets on; the goal is not given up meanwhile.

        Parameters
        ----------
        longest
            When it ends at the latest [s].
        """
        pursued, began = self._pursued, self.clock.monotonic()
        if pursued is None:
            return self.fails("no goal is pursued")
        if await self._helped(pursued, longest):
            return f"it got on after {self.clock.monotonic() - began:.0f} s"
        if self._pursued is not pursued:
            return self.fails("the goal has ended")
        return self.fails(f"nothing has changed in {longest:g} s")

    async def _helped(self, pursued: GoalProgress, longest: float) -> bool:
        """Have the patience stand still until the robot gets on; False when it does not."""
        until = self.clock.monotonic() + longest
        self._waiting += 1
        try:
            while self._pursued is pursued and self.clock.monotonic() < until:
                if not pursued.is_hindered:
                    return True
                await self.sleep(0.2)
        finally:
            self._waiting -= 1
        return False

    def _feedback(self, pursued: GoalProgress, pose: Pose2D) -> PlanPath.Feedback:
        feedback = PlanPath.Feedback(distance_left=pursued.distance_left(pose))
        current = PoseStamped()
        current.header.frame_id = self.frames.world
        current.header.stamp = self.node.get_clock().now().to_msg()
        current.pose.position.x, current.pose.position.y = pose[0], pose[1]
        current.pose.orientation = quaternion_msg(pose[2])
        feedback.current_pose = current
        return feedback

    def _on_check_goal(
        self, request: CheckGoal.Request, response: CheckGoal.Response
    ) -> CheckGoal.Response:
        if not self.is_active:
            response.reason = code_of("no_pose")
            response.message = "The planner is not active; start it first."
            return response
        if fault := pose_fault(request.goal):
            response.reason = code_of("outside_map")
            response.message = fault
            return response
        goal = pose_of(request.goal)
        return check_goal(
            partial(self._ready, goal),
            partial(self._blame_zone, goal=goal),
            *(self.config.described_robot, self._path_msg, request, response),
        )

    def _path_msg(self, poses: Any) -> Path:
        return path_msg(poses, self.frames.world, self.node.get_clock().now().to_msg())
