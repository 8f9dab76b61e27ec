"""The drive manager: the last gate before the wheels, and short motions that free the robot."""

import math
import secrets
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point32, PolygonStamped, Twist, TwistStamped
from kompass_interfaces.msg import DriveState, HandCommand, TwistArray
from kompass_interfaces.srv import ReleaseStop, StopRobot, TakeWheel
from numpy.typing import NDArray
from rclpy.duration import Duration
from rclpy.task import Future
from std_msgs.msg import Bool, String

from kompass.access.gatekeeper import UNSIGNED_HAND, NotAdmitted
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import inverse, transform_points
from kompass.algorithms.safety.pose_jumps import PoseJumps
from kompass.algorithms.safety.rhythm import Rhythm
from kompass.algorithms.safety.standstill import Standstill
from kompass.algorithms.safety.sweep import time_to_contact
from kompass.components.base.actions import ActionRefused, component_action
from kompass.components.base.component import Component
from kompass.components.base.component_config import ComponentRunType
from kompass.components.base.convert import pose_of
from kompass.components.base.location_source import LocationSource
from kompass.components.base.ports import Input
from kompass.components.base.robot_limits import motion_model, velocity_limits
from kompass.components.base.seen import MOST_SENSORS, SENSOR_INPUTS
from kompass.components.base.zones_heard import ZonesHeard
from kompass.components.drive.command_queue import STILL, CommandQueue, Twist2D
from kompass.components.drive.config import DriveManagerConfig
from kompass.components.drive.drive_gate import KEEP_OUT, SPEED, DriveGate, GateInput, GateLimits
from kompass.components.drive.halt import HALT_NODE
from kompass.components.drive.leg import Leg, least_gap, read_legs, swept
from kompass.components.drive.manoeuvre import (
    Manoeuvre,
    free_way,
    open_turn,
    widest_turn,
)
from kompass.components.drive.publisher_watch import PublisherWatch, WatchedTopic
from kompass.components.drive.sensor_watch import SensorWatch, told_for
from kompass.components.drive.stop_file import StopFile, StopKeeper, stop_path
from kompass.components.drive.stop_latch import StopLatch
from kompass.components.drive.wheel import LAPSE, LOOK, Wheel
from kompass.components.drive.zones_file import keep_zones, load_zones, zones_path
from kompass.printable import printable
from kompass.rclpy_ext.deferred_service import create_deferred_service
from kompass.rclpy_ext.topic import LATCHED, SENSOR, AllowedTopics, Topic
from kompass.robot import RobotType
from kompass.store.errors import StoreUnwritable
from kompass.store.paths import robot_folder
from kompass.zones.mask import MasksNow

EMERGENCY_PERIOD = 0.5  # s between repetitions of an unchanged emergency flag
STATE_PERIOD = 0.2  # s
MASKS = "masks"  # topic, for who draws them
RELEASE_STOP = "release_stop"  # name of the service
TAKE_WHEEL, HAND = "take_wheel", "hand"  # names of the service, and of the topic of commands
IGNORED_PERIOD = 5.0  # s between two lines on commands of a hand that were not obeyed
SHARE_OF_TOP_SPEED = 0.5
MARGIN = 0.03  # m to stay outside the critical zone, so that the way out does not end in it
BEHIND = math.radians(60.0)  # to either side, that the scanner must see for a way back
USEFUL = 0.05  # m; a shorter way frees nothing
HELD = 0.7  # s of being held back after which it is given up; a late scan passes sooner
LONGEST_NAME = 40  # characters of who pressed STOP, in the log
REST = 1.0  # s at most for the robot to come to rest
DISK_RETRY = 5.0  # s after which a disk that could not be written is tried again
SLOW_DISK = 0.7  # s; a release that is not on disk by then is answered all the same
NO_TURN = "a robot with steered wheels cannot turn on the spot"
LATE = 0.3  # s in which commands of somebody who is lost may still come in


