"""The motion server: drives tests of the base through the gate, and finds how it answers."""

import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from geometry_msgs.msg import Vector3
from kompass_interfaces.action import MotionRecording as RecordingAction
from kompass_interfaces.msg import DriveState
from rclpy.task import Future
from std_msgs.msg import Bool, String

from kompass.algorithms.response import Response
from kompass.components.base.actions import component_action
from kompass.components.base.component import Component
from kompass.components.base.component_config import ComponentRunType
from kompass.components.base.convert import pose_of, speed_of
from kompass.components.base.people import People
from kompass.components.base.ports import Input
from kompass.components.base.robot_limits import velocity_limits
from kompass.components.motion.config import MotionServerConfig
from kompass.components.motion.gate_client import GateClient
from kompass.components.motion.legs import Row, circle_legs, step_legs
from kompass.components.motion.recording import (
    AXES,
    OWN_NAME,
    MotionRecording,
    NotRecorded,
    Triple,
    file_name,
)
from kompass.rclpy_ext.topic import LATCHED, AllowedTopics, Topic
from kompass.settings import notice_once
from kompass.store.errors import StoreUnwritable

FIT = "fit"  # topic <node>/fit
NO_OUTPUT = "robot_command"  # key that older recipes give it
SILENCE = 0.5  # s without odometry, or from a command to what is known of it, that are too long
STAND = 0.5  # s that are recorded before and after a test
LONGEST_RECORDING = 1e3  # s
FEEDBACK = 0.2  # s
TEST = "a test"  # what a recording is for
ANSWER = 10.0  # s beyond a leg's time


