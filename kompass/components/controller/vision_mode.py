"""The controller follows what a camera's detector sees, for as long as a goal asks for that."""

from collections.abc import Callable
from typing import Any

from kompass_interfaces.action import TrackVisionTarget
from kompass_interfaces.srv import StopVisionTracking
from rclpy.action import CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.task import Future

from kompass.algorithms.following.command import Command
from kompass.algorithms.geometry import Pose2D, compose
from kompass.algorithms.tracking.box import Box
from kompass.algorithms.tracking.camera import depth_of
from kompass.algorithms.tracking.rgb_follower import VisionRGBFollower
from kompass.algorithms.tracking.rgbd_follower import VisionRGBDFollower
from kompass.algorithms.tracking.vision_follower import TrackStep
from kompass.components.base.component import Component
from kompass.components.base.location_source import LocationSource
from kompass.components.base.main_interfaces import ACTION_HOOK, failed_result
from kompass.components.base.people import People
from kompass.components.base.ports import Input
from kompass.components.base.seen import stamp_of
from kompass.components.controller.controllers_id import ControllersID
from kompass.components.controller.detections import boxes_of, camera_of, depths_of
from kompass.components.controller.target_goal import NoTarget, TargetGoal, read_goal
from kompass.printable import printable

DETECTIONS, CAMERA, DEPTH = "vision_detections", "depth_camera_info", "depth_image"
VISION_INPUTS = (DETECTIONS, CAMERA, DEPTH)
NEEDED = {
    ControllersID.VISION_IMG: (DETECTIONS, CAMERA),
    ControllersID.VISION_DEPTH: (DETECTIONS, CAMERA, DEPTH),
}
EXAMPLES = {
    DETECTIONS: "Topic(name='/detections', msg_type='Detection2DArray')",
    CAMERA: "Topic(name='/camera/camera_info', msg_type='CameraInfo')",
    DEPTH: "Topic(name='/camera/depth/image_raw', msg_type='Image')",
}
FEEDBACK = 0.2  # s
LOOK = 0.05  # s between two looks at whether the inputs have come
APART = 0.25  # s between image and depths that count as taken together
MOVES, TURNS = 0.05, 0.1  # m/s and rad/s from which a command is to get the robot somewhere

Outcome = TrackVisionTarget.Result
Tracker = VisionRGBFollower | VisionRGBDFollower