class DriveManager(Component):
    """Takes commands, gives the wheels only what is safe now, and says what held it back.

    Its loop runs whether or not commands flow. STOP is a service of its own; it is latched, no rule
    or component can reset it, and it survives the death of this process and of the whole stack.

    When one that sends it commands dies or hangs, it halts at once.

    ``emergency_stop`` is a level: true while a wanted motion is fully blocked by the stop zone, or,
    with none wanted, something is inside the critical zone the way that the robot went last; false
    again by itself.

    Its actions are motions for rules: measured by odometry, bounded in time, within the limits.
    While one runs, commands of others are ignored. STOP ends it, and refuses the next one. The
    stop zone counts as for any motion: what leads away from an obstacle is allowed. A leg of a
    test of the base is the one motion that gives way: it ends at the first command of another.

    A person who has taken the wheel drives by hand, through the same gate: no other command counts
    meanwhile, and no motion of rules begins. Without a command for 0.25 s the robot stands.
    """

    config: DriveManagerConfig
    config_class = DriveManagerConfig
    needs_robot = True
    stops_robot = True
    steps_in_any_run_type = True
    allowed_run_types = (ComponentRunType.TIMED, ComponentRunType.EVENT)
    tells_missing_inputs = False
    allowed_inputs: ClassVar = {
        "command": AllowedTopics(["Twist"]),
        "multi_command": AllowedTopics(["TwistArray"]),
        "sensor_data": AllowedTopics(SENSOR_INPUTS, 1, MOST_SENSORS),
        "location": AllowedTopics(["Odometry"]),
    }
    allowed_outputs: ClassVar = {
        "robot_command": AllowedTopics(["Twist", "TwistStamped"]),
        "emergency_stop": AllowedTopics(["Bool"]),
    }
    default_inputs: ClassVar = {
        "command": [Topic(name="/control", msg_type=Twist)],
        "multi_command": [Topic(name="/control_list", msg_type=TwistArray)],
        "sensor_data": [Topic(name="/scan", msg_type="LaserScan")],
        "location": [Topic(name="/odom", msg_type="Odometry")],
    }
    default_outputs: ClassVar = {
        "robot_command": [Topic(name="/cmd_vel", msg_type=Twist)],
        "emergency_stop": [Topic(name="/emergency_stop", msg_type=Bool)],
    }

    def __init__(self, component_name: str = "drive_manager", **kwargs: Any) -> None:
        super().__init__(component_name, **kwargs)
        self._latch = StopLatch()
        self._keeper: StopKeeper | None = None
        self._zones_path: Path | None = None

    def init_variables(self) -> None:
        self._queue = CommandQueue(self.config.command_timeout)
        self._deaf_until = -float("inf")
        # Without a robot it is not configured, and can be told to halt, and nothing else.
        self._gate = None if self.lacks_robot else DriveGate(self._gate_limits())
        self._standstill = Standstill()
        self._odometries = Rhythm()
        self._jumps = PoseJumps()
        self._sensors = [
            SensorWatch(
                partial(self.input, "sensor_data", index),
                lambda: self._location,
                lambda: self.config,
            )
            for index, _ in enumerate(self._topics_in["sensor_data"])
        ]
        self._told_of_clock: set[str] = set()
        self._location_fault = ""  # of the newest message
        self._emergency = False
        self._emergency_sent = -float("inf")
        self._state = DriveState(speed_factor=1.0)
        self._told: dict[str, Any] = {}
        self._state_sent = -float("inf")
        self._busy = ""
        self._held_since: float | None = None
        self._manoeuvre: Manoeuvre | Leg | None = None
        self._ended: Future | None = None
        self._wheel = Wheel()
        self._is_cut = False  # and the wheels have been told
        self._ignored, self._ignored_told = 0, -float("inf")

    def _gate_limits(self) -> GateLimits:
        config, robot = self.config, self.config.described_robot
        return GateLimits(
            velocity=velocity_limits(robot),
            radius=robot.radius,
            footprint=Footprint(robot.footprint),
            motion=motion_model(robot),
            critical_distance=config.critical_zone_distance,
            slowdown_distance=config.slowdown_zone_distance,
            odometry_timeout=config.odometry_timeout,
            period=1.0 / config.loop_rate,
            safety_stop=not config.disable_safety_stop,
            needs_scan=not config.use_without_scan_sensor,
        )

    def on_config_changed(self, names: set[str]) -> None:
        assert self._gate is not None
        self._take_masks()
        self._gate.set_limits(self._gate_limits())
        self._queue.timeout = self.config.command_timeout
        for sensor in self._sensors:
            sensor.forget_settings()

    def create_interfaces(self) -> None:
        self._state_publisher = self.node.create_publisher(
            DriveState, "drive_state", LATCHED.to_ros()
        )
        self._footprint_publisher = self.node.create_publisher(
            PolygonStamped, "footprint", LATCHED.to_ros()
        )
        name = self.node_name
        self.node.create_service(StopRobot, f"{name}/stop", self._on_stop)
        create_deferred_service(
            self.node, ReleaseStop, f"{name}/{RELEASE_STOP}", self._on_release, _not_released
        )
        self.node.create_service(TakeWheel, f"{name}/{TAKE_WHEEL}", self._on_wheel)
        self.node.create_subscription(HandCommand, f"{name}/{HAND}", self._on_hand, SENSOR.to_ros())
        self._masks_publisher = self.node.create_publisher(String, MASKS, LATCHED.to_ros())
        self._restore_stop()
        self._zones = ZonesHeard(self.node, self._keep_zones)
        self._restore_zones()

    def custom_on_activate(self) -> None:
        self._take_masks()
        self._location = LocationSource(self)
        self._watch = PublisherWatch(self.node, self._watched_topics)
        self.input("command").on_message = self._on_command
        self.input("multi_command").on_message = self._on_commands
        self.input("location").on_message = self._on_location
        for sensor in self._sensors:
            sensor.source.on_message = partial(self._on_seen, sensor)
        footprint = PolygonStamped()
        footprint.header.frame_id = self.frames.robot_base
        footprint.polygon.points = [
            Point32(x=float(x), y=float(y)) for x, y in self.config.described_robot.footprint
        ]
        self._footprint_publisher.publish(footprint)
        self._hand_look = self.create_timer(LOOK, self._look_at_hand)
        self._hand_look.cancel()

    def custom_on_deactivate(self) -> None:
        self._give_wheel("the drive manager was deactivated")
        self._finish("the drive manager was deactivated")
        # The robot halts with the gate: this may be the last word that the wheels get.
        self._send_halt()
        for publisher in self._outputs["robot_command"]:
            publisher.wait_for_all_acked(Duration(seconds=0.2))
        self._location.close()

    def custom_on_shutdown(self) -> None:
        if self._keeper is not None:
            self._keeper.close()
            self._keeper = None

    def on_feeder_lost(self, reason: str) -> None:
        if isinstance(self._manoeuvre, Leg):
            self._finish(reason)
        # Commands that were under way when it was lost come in after its loss is told.
        self._deaf_until = self.clock.monotonic() + LATE
        self._queue.clear()
        if not (self._busy or self._wheel.driver):  # who moves by itself or by hand needs nobody
            self._send_halt()
            self.node.write_log("warning", f"halted: {reason}")

    # -- STOP ---------------------------------------------------------------------------------

    def _on_stop(
        self, request: StopRobot.Request, response: StopRobot.Response
    ) -> StopRobot.Response:
        operator = printable(request.operator_name, LONGEST_NAME) or "somebody"
        self._latch.set(operator, request.reason, self.clock.wall())
        self._wheel.let_go()
        self._halt()
        self._keep_stop()
        self._publish_state(self.clock.monotonic(), "stop", 0.0)
        reason = printable(request.reason) or "no reason given"
        self.node.write_log("warning", f"STOP by {operator}: {reason}")
        response.success = True
        response.message = "stopped; a person must release it"
        return response

    async def _on_release(
        self, request: ReleaseStop.Request, response: ReleaseStop.Response
    ) -> ReleaseStop.Response:
        operator = printable(request.operator_name, LONGEST_NAME) or "somebody"
        service = f"{self.node_name}/{RELEASE_STOP}"
        try:
            verified = self._gatekeeper.admit(service, request, who=operator)
        except NotAdmitted as error:
            response.message = str(error)
            return response
        presses = self._latch.presses
        problem = await self._keep_release()
        if self._latch.presses != presses:
            response.message = "STOP was pressed again meanwhile"
            return response
        response.success = True
        response.message = "released" if self._latch.is_set else "it was not stopped"
        if problem:
            # Whoever released it is there, and must get the robot out of the way; what is not on
            # disk errs to the safe side.
            response.message += f", but it may come up stopped when it is started anew: {problem}"
        # Commands from before the release are not carried out after it.
        self._queue.clear()
        self._wheel.let_go()
        self._latch.release()
        self._publish_state(self.clock.monotonic(), "", 1.0)
        by = operator if verified else f"{operator} (unverified)"
        self.node.write_log("warning", f"STOP released by {by}")
        return response

    def _restore_stop(self) -> None:
        """Come up as the robot was: stopped, when nobody has released it."""
        log = self.node.get_logger()
        try:
            file = StopFile(stop_path(robot_folder(), self.node_name))
        except StoreUnwritable as error:
            self._latch.load(None)
            log.error(f"STOP is not kept over a restart of the whole stack: {error}")
            return
        self._keeper = StopKeeper(
            file,
            self.node.threads(1, "stop file"),
            lambda problem: log.error(f"STOP is not kept as it is over a restart: {problem}"),
        )
        self.node.create_timer(DISK_RETRY, self._keeper.retry)
        if not self._latch.is_loaded:
            self._latch.load(file.load())
            if self._latch.is_set:
                log.warning(f"STOP by {self._latch.operator}: {self._latch.account}")
            else:
                # The file is there before it is needed: room for it may be scarce then.
                self._keeper.keep(None)
        if self._latch.is_set:
            self._keep_stop()

    def _keep_stop(self) -> None:
        if self._keeper is not None:
            self._keeper.keep(self._latch.record)

    async def _keep_release(self) -> str:
        """Until the release is on disk; what is wrong when it is not."""
        if self._keeper is None:
            return ""
        executor = self.node.executor
        done = Future(executor=executor)

        def finish(problem: str) -> None:
            if not done.done():
                done.set_result(problem)

        timer = self.node.create_timer(
            SLOW_DISK, lambda: finish(f"the disk has not answered for {SLOW_DISK:g} s")
        )
        self._keeper.keep(None, lambda problem: executor.create_task(finish, problem))
        try:
            return str(await done)
        finally:
            self.node.destroy_timer(timer)

    # -- zones --------------------------------------------------------------------------------

    def _restore_zones(self) -> None:
        """Come up with the zones of before: the monitor may be starting, too, or dead."""
        log, kept = self.node.get_logger(), None
        self._zones_writer = self.node.threads(1, "zones file")
        try:
            self._zones_path = zones_path(robot_folder(), self.node_name)
            kept = load_zones(self._zones_path)
        except (StoreUnwritable, ValueError) as error:
            log.error(f"zones do not count before the monitor has told them: {error}")
        if kept is not None and self._zones.told is None:
            self._zones.set(kept)

    def _keep_zones(self) -> None:
        path, told, log = self._zones_path, self._zones.told, self.node.get_logger()
        if path is None or told is None:
            return

        def keep() -> None:
            try:
                keep_zones(path, told)
            except OSError as error:
                log.error(f"the zones are not kept over a restart: {error}")

        self._zones_writer.submit(keep)

    def _take_masks(self) -> None:
        """Put the masks into force, and tell who draws them."""
        masks = self.config.masks_in_force()
        self._zones.mask_with(masks)
        publish, executor = self._masks_publisher.publish, self.node.executor

        def tell() -> None:
            marks = tuple(mark for mask in masks for mark in mask.marks())
            text = MasksNow(masks=marks).model_dump_json()
            executor.create_task(publish, String(data=text))

        self._zones_writer.submit(tell)

    def _in_zones(self, given: GateInput) -> GateInput:
        """What is known of this turn, with what the zones forbid where the robot is."""
        zones, robot = self._zones.now, self.config.described_robot
        if not zones:
            return given
        pose = self._location.pose()
        if pose is None:
            return replace(given, edges=None)
        limits = velocity_limits(robot)
        decel, top = limits.vx.max_decel, max(limits.vx.max_vel, limits.vy.max_vel)
        reach = robot.radius + self.config.slowdown_zone_distance + 0.2 * top + top**2 / 2 / decel
        limit = zones.limit(pose[0], pose[1], robot.radius, decel)
        edges = transform_points(inverse(pose), zones.in_the_way(pose[0], pose[1], reach))
        if limit is None:
            return replace(given, edges=edges)
        kind = KEEP_OUT if limit.zone.kind == "keep_out" else SPEED
        return replace(given, edges=edges, fastest=limit.speed, slowed_by=kind)

    def _halt(self) -> None:
        self._queue.clear()
        self._send_halt()

    def _send_halt(self) -> None:
        if self._gate is not None:
            self._gate.halted()
        self._send(STILL)

    # -- by hand ------------------------------------------------------------------------------

    def _on_wheel(
        self, request: TakeWheel.Request, response: TakeWheel.Response
    ) -> TakeWheel.Response:
        operator = printable(request.operator_name, LONGEST_NAME) or "somebody"
        try:
            service = f"{self.node_name}/{TAKE_WHEEL}"
            if not self._gatekeeper.admit(service, request, who=operator):
                # Commands are signed with a key that is made of the robot's.
                raise NotAdmitted(UNSIGNED_HAND)
        except NotAdmitted as error:
            response.message = str(error)
            return response
        wheel = self._wheel
        if request.what == TakeWheel.Request.GIVE:
            response.success = True
            response.message = "the wheel is free"
            if request.session != wheel.session:
                response.message = "somebody else has the wheel" if wheel.driver else "it was free"
            elif wheel.driver:
                self._give_wheel("given up")
            return response
        problem = self._not_taken(request)
        if problem:
            response.message = problem
            return response
        seed, session = secrets.token_hex(16), request.session
        before = wheel.driver
        signed = self._gatekeeper.session_key(session, seed).has_signed
        wheel.take(operator, session, signed, self.clock.monotonic())
        self._latch.interrupt()
        self._finish(f"{operator} took the wheel")
        self._halt()
        self._hand_look.reset()
        self._publish_wheel()
        over = f" over from {before}" if before else ""
        self.node.write_log("warning", f"{operator} took the wheel{over}")
        limits = velocity_limits(self.config.described_robot)
        response.success, response.seed = True, seed
        response.max_vx, response.max_omega = limits.vx.max_vel, limits.omega.max_vel
        response.max_vy = limits.vy.max_vel if self._slides else 0.0
        return response

    def _not_taken(self, request: TakeWheel.Request) -> str:
        """Why somebody does not get the wheel; empty when he does."""
        if not self.is_active:
            return "the drive manager is not active; start it first"
        if not request.session:
            return "session = '': name a random word, of which the key of the commands is made"
        holder = self._wheel.driver
        others = holder and request.session != self._wheel.session
        if others and request.what != TakeWheel.Request.TAKE_OVER:
            return f"{holder} drives by hand; ask for the wheel, or have an engineer take it over"
        return ""

    @property
    def _slides(self) -> bool:
        """Whether the robot can go sideways."""
        return bool(self.config.described_robot.model_type is RobotType.OMNI)

    def _give_wheel(self, why: str) -> None:
        """Nobody drives by hand any more; the robot stands."""
        driver = self._wheel.driver
        if not driver:
            return
        self._wheel.give()
        self._hand_look.cancel()
        # What somebody commanded while the wheel was held may still be under way.
        self._deaf_until = self.clock.monotonic() + LATE
        self._halt()
        self._publish_wheel()
        self.node.write_log("warning", f"{driver} does not drive by hand any more: {why}")

    def _publish_wheel(self) -> None:
        self._publish_state(
            self.clock.monotonic(), self._state.limited_by, self._state.speed_factor
        )

    def _on_hand(self, command: HandCommand) -> None:
        now = self.clock.monotonic()
        problem = self._wheel.hear(command, now)
        if not problem:
            return
        self._ignored += 1
        if now - self._ignored_told >= IGNORED_PERIOD:
            more = f" (and {self._ignored - 1} before it)" if self._ignored > 1 else ""
            self.node.write_log("warning", f"a command by hand is not obeyed: {problem}{more}")
            self._ignored, self._ignored_told = 0, now

    def _look_at_hand(self) -> None:
        """More often than the loop turns: what the hand does not renew ends in time."""
        now = self.clock.monotonic()
        if self._wheel.has_lapsed(now):
            self._give_wheel(f"nothing was heard for {LAPSE:g} s")
        elif self._wheel.is_cut(now) and not self._is_cut:
            self._send_halt()
        self._is_cut = self._wheel.is_cut(now)

    def _by_hand(self, now: float) -> Twist2D | None:
        wanted = self._wheel.wanted(now)
        return wanted if wanted is None or self._slides else (wanted[0], 0.0, wanted[2])

    # -- inputs -------------------------------------------------------------------------------

    @property
    def _is_deaf(self) -> bool:
        """Whether commands of others do not count now."""
        by_itself = self._busy or self._wheel.driver
        return bool(by_itself) or self.clock.monotonic() < self._deaf_until

    def _on_command(self, message: Twist) -> None:
        command = (message.linear.x, message.linear.y, message.angular.z)
        if self._is_deaf:
            self._give_way(any(command))
            return
        try:
            self._queue.put([command], 0.0, self.clock.monotonic())
        except ValueError as error:
            self._refuse_command("command", error)

    def _on_commands(self, message: TwistArray) -> None:
        if self._is_deaf:
            linear, angular = message.linear_velocities, message.angular_velocities
            self._give_way(any((*linear.x, *linear.y, *angular.z)))
            return
        try:
            self._queue.put_array(message, self.clock.monotonic())
        except ValueError as error:
            self._refuse_command("multi_command", error)

    def _give_way(self, moves: bool) -> None:
        """End a leg of a test where somebody else wants the robot to move."""
        if moves and isinstance(self._manoeuvre, Leg):
            self._finish("somebody else drives the robot: a goal, or another program")

    def _refuse_command(self, key: str, error: ValueError) -> None:
        self.warn(f"/{self.input(key).topic.name}: a command is not carried out: {error}")

    def _watched_topics(self) -> list[WatchedTopic]:
        """The topics on which nobody, or nobody else, may speak."""
        own = frozenset({self.node_name, HALT_NODE})
        most = self.config.command_publishers
        heard = [self.input(key).topic.name for key in ("command", "multi_command")]
        return [
            *(WatchedTopic(topic.name, own) for topic in self._topics_out["robot_command"]),
            *(WatchedTopic(name, others=most) for name in heard),
        ]

    def _tell_of_clocks(self) -> None:
        """Say once of each source that its stamps cannot be believed."""
        for source in (*self._inputs["sensor_data"], self.input("location")):
            note, topic = source.lateness.note, source.topic.name
            if note and topic not in self._told_of_clock:
                self._told_of_clock.add(topic)
                self.node.write_log("warning", f"/{topic}: {note}")

    def _on_location(self, _message: object) -> None:
        now = self.clock.monotonic()
        self._odometries.heard(now)
        self._location_fault = self._location.fault()
        if not self._location_fault:
            pose = pose_of(self.input("location").fields)
            self._jumps.heard(pose, now, self.config.odometry_jump)
            self._location_fault = self._jumps.told
        if not self._location_fault:
            self._standstill.update(self._location.speed(), now)

    def _on_seen(self, sensor: SensorWatch, message: Any) -> None:
        sensor.hear(message, self.clock.monotonic())

    def _overdue(self, source: Input, rhythm: Rhythm, timeout: float) -> bool:
        """Whether the robot is not to drive by the newest message of an input any more.

        Health waits for the timeout: a machine that is busy for a moment is no failure.
        """
        return source.silence() > rhythm.patience(self.config.missed_messages, timeout)

    def _obstacles(self) -> NDArray[np.float64] | None:
        """What is in the way, in the robot's frame, shape (N, 2); None when unknown."""
        now = self.clock.monotonic()
        seen = {sensor: sensor.points(now, self.warn) for sensor in self._sensors}
        return self._together({one: points for one, points in seen.items() if points is not None})

    def _together(
        self, seen: Mapping[SensorWatch, NDArray[np.float64]]
    ) -> NDArray[np.float64] | None:
        """What the sensors show; None when one shows nothing and it may not drive without."""
        enough = len(seen) == len(self._sensors) or self.config.use_without_scan_sensor
        if not (seen and enough):
            return None
        points = list(seen.values())
        return points[0] if len(points) == 1 else np.concatenate(points)

    # -- the loop -----------------------------------------------------------------------------

    def _execution_step(self) -> None:
        try:
            self._turn(self.clock.monotonic())
        except Exception:
            self._halt()
            raise

    def _turn(self, now: float) -> None:
        self._look_at_hand()  # who was held up may come here first
        wanted = self._wanted(now)
        seen = [(sensor, sensor.points(now, self.warn)) for sensor in self._sensors]
        blind = [sensor for sensor, points in seen if points is None]
        odometry_age = math.inf if self._location_fault else self.input("location").age()
        intruders = self._watch.intruders(now)
        if intruders:
            self._queue.clear()  # nor is what they commanded carried out once they have gone
            self._judge_intruders(intruders)
        else:
            self._judge_health(blind, odometry_age <= self.config.odometry_timeout)
        self._tell_of_clocks()
        if self._latch.is_set:
            self._queue.clear()
            self._wheel.let_go()
        odometry = self.input("location")
        timeout = self.config.scan_timeout
        known = {
            sensor: points
            for sensor, points in seen
            if points is not None and not self._overdue(sensor.source, sensor.rhythm, timeout)
        }
        if self._overdue(odometry, self._odometries, self.config.odometry_timeout):
            odometry_age = math.inf
        given = GateInput(
            wanted=wanted,
            command_stale=self._queue.is_stale(now) or self._wheel.is_cut(now),
            obstacles=self._together(known),
            odometry_age=odometry_age,
            stopped=self._latch.is_set,
            intruded=bool(intruders),
        )
        assert self._gate is not None
        verdict = self._gate.judge(self._in_zones(given), now)
        if verdict.twist is not None:
            self._send(self._worth_sending(verdict.twist))
        self._publish_emergency(now, verdict.emergency)
        self._judge_manoeuvre(verdict.factor, verdict.limited_by)
        if not verdict.limited_by and self._wheel.is_kept_back(now):
            self._publish_state(now, "let go first", 0.0)
        else:
            self._publish_state(now, verdict.limited_by, verdict.factor)

    def _wanted(self, now: float) -> Twist2D | None:
        """The twist asked for at this moment, by hand, by others or by the motion under way."""
        if self._wheel.driver:
            return self._by_hand(now)
        if not self._busy:
            return self._queue.current(now)
        if self._manoeuvre is None:
            return None
        pose = self._location.pose()
        if pose is None:
            self._finish("the robot does not know where it is")
            return None
        twist = self._manoeuvre.step(pose, now)
        if twist is None:
            self._finish("")
        elif self._manoeuvre.overdue(now):
            self._finish(f"it did not get there in time, {self._manoeuvre.done:.2f} done")
            return None
        return twist

    def _judge_manoeuvre(self, factor: float, limited_by: str) -> None:
        """Give up a motion that is held back for long, or by STOP."""
        if self._manoeuvre is None or factor > 0.0:
            self._held_since = None
            return
        now = self.clock.monotonic()
        self._held_since = now if self._held_since is None else self._held_since
        if limited_by == "stop":
            self._finish("STOP is pressed")
        elif now - self._held_since >= HELD:
            self._finish(f"held back: {limited_by}")

    def _send(self, command: Twist2D) -> None:
        twist = Twist()
        twist.linear.x, twist.linear.y, twist.angular.z = (float(value) for value in command)
        for index, topic in enumerate(self._topics_out["robot_command"]):
            if topic.ros_msg_type is TwistStamped:
                message = TwistStamped(twist=twist)
                message.header.stamp = self._stamp()
                message.header.frame_id = self.frames.robot_base
                self.publish("robot_command", message, index)
            else:
                self.publish("robot_command", twist, index)

    def _worth_sending(self, twist: Twist2D) -> Twist2D:
        """A twist without what is slower than the base can drive: ``min_absolute_val``."""
        robot = self.config.described_robot
        axes = (robot.ctrl_vx_limits, robot.ctrl_vy_limits, robot.ctrl_omega_limits)
        vx, vy, omega = (
            value if abs(value) >= axis.min_absolute_val else 0.0
            for value, axis in zip(twist, axes, strict=True)
        )
        return vx, vy, motion_model(robot).turn(vx, omega)

    def _judge_intruders(self, intruders: Mapping[str, tuple[str, ...]]) -> None:
        texts = [f"{' and '.join(nodes)} on /{topic}" for topic, nodes in intruders.items()]
        self.health.set_fail_system(
            topics=[f"/{topic}" for topic in intruders],
            message=f"others publish past the gate or before it: {'; '.join(texts)}",
        )

    def _judge_health(self, blind: list[SensorWatch], odometry_known: bool) -> None:
        odometry = self.input("location")
        missing = {}
        if not (self.config.disable_safety_stop or self.config.use_without_scan_sensor):
            for sensor in blind:
                name = f"/{sensor.source.topic.name}" if len(self._sensors) > 1 else ""
                missing[sensor.source] = sensor.missing(name)
        if not odometry_known:
            missing[odometry] = self._missing_odometry()
        topics = [f"/{source.topic.name}" for source in missing]
        if not missing:
            self.health.set_healthy()
        elif self.is_starting and not any(self._has_served(source) for source in missing):
            self.health.set_healthy(f"waiting for {', '.join(topics)}")
        else:
            self.health.set_fail_system(topics=topics, message="; ".join(missing.values()))

    def _missing_odometry(self) -> str:
        """Why the odometry is of no use, for people."""
        source = self.input("location")
        if source.age() > self.config.odometry_timeout:
            if not source.comes_late:
                return f"no odometry {told_for(source.silence())}"
            return f"the odometry is too old: {source.lateness.told}"
        if self._location_fault:
            return f"the odometry cannot be used: {self._location_fault}"
        return "no odometry that can be used"

    def _has_served(self, source: Input) -> bool:
        """Whether an input has been of use since the activation; a sensor needs its transform."""
        used = {sensor.source: sensor.has_served for sensor in self._sensors}
        return source.received is not None and used.get(source, True)

    def _publish_emergency(self, now: float, emergency: bool) -> None:
        if emergency != self._emergency or now - self._emergency_sent >= EMERGENCY_PERIOD:
            self._emergency, self._emergency_sent = emergency, now
            self.publish("emergency_stop", Bool(data=emergency))

    def _publish_state(self, now: float, limited_by: str, factor: float) -> None:
        told: dict[str, Any] = {
            "stopped": self._latch.is_set,
            "standstill": self._standstill.reached(now, self.config.odometry_timeout),
            "stopped_by": self._latch.operator if self._latch.is_set else "",
            "reason": self._latch.account if self._latch.is_set else "",
            "speed_factor": round(factor, 2),
            "limited_by": limited_by,
            "driven_by": self._wheel.driver,
            "manoeuvre": self._busy,
            "hand_session": self._wheel.session,
            "interruptions": self._latch.interruptions,
        }
        # A message is made when there is one to send: this comes with every turn of the loop.
        if told == self._told and now - self._state_sent < STATE_PERIOD:
            return
        state = DriveState(**told)
        state.header.frame_id = self.frames.robot_base
        state.header.stamp = self._stamp()
        self._told, self._state, self._state_sent = told, state, now
        self._state_publisher.publish(state)

    def _stamp(self) -> Time:
        return self.node.get_clock().now().to_msg()

    # -- actions ------------------------------------------------------------------------------

    @component_action(active=True)
    async def move_forward(self, max_distance: float) -> bool:
        """Drive straight ahead.

        Parameters
        ----------
        max_distance
            How far; a negative one drives backwards [m].
        """
        with self._manoeuvring("move_forward"):
            return await self._go(max_distance)

    @component_action(active=True)
    async def move_backward(self, max_distance: float) -> bool:
        """Drive straight back; see :meth:`move_forward`."""
        with self._manoeuvring("move_backward"):
            return await self._go(-max_distance)

    @component_action(active=True)
    async def rotate_in_place(
        self, max_rotation: float, safety_margin: float | None = None
    ) -> bool:
        """Turn on the spot.

        Parameters
        ----------
        max_rotation
            By how much; positive is to the left [rad].
        safety_margin
            What must be free around the robot [m]; a twentieth of its radius unless given.

        A robot with steered wheels cannot, and says so.
        """
        with self._manoeuvring("rotate_in_place"):
            return await self._rotate(max_rotation, self._obstacles(), safety_margin)

    @component_action(active=True)
    async def back_off(self, max_distance: float | None = None) -> bool:
        """Drive straight back, as far as the scan has measured that nothing is there.

        Parameters
        ----------
        max_distance
            Three times the robot's radius unless given [m].
        """
        with self._manoeuvring("back_off"):
            points = self._obstacles()
            if points is None:
                return self.fails("there is no scan to measure the room behind by")
            radius = self.config.described_robot.radius
            if not self._looks_back():
                return self.fails("the scanner does not look behind the robot")
            free = self._free_way(points, math.pi) - self.config.critical_zone_distance - MARGIN
            wanted = 3 * radius if max_distance is None else abs(float(max_distance))
            distance = min(wanted, free)
            if distance < USEFUL:
                return self.fails(f"no more than {max(0.0, free):.2f} m behind are free")
            before = self._location.pose()
            if await self._go(-distance):
                return True
            after = self._location.pose()
            if before is None or after is None or self._latch.is_set or self._wheel.driver:
                return False
            # The gate slows it before what is behind; what it gained helps all the same.
            return math.dist(before[:2], after[:2]) >= USEFUL

    @component_action(active=True)
    async def turn_to_room(self, max_rotation: float = math.pi) -> bool:
        """Turn on the spot to where the way is free the farthest.

        Parameters
        ----------
        max_rotation
            Largest turn either way [rad].
        """
        with self._manoeuvring("turn_to_room"):
            if self.config.described_robot.turning_radius > 0:
                return self.fails(NO_TURN)
            points = self._obstacles()
            if points is None:
                return self.fails("there is no scan to choose a way by")
            radius = self.config.described_robot.radius
            turn, free = widest_turn(points, radius, abs(max_rotation))
            if free < USEFUL:
                return self.fails("no way is free after a turn")
            if turn == 0.0:
                return self.fails("no turn leads to more room than there is ahead")
            return await self._rotate(turn, points, None)

    @component_action(active=True)
    async def move_to_unblock(
        self,
        max_distance_forward: float | None = None,
        max_distance_backwards: float | None = None,
        max_rotation: float = math.pi / 2,
        rotation_safety_margin: float | None = None,
    ) -> bool:
        """Free the robot: drive to the side with more room, or turn to where a way is open.

        Ahead and back are tried in the order of the room measured there, each as far as the stop
        zone lets it, if that is of any use; then a turn, unless the wheels are steered. True at the
        first success; False when it is boxed in.

        Parameters
        ----------
        max_distance_forward, max_distance_backwards
            Twice the robot's radius unless given [m].
        max_rotation
            Largest turn [rad]; 0 for none.
        rotation_safety_margin
            As of :meth:`rotate_in_place`.
        """
        with self._manoeuvring("move_to_unblock"):
            points = self._obstacles()
            if points is None:
                return self.fails("there is no scan to choose a way by")
            radius = self.config.described_robot.radius
            room = {
                -1.0: (self._free_way(points, math.pi), max_distance_backwards),
                1.0: (self._free_way(points, 0.0), max_distance_forward),
            }
            for sign in sorted(room, key=lambda one: -room[one][0]):
                free, wanted = room[sign]
                most = 2 * radius if wanted is None else abs(float(wanted))
                distance = min(most, free - self.config.critical_zone_distance - MARGIN)
                if distance >= min(USEFUL, most) > 0 and await self._go(sign * distance):
                    return True
                if self._latch.is_set:
                    return self.fails("STOP is pressed")
                if self._wheel.driver:
                    return self.fails(f"{self._wheel.driver} drives by hand")
            if self.config.described_robot.turning_radius > 0:
                return self.fails("boxed in: no way is free ahead or back")
            needed = self.config.critical_zone_distance + MARGIN + USEFUL
            turn = open_turn(points, radius, abs(max_rotation), needed) if max_rotation else None
            if turn is None:
                return self.fails("boxed in: no way is free ahead, back, or after a turn")
            return await self._rotate(turn, points, rotation_safety_margin)

    @component_action(active=True, recipe_only=True)
    async def room_for(self, legs: list[list[float]]) -> str | bool:
        """Whether there is room to drive legs one after the other; nothing moves.

        Parameters
        ----------
        legs
            At most 40 rows of (vx, vy, omega, seconds) [m/s, m/s, rad/s, s].
        """
        return self._room_for(self._read_legs("room_for", legs))

    @component_action(active=True, recipe_only=True)
    async def drive_leg(self, vx: float, vy: float, omega: float, seconds: float) -> bool:
        """Drive at one speed for a while, where there is room: a leg of a test of the base.

        It gives way: the first command of another ends it.

        Parameters
        ----------
        vx, vy, omega
            Within the robot's limits [m/s, m/s, rad/s].
        seconds
            How long, 60 at most.
        """
        (leg,) = self._read_legs("drive_leg", [[vx, vy, omega, seconds]])
        with self._manoeuvring("drive_leg"):
            if not self._room_for([leg]):
                return False
            self._ended = Future(executor=self.node.executor)
            self._manoeuvre = leg
            problem: str = await self._ended
            if problem:
                return self.fails(problem)  # at once: whoever is given way to is waiting
            self._halt()
            await self._rest()
            return True

    @component_action(active=True, recipe_only=True)
    def end_leg(self) -> str:
        """End the leg that :meth:`drive_leg` drives, and stand."""
        if not isinstance(self._manoeuvre, Leg):
            return "no leg is driven"
        self._finish("it was called off")
        return "called off"

    def _read_legs(self, name: str, legs: list[list[float]]) -> list[Leg]:
        try:
            return read_legs(legs, velocity_limits(self.config.described_robot))
        except ValueError as error:
            raise ActionRefused(f"{name}: {error}") from None

    def _room_for(self, legs: list[Leg]) -> str | bool:
        """How much room is left beside the legs; False where it is not enough, or unknown."""
        robot, now = self.config.described_robot, self.clock.monotonic()
        commanded = self._queue.current(now)
        if commanded is not None and any(commanded):
            return self.fails("somebody else drives the robot")
        points = self._obstacles()
        if points is None:
            return self.fails("there is no scan to measure the room by")
        turns = any(leg.twist[2] and not any(leg.twist[:2]) for leg in legs)
        if turns and robot.turning_radius > 0:
            return self.fails(NO_TURN)
        poses = swept(legs, velocity_limits(robot))
        reach = float(np.hypot(poses[:, 0], poses[:, 1]).max()) + robot.radius
        if self._zones.now:
            pose = self._location.pose()
            if pose is None:
                return self.fails("it is not known how near the zones are")
            edges = self._zones.now.in_the_way(pose[0], pose[1], reach + 1.0)
            points = np.concatenate([points, transform_points(inverse(pose), edges)])
        if float(poses[:, 0].min()) < -robot.radius and not self._looks_back():
            return self.fails("the scanner does not look behind the robot, where the legs lead")
        needed = self.config.critical_zone_distance + MARGIN
        gap = least_gap(poses, points, Footprint(robot.footprint), needed)
        if gap < needed:
            return self.fails(
                f"there is no room: the legs reach {reach - robot.radius:.2f} m from here and "
                f"leave {max(0.0, gap):.2f} m beside the body, not {needed:.2f} m; drive to where "
                "more is free, or drive shorter or slower legs"
            )
        return f"{min(gap, reach):.2f} m are left beside the body"

    # -- carrying actions out ----------------------------------------------------------------

    @contextmanager
    def _manoeuvring(self, name: str) -> Iterator[None]:
        if self._latch.is_set:
            operator = self._latch.operator
            raise ActionRefused(f"{name}: {operator} pressed STOP; a person must release it")
        driver = self._wheel.driver
        if driver:
            told = f"{driver} drives by hand; the wheel must be given up first"
            raise ActionRefused(f"{name}: {told}")
        if self._busy:
            raise ActionRefused(f"{name}: {self._busy} is still under way")
        self._busy = name
        try:
            yield
        finally:
            self._busy, self._manoeuvre = "", None
            if self._wheel.driver:  # who has the wheel is not to be interrupted
                self._queue.clear()
            else:
                self._halt()

    def _free_way(self, points: NDArray[np.float64], direction: float) -> float:
        """How far the robot can go straight ahead (0) or back (π) before it touches something [m].

        A car goes nowhere but where it faces, so its outline counts and not the circle around.
        """
        robot = self.config.described_robot
        if robot.turning_radius == 0:
            return free_way(points, robot.radius, direction)
        if not len(points):
            return math.inf
        sign = math.cos(direction)
        after = time_to_contact(Footprint(robot.footprint), points, sign, 0.0, 0.0)
        return float(after.min())

    def _looks_back(self) -> bool:
        """Whether a scan has measured what the body would sweep on its way back."""
        return any(sensor.looked_at(math.pi, BEHIND) for sensor in self._sensors)

    async def _go(self, distance: float) -> bool:
        limits = velocity_limits(self.config.described_robot).vx
        return await self._perform(distance, limits.max_vel, limits.max_decel, turns=False)

    async def _rotate(
        self, angle: float, points: NDArray[np.float64] | None, margin: float | None
    ) -> bool:
        robot = self.config.described_robot
        if robot.turning_radius > 0:
            return self.fails(NO_TURN)
        room = 0.05 * robot.radius if margin is None else margin
        if points is not None and len(points) and not self.config.disable_safety_stop:
            nearest = float(np.hypot(points[:, 0], points[:, 1]).min()) - robot.radius
            if nearest < room:
                return self.fails(f"{nearest:.3f} m around the robot are free, not {room:.3f} m")
        limits = velocity_limits(robot).omega
        return await self._perform(angle, limits.max_vel, limits.max_decel, turns=True)

    async def _perform(self, amount: float, top: float, decel: float, *, turns: bool) -> bool:
        if not math.isfinite(amount) or amount == 0.0:
            return self.fails(f"{amount} is no motion; give a number other than 0")
        speed = SHARE_OF_TOP_SPEED * top
        if speed <= 0:
            return self.fails("the robot's limits do not allow that motion")
        self._ended = Future(executor=self.node.executor)
        self._manoeuvre = Manoeuvre(amount, speed, decel, turns)
        problem: str = await self._ended
        self._halt()
        await self._rest()
        return not problem or self.fails(problem)

    async def _rest(self) -> None:
        """Until odometry has measured standstill; what comes next starts from there."""
        deadline = self.clock.monotonic() + REST
        while self.clock.monotonic() < deadline and self.is_active:
            if self._standstill.reached(self.clock.monotonic(), self.config.odometry_timeout):
                return
            await self.sleep(0.05)

    def _finish(self, problem: str) -> None:
        """End the motion under way; an empty problem means that it is complete."""
        self._manoeuvre = None
        if self._ended is not None:
            ended, self._ended = self._ended, None
            ended.set_result(problem)


def _not_released(response: ReleaseStop.Response, error: Exception) -> ReleaseStop.Response:
    response.message = f"not released: {type(error).__name__}: {error}"
    return response