class MotionServer(Component):
    """Has a test of the base driven and recorded, and finds gain, time constant and delay.

    A test is driven by the drive manager: within its limits, before its stop zone, and only where
    the room for all of it has been measured. STOP ends it; so does a hand at the wheel, or the
    first command of a goal. What was commanded and measured is kept as a table, and the response of
    each axis is told on ``<node>/fit``, in the log, and to whoever asked.

    As ``Event`` a test begins when ``run_tests`` says true; rules and people begin one with
    :meth:`run_test` in any run type. ``<node>/motion_recording`` records whatever is driven
    meanwhile, and moves nothing. As ``Timed`` it records always, and keeps the stretches of
    ``test_period`` in which the robot was told to move.
    """

    config: MotionServerConfig
    config_class = MotionServerConfig
    needs_robot = True
    asks_for_motion = True
    steps_in_any_run_type = True
    tells_missing_inputs = False
    allowed_run_types = (
        ComponentRunType.TIMED,
        ComponentRunType.EVENT,
        ComponentRunType.ACTION_SERVER,
    )
    allowed_inputs: ClassVar = {
        "run_tests": AllowedTopics(["Bool"]),
        "command": AllowedTopics(["Twist", "TwistStamped"]),
        "location": AllowedTopics(["Odometry"]),
    }
    default_inputs: ClassVar = {
        "run_tests": [Topic(name="/run_tests", msg_type="Bool")],
        "command": [Topic(name="/cmd_vel", msg_type="Twist")],
        "location": [Topic(name="/odom", msg_type="Odometry")],
    }
    main_action_type = RecordingAction

    def __init__(
        self,
        component_name: str = "motion_server",
        *,
        inputs: Mapping[str, Topic | list[Topic]] | Sequence[Topic] | None = None,
        outputs: Mapping[str, Topic | list[Topic]] | Sequence[Topic] | None = None,
        robot_cmd_topic: Topic | None = None,
        robot_odom_topic: Topic | None = None,
        **kwargs: Any,
    ) -> None:
        """As of any component; two inputs may go by the names that older recipes give them.

        Parameters
        ----------
        robot_cmd_topic, robot_odom_topic
            The inputs ``command`` and ``location``.
        outputs
            None but ``robot_command``, which has no effect.
        """
        super().__init__(component_name, inputs=inputs, **kwargs)
        named = {"command": robot_cmd_topic, "location": robot_odom_topic}
        self.inputs(**{key: topic for key, topic in named.items() if topic is not None})
        if outputs is not None and not isinstance(outputs, Mapping):
            raise TypeError(f"{self.node_name}: outputs = {outputs!r}: give topics by key")
        self.outputs(**(outputs or {}))

    def outputs(self, **topics: Topic | list[Topic]) -> None:
        """Refuse all but ``robot_command``: tests are driven by the drive manager alone."""
        if topics.pop(NO_OUTPUT, None) is not None:
            notice_once(
                f"{self.node_name}: {NO_OUTPUT} has no effect; tests are driven by the drive "
                "manager, past which there is no way to the wheels"
            )
        super().outputs(**topics)

    def init_variables(self) -> None:
        self._recording: MotionRecording | None = None
        self._asked_for = ""  # what the recording is for; empty for those of a timed one
        self._gate: GateClient | None = None
        self._last_command: Triple = (0.0, 0.0, 0.0)
        self._people = People()
        self._interrupted = False  # by people, since the test began

    def create_interfaces(self) -> None:
        self._fits = self.node.create_publisher(String, f"{self.node_name}/{FIT}", LATCHED.to_ros())
        self.node.create_subscription(
            DriveState, "drive_state", self._on_drive_state, LATCHED.to_ros()
        )
        self._worker = self.node.threads(1, "motion fit")

    def wants_input(self, key: str) -> bool:
        return key != "run_tests" or self.run_type is ComponentRunType.EVENT

    def custom_on_activate(self) -> None:
        self._gate = GateClient(self.node, self.sleep)
        self.input("command").on_message = self._on_command
        self.input("location").on_message = self._on_location
        self.input("run_tests").on_message = self._on_run_tests

    def custom_on_deactivate(self) -> None:
        if self._asked_for == TEST:
            self.node.executor.create_task(self._call_off)
        self._recording, self._asked_for = None, ""

    async def _call_off(self) -> None:
        assert self._gate is not None
        ended = await self._gate.call("end_leg", ANSWER)
        if not ended.success:
            self.warn(f"the leg of the test is driven to its end: {ended.text}")

    # -- inputs -------------------------------------------------------------------------------

    def _on_drive_state(self, state: DriveState) -> None:
        if self._people.hear(state, self.clock.monotonic(), self.clock.wall()):
            self._interrupted = True

    def _on_command(self, message: Any) -> None:
        twist = getattr(message, "twist", message)
        command = (twist.linear.x, twist.linear.y, twist.angular.z)
        if not all(map(math.isfinite, command)):
            return
        self._last_command = command
        if self._recording is not None:
            self._recording.told(self._when(self.input("command")), command)

    def _on_location(self, message: Any) -> None:
        pose, speed = pose_of(message), speed_of(message)
        if self._recording is not None and all(map(math.isfinite, (*pose, *speed))):
            self._recording.measured(self._when(self.input("location")), pose, speed)

    def _when(self, source: Input) -> float:
        """When it was said what has just come, by its stamp where that can be believed [s]."""
        return self.clock.monotonic() - source.lateness.late

    def _on_run_tests(self, message: Bool) -> None:
        if message.data:
            self.node.executor.create_task(self.run_test)

    # -- the loop -----------------------------------------------------------------------------

    def _execution_step(self) -> None:
        location = self.input("location")
        topic = f"/{location.topic.name}"
        if location.age() <= SILENCE:
            self.health.set_healthy(
                f"{self._asked_for} is under way" if self._asked_for else self._unheard()
            )
        elif self.awaits(location):
            self.health.set_healthy(f"waiting for {topic}")
        else:
            self.health.set_fail_system(topics=[topic], message=location.too_old(SILENCE))
        if self.run_type is ComponentRunType.TIMED and not self._asked_for:
            self._record_always()

    def _record_always(self) -> None:
        now, recording = self.clock.monotonic(), self._recording
        if recording is not None:
            if now - recording.began < self.config.test_period and not recording.is_full:
                return
            self._recording = None
            if recording.has_moved and recording.rows:
                self.node.executor.create_task(self._keep_stretch, recording)
        self._begin_recording(0.0)

    async def _keep_stretch(self, recording: MotionRecording) -> None:
        try:
            await self._judge("recording", recording, self._own_name())
        except NotRecorded as error:
            self.warn(str(error))

    # -- tests --------------------------------------------------------------------------------

    @component_action(active=True)
    async def run_test(
        self, step: bool | None = None, circle: bool | None = None
    ) -> dict[str, Any] | bool:
        """Drive a test of the base, and find how it answers; gives the response of each axis.

        Parameters
        ----------
        step
            Drive each axis alone; as ``run_step_test`` says unless given.
        circle
            Drive arcs; as ``run_circle_test`` says unless given.
        """
        if self._asked_for:
            return self.fails(f"{self._asked_for} is under way")
        legs = self._legs(step, circle)
        if not legs:
            return self.fails("no test is chosen; set run_step_test or run_circle_test")
        problem = self._people.refusal(self.clock.monotonic()) or self._unheard()
        if problem:
            return self.fails(problem)
        name = self._own_name()
        self._asked_for, self._interrupted = TEST, False
        try:
            problem = await self._drive(legs)
            recording, self._recording = self._recording, None
        finally:
            self._recording, self._asked_for = None, ""
        if problem or recording is None:
            return self.fails(f"the test was not driven to its end: {problem or 'it was stopped'}")
        try:
            return await self._judge("test", recording, name)
        except NotRecorded as error:
            return self.fails(str(error))

    def _legs(self, step: bool | None, circle: bool | None) -> list[Row]:
        config, robot = self.config, self.config.described_robot
        limits, seconds = velocity_limits(robot), config.test_period
        legs: list[Row] = []
        if config.run_step_test if step is None else step:
            legs += step_legs(limits, robot.model_type, seconds)
        if config.run_circle_test if circle is None else circle:
            legs += circle_legs(limits, seconds)
        return legs

    def _unheard(self) -> str:
        """Why a test could not be recorded; empty when it can."""
        location, command = self.input("location"), self.input("command")
        if location.age() > SILENCE:
            return location.too_old(SILENCE)
        topic = self.node.resolve_topic_name(command.topic.name)
        infos = self.node.get_publishers_info_by_topic(topic)
        offered = {info.topic_type.rpartition("/")[2] for info in infos}
        if not offered:
            return f"nobody publishes on {topic}, where commands to the wheels are to be heard"
        if command.topic.msg_type not in offered:
            other = " and ".join(sorted(offered))
            return (
                f"{topic} carries {other}, not {command.topic.msg_type}: say "
                f'{self.node_name}.inputs(command=Topic(name="{topic}", msg_type="{other}"))'
            )
        return ""

    async def _drive(self, legs: Sequence[Row]) -> str:
        """Drive legs, recorded; why not all of them, or nothing."""
        gate = self._gate
        assert gate is not None
        looked = await gate.call("room_for", ANSWER, legs=legs)
        if not looked.success:
            return looked.text
        self._begin_recording(0.0)
        await self.sleep(STAND)
        for number, (vx, vy, omega, seconds) in enumerate(legs, start=1):
            if not self.is_active:
                return "the motion server was deactivated"
            if self._interrupted:
                return "a person pressed STOP or took the wheel"
            driven = await gate.call(
                "drive_leg", seconds + ANSWER, vx=vx, vy=vy, omega=omega, seconds=seconds
            )
            if not driven.success:
                return f"leg {number} of {len(legs)}: {driven.text}"
        await self.sleep(STAND)
        return ""

    # -- recordings ---------------------------------------------------------------------------

    def _begin_recording(self, time_step: float) -> None:
        now = self.clock.monotonic()
        self._recording = MotionRecording(now, time_step)
        self._recording.told(now, self._last_command)

    async def main_action_callback(self, goal_handle: Any) -> Any:
        """Record what is driven for a while; see the class."""
        goal, result = goal_handle.request, RecordingAction.Result()
        period, step = goal.recording_period_secs, goal.recording_time_step_secs
        try:
            problem = self._not_recorded(period, step)
            if problem:
                raise NotRecorded(problem)
            name = file_name(goal.csv_file_name) if goal.csv_file_name else self._own_name()
            self._check_location(goal.csv_file_location)
            recording = await self._record(goal_handle, period, step)
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                result.message = "canceled; nothing was kept"
                return result
            told = await self._judge("recording", recording, name)
        except NotRecorded as error:
            result.message = str(error)
            if goal_handle.is_active:
                goal_handle.abort()
            return result
        result.recording_done, result.message = True, json.dumps(told)
        goal_handle.succeed()
        return result

    def _not_recorded(self, period: float, step: float) -> str:
        """Why a recording that is asked for is not made; empty when it is."""
        if not 0.0 < period <= LONGEST_RECORDING:
            return (
                f"recording_period_secs = {period:g}; give more than 0, {LONGEST_RECORDING:g} "
                "at most"
            )
        if not 0.0 < step <= period:
            return (
                f"recording_time_step_secs = {step:g}; give more than 0, and no more than "
                f"recording_period_secs = {period:g}"
            )
        if self._asked_for:
            return f"{self._asked_for} is under way"
        return self._unheard()

    def _check_location(self, location: str) -> None:
        """Refuse to write elsewhere than in the folder of the recordings: anybody may ask."""
        folder = self._folder()
        if location and Path(location).expanduser().absolute() != folder:
            raise NotRecorded(
                f"csv_file_location = {location!r}: recordings are kept in {folder} only; leave it "
                "empty, or set tests_folder"
            )

    async def _record(self, goal_handle: Any, period: float, step: float) -> MotionRecording:
        self._asked_for = "a recording"
        try:
            self._begin_recording(step)
            recording = self._recording
            assert recording is not None
            end = recording.began + period
            while self.clock.monotonic() < end and not recording.is_full:
                if not self.is_active:
                    raise NotRecorded("the motion server was deactivated; nothing was kept")
                if goal_handle.is_cancel_requested:
                    break
                goal_handle.publish_feedback(self._feedback())
                await self.sleep(min(FEEDBACK, max(0.01, end - self.clock.monotonic())))
            return recording
        finally:
            self._recording, self._asked_for = None, ""

    def _feedback(self) -> Any:
        feedback, message = RecordingAction.Feedback(), self.input("location").fields
        if message is not None:
            x, y, feedback.heading = pose_of(message)
            feedback.position = Vector3(x=x, y=y)
        vx, vy, omega = self._last_command
        feedback.cmd = Vector3(x=vx, y=vy, z=omega)
        return feedback

    def _own_name(self) -> str:
        now = time.gmtime(self.clock.wall())
        part = int(1e3 * (self.clock.wall() % 1.0))
        return f"{OWN_NAME}{time.strftime('%Y%m%d-%H%M%S', now)}-{part:03d}"

    def _folder(self) -> Path:
        try:
            return self.config.folder
        except StoreUnwritable as error:
            raise NotRecorded(str(error)) from None

    async def _judge(self, what: str, recording: MotionRecording, name: str) -> dict[str, Any]:
        """Keep a recording, and tell how the base answers by it; what is told.

        Raises
        ------
        NotRecorded
            When it cannot be kept.
        """
        folder, most = self._folder(), self.config.most_recordings
        path = await self._by_worker(lambda: recording.write(folder, name, most))
        found, none = await self._by_worker(recording.responses)
        told = self._told(what, path, found, none)
        log = self.node.get_logger()
        log.info(f"{what}: {recording.rows} readings are in {path}")
        for axis, one in told["axes"].items():
            log.info(
                f"{axis}: gain {one['gain']:.3f}, time constant {one['time_constant']:.3f} s, "
                f"delay {one['delay']:.3f} s, residual {one['residual']:.4f}"
            )
        self._fits.publish(String(data=json.dumps(told)))
        return told

    def _told(
        self, what: str, path: Path, found: Mapping[str, Response], none: Mapping[str, str]
    ) -> dict[str, Any]:
        """What is said of a recording: plain, so that JSON carries it."""
        limits = velocity_limits(self.config.described_robot)
        axes = {}
        for axis in AXES:
            if axis not in found:
                continue
            response, limit = found[axis], getattr(limits, axis)
            axes[axis] = {
                "gain": round(response.gain, 4),
                "time_constant": round(response.time_constant, 4),
                "delay": round(response.delay, 4),
                "residual": round(response.residual, 5),
                "explained": round(response.explained, 4),
                "max_decel": round(response.deceleration(limit.max_vel, limit.max_decel), 3),
            }
        return {"of": what, "file": str(path), "axes": axes, "not_fitted": dict(none)}

    async def _by_worker(self, work: Callable[[], Any]) -> Any:
        """What something gives that takes its time."""
        executor = self.node.executor
        done = Future(executor=executor)

        def run() -> None:
            try:
                made = work()
            except Exception as error:  # noqa: BLE001 - raised where it is awaited
                executor.create_task(done.set_exception, error)
            else:
                executor.create_task(done.set_result, made)

        self._worker.submit(run)
        return await done