class VisionMode:
    """Action, service and loop of the controller's vision algorithms.

    The action is offered in every mode, and refuses while a path is followed.

    Parameters
    ----------
    controller
        Whose they are.
    names
        Of the action.
    location
        Where the robot is, while the controller is active.
    locate
        Its pose; None, with the reason in the health, when that is unknown or old.
    command
        Sends a command.
    people
        What they did by STOP and the wheel.
    """

    def __init__(
        self,
        controller: Component,
        names: tuple[str, ...],
        *,
        location: Callable[[], LocationSource],
        locate: Callable[[], Pose2D | None],
        command: Callable[[Command], None],
        people: Callable[[], People],
    ) -> None:
        self._controller, self._location, self._locate = controller, location, locate
        self._command, self._people = command, people
        self._tracker: Tracker | None = None
        self._goal: TargetGoal | None = None
        self._problem = ""  # with what was seen last
        node = controller.node
        self._servers = [
            node.create_action_server(
                TrackVisionTarget,
                name,
                self._execute,
                goal_callback=lambda _goal: (
                    GoalResponse.ACCEPT if controller.is_active else GoalResponse.REJECT
                ),
                cancel_callback=lambda _handle: CancelResponse.ACCEPT,
            )
            for name in names
        ]
        node.create_service(
            StopVisionTracking, f"{controller.node_name}/end_vision_tracking", self._on_end
        )

    def use(self, tracker: Tracker | None) -> None:
        """Follow with another algorithm from now on; None while a path is followed."""
        self._tracker = tracker
        if tracker is not None and self._goal is not None:
            _, quest = read_goal(self._goal.handle.request)
            tracker.begin(quest, self._now)

    def listen(self) -> None:
        """Take in what comes; the controller has its inputs."""
        self._input(DETECTIONS).on_message = self._on_detections

    # -- the action ---------------------------------------------------------------------------

    async def _execute(self, handle: ServerGoalHandle) -> TrackVisionTarget.Result:
        controller = self._controller
        for server in self._servers:
            controller.node.executor.create_task(server.expire_goals)
        try:
            result = await self._track(handle)
        except Exception as error:  # noqa: BLE001 - becomes the status, and the result
            controller.on_hook_error(ACTION_HOOK, error)
            result = failed_result(TrackVisionTarget, error)
            if self._goal is not None and self._goal.handle is handle:
                self.end(result.outcome, result.message)
            if handle.is_active:
                handle.abort()
        else:
            controller.on_hook_done(ACTION_HOOK)
        return result

    async def _track(self, handle: ServerGoalHandle) -> TrackVisionTarget.Result:
        """Follow the target of a goal; how that ended."""
        try:
            self._tracker_in_use()
            lock, quest = read_goal(handle.request)
            asked = self._people().interruptions
            await self._inputs_have_come(handle)
            # Last, for all this may have changed while they were waited for.
            refusal = self._people().refusal(self._now)
            if refusal or self._people().came_since(asked):
                raise NoTarget(refusal or "STOP was pressed meanwhile; ask again if it is wanted")
            tracker = self._tracker_in_use()
        except NoTarget as error:
            handle.abort()
            self._controller.warn(f"nothing is followed: {error}")
            return _ended(Outcome.OUTCOME_REFUSED, printable(f"{error}"), 0.0)
        self.end(Outcome.OUTCOME_PREEMPTED, "A newer target took over.")
        ended = Future(executor=self._controller.node.executor)
        self._goal = goal = TargetGoal(handle, lock, ended, self._now)
        tracker.reset()
        tracker.begin(quest, self._now)
        while not ended.done():
            await self._controller.sleep(FEEDBACK)
            if handle.is_cancel_requested and self._goal is goal:
                self.end(Outcome.OUTCOME_CANCELED, "Cancelled.")
        outcome, text = ended.result()
        result = _ended(outcome, text, goal.tracked)
        if result.success:
            handle.succeed()
        elif outcome == Outcome.OUTCOME_CANCELED:
            handle.canceled()
        else:
            handle.abort()
        return result

    def _tracker_in_use(self) -> Tracker:
        if self._tracker is None:
            chosen = " or ".join(one.value for one in NEEDED)
            raise NoTarget(f"the controller follows a path; choose {chosen} with set_algorithm")
        return self._tracker

    async def _inputs_have_come(self, handle: ServerGoalHandle) -> None:
        limit = self._controller.config.topic_subscription_timeout
        until = self._now + limit
        while not handle.is_cancel_requested:
            if not self._controller.is_active:
                raise NoTarget("the controller was deactivated")
            silent = self._silent()
            lost = self._location().pose() is None
            if not silent and not lost:
                return
            if self._now >= until:
                why = "the robot does not know where it is"
                raise NoTarget(f"nothing on {', '.join(silent)} for {limit:g} s" if silent else why)
            await self._controller.sleep(LOOK)

    def _on_end(
        self, request: StopVisionTracking.Request, response: StopVisionTracking.Response
    ) -> StopVisionTracking.Response:
        goal, label = self._goal, request.label.strip()
        if goal is not None and label.casefold() in ("", goal.lock.label.casefold()):
            self.end(Outcome.OUTCOME_ENDED, "Ended by end_vision_tracking.")
            response.success = True
        return response

    def end(self, outcome: int, text: str) -> None:
        """End the goal that is pursued, and stand."""
        goal, self._goal = self._goal, None
        if goal is None:
            return
        if self._controller.is_active:
            self._command(Command())
        self._controller.node.write_log("info", f"{goal.name} is not followed: {text}")
        goal.ended.set_result((outcome, text))

    # -- what is seen -------------------------------------------------------------------------

    def _on_detections(self, message: Any) -> None:
        goal, tracker = self._goal, self._tracker
        info = self._input(CAMERA).message
        if goal is None or tracker is None or info is None:
            return
        self._problem = ""
        box = goal.lock.find(boxes_of(message), self._now)
        if box is None:
            return
        when = self._now - self._input(DETECTIONS).lateness.late
        try:
            if isinstance(tracker, VisionRGBDFollower):
                place = self._place_of(box, message, tracker)
                if place is not None:
                    tracker.see(place, when)
            elif info.width and info.height:
                offset, share = box.offset(info.width), box.share(info.width, info.height)
                tracker.see(offset, share, when)
            else:
                raise ValueError(f"/{self._input(CAMERA).topic.name} tells no size of the image")
        except (ValueError, LookupError) as error:
            self._problem = f"{error}"

    def _place_of(
        self, box: Box, message: Any, tracker: VisionRGBDFollower
    ) -> tuple[float, float] | None:
        """Where on the floor the target is, in the world's frame [m]; None without its depth.

        Raises
        ------
        ValueError, LookupError
            When camera, depths and robot do not tell.
        """
        params, info, depth = tracker.params, self._input(CAMERA).message, self._input(DEPTH)
        image, stamp = depth.message, stamp_of(message)
        camera = camera_of(info)
        if stamp and abs(stamp_of(image) - stamp) > APART:
            return None
        try:
            depths = depths_of(image, params.depth_conversion_factor)
        except ValueError as error:
            raise ValueError(f"/{depth.topic.name}: {error}") from None
        if depths.shape != (camera.height, camera.width):
            raise ValueError(
                f"/{depth.topic.name} has {image.width} × {image.height} pixels and the camera "
                f"{camera.width} × {camera.height}; publish depths that fit the image"
            )
        found = depth_of(box, depths, params.min_depth, params.max_depth)
        if found is None:
            return None
        location = self._location()
        mounting = location.mounting(info.header.frame_id, stamp)
        pose = location.pose_at(stamp)
        if pose is None:
            raise LookupError("the robot does not know where it is")
        in_base = mounting[:3, :3] @ camera.point(box.x, box.y, found) + mounting[:3, 3]
        x, y, _ = compose(pose, (float(in_base[0]), float(in_base[1]), 0.0))
        return float(x), float(y)

    # -- the loop -----------------------------------------------------------------------------

    def step(self) -> None:
        """One turn of the loop."""
        controller, goal, tracker, now = self._controller, self._goal, self._tracker, self._now
        if goal is None or tracker is None:
            controller.health.set_healthy()
            return
        pose = self._locate()
        since, goal.stepped = now - goal.stepped, now
        if pose is None:
            self._command(Command())
            tracker.reset()
            if now - goal.located >= self._config.patience:
                self.end(Outcome.OUTCOME_STUCK, f"{controller.health.message}.")
            return
        goal.located = now
        v, _, omega = self._location().speed()
        blind = self._silent() or ([f"/{self._input(DETECTIONS).topic.name}"] * bool(self._problem))
        period = 1.0 / controller.config.loop_rate
        step = tracker.step(pose, v, omega, now, period, sees=not blind)
        self._command(step.command)
        if step.phase == "following":
            goal.tracked += since
        self._tell(goal, step)
        if blind:
            why = self._problem or f"nothing on {', '.join(blind)}, to see {goal.name} with"
            controller.health.set_fail_system(topics=blind, message=why)
        else:
            why = f"{goal.name} is not in sight"
            controller.health.set_healthy("" if step.phase == "following" else why)
        if step.phase == "lost":
            self.end(Outcome.OUTCOME_LOST, f"For {tracker.limit:g} s, {why}.")
        elif not blind:
            self._judge_progress(goal, step, pose)

    def _judge_progress(self, goal: TargetGoal, step: TrackStep, pose: Pose2D) -> None:
        """Commands that lead nowhere are a failure; they go on, for the way may come free."""
        moves = abs(step.command.vx) > MOVES
        if not moves and abs(step.command.omega) <= TURNS:
            goal.progress.reset()
            return
        stalled, config = goal.progress.stalled(pose, self._now, turning=not moves), self._config
        if stalled >= config.patience:
            self.end(Outcome.OUTCOME_STUCK, f"No progress for {config.patience:g} s.")
        elif stalled >= config.progress_timeout:
            text = f"no progress towards {goal.name} for {stalled:.0f} s"
            self._controller.health.set_fail_algorithm([config.algorithm.value], text)

    def _tell(self, goal: TargetGoal, step: TrackStep) -> None:
        if self._now - goal.told < FEEDBACK:
            return
        goal.told = self._now
        goal.handle.publish_feedback(
            TrackVisionTarget.Feedback(
                distance_error=step.distance_error, orientation_error=step.orientation_error
            )
        )

    def _silent(self) -> list[str]:
        """Topics without which nothing is seen now."""
        limit = self._config.sensor_timeout
        silent = []
        for key in NEEDED.get(self._config.algorithm, ()):
            source = self._input(key)
            # Many publish what the camera is like once.
            if source.message is None or (key != CAMERA and source.age() > limit):
                silent.append(f"/{source.topic.name}")
        return silent

    @property
    def _now(self) -> float:
        return self._controller.clock.monotonic()

    @property
    def _config(self) -> Any:
        return self._controller.config

    def _input(self, key: str) -> Input:
        return self._controller.input(key)


def _ended(outcome: int, text: str, tracked: float) -> TrackVisionTarget.Result:
    success = outcome == Outcome.OUTCOME_ENDED
    return Outcome(success=success, tracked_duration=tracked, outcome=outcome, message=text)
