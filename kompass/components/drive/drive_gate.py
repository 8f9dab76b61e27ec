"""The last gate before the wheels: limits, stop zone, age of scan and command, STOP."""

import math
import time
from typing import ClassVar

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point32, PolygonStamped, Twist, TwistStamped
from kompass_interfaces.msg import DriveState, TwistArray
from kompass_interfaces.srv import ReleaseStop, StopRobot
from numpy.typing import NDArray
from rclpy.duration import Duration
from std_msgs.msg import Bool

from kompass.algorithms.following.command import Command
from kompass.algorithms.mapping.scan_points import scan_to_points
from kompass.algorithms.safety.standstill import Standstill
from kompass.algorithms.safety.stop_zone import StopZone
from kompass.algorithms.safety.velocity_limiter import VelocityLimiter
from kompass.algorithms.transforms import TransformError
from kompass.components.base.component_config import ComponentRunType
from kompass.components.base.input import Input
from kompass.components.base.located import Located
from kompass.components.base.robot_limits import velocity_limits
from kompass.components.drive.command_queue import STILL, CommandQueue, Twist2D
from kompass.components.drive.config import DriveManagerConfig
from kompass.components.drive.manoeuvre import free_way
from kompass.components.drive.stop_latch import StopLatch
from kompass.rclpy_ext.topic import LATCHED, AllowedTopics, Topic

EMERGENCY_PERIOD = 0.5  # s between repetitions of an unchanged emergency flag
STATE_PERIOD = 0.2  # s
# A share of the wanted speed that counts as none: the ramp of the zone is only ever approached.
BLOCKED_BELOW = 0.05
TURNING = 0.1  # rad/s from which a command counts as a turn too
SETTLE = 0.5  # s of zero commands after the last motion


class DriveGate(Located):
    """Takes commands, gives the wheels only what is safe now, and says what held it back.

    Its loop runs whether or not commands flow. STOP is a service of its own; it is latched, no rule
    or component can reset it, and it survives the death of this process.

    Where the way is blocked, the turn that the command holds is still carried out.

    ``emergency_stop`` is a level: true while a wanted motion is fully blocked by the stop zone, or,
    with none wanted, something is inside the critical zone the way that the robot went last; false
    again by itself.
    """

    config: DriveManagerConfig
    config_class = DriveManagerConfig
    stops_robot = True
    steps_in_any_run_type = True
    allowed_run_types = (ComponentRunType.TIMED, ComponentRunType.EVENT)
    allowed_inputs: ClassVar = {
        "command": AllowedTopics(["Twist"]),
        "multi_command": AllowedTopics(["TwistArray"]),
        "sensor_data": AllowedTopics(["LaserScan"]),
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

    ignored_settings: ClassVar = {"cmd_rate": "commands are sent at loop_rate"}

    def __init__(self, component_name: str = "drive_manager", **kwargs: object) -> None:
        super().__init__(component_name, **kwargs)
        self._latch = StopLatch()

    def init_variables(self) -> None:
        self._queue = CommandQueue(self.config.command_timeout)
        self._set_up()
        self._standstill = Standstill()
        self._sent: Twist2D = STILL
        self._moved = -float("inf")
        self._direction: float | None = None  # of the last motion, in the robot's frame [rad]
        self._points: NDArray[np.float64] = np.empty((0, 2))
        self._points_of: object = None
        self._emergency = False
        self._emergency_sent = -float("inf")
        self._state = DriveState(speed_factor=1.0)
        self._state_sent = -float("inf")

    def _set_up(self) -> None:
        """Take the settings over."""
        limits = velocity_limits(self.config.robot)
        self._zone = StopZone(
            self.config.robot.radius,
            self.config.critical_zone_distance,
            self.config.slowdown_zone_distance,
            max_decel=limits.vx.max_decel,
        )
        self._limiter = VelocityLimiter(limits)
        self._queue.timeout = self.config.command_timeout

    def on_config_changed(self, names: set[str]) -> None:
        self._set_up()

    def create_interfaces(self) -> None:
        self._state_publisher = self.node.create_publisher(
            DriveState, "drive_state", LATCHED.to_ros()
        )
        self._footprint_publisher = self.node.create_publisher(
            PolygonStamped, "footprint", LATCHED.to_ros()
        )
        name = self.node_name
        self.node.create_service(StopRobot, f"{name}/stop", self._on_stop)
        self.node.create_service(ReleaseStop, f"{name}/release_stop", self._on_release)

    def custom_on_activate(self) -> None:
        super().custom_on_activate()
        self.input("command").on_message = self._on_command
        self.input("multi_command").on_message = self._on_commands
        self.input("location").on_message = self._on_location
        footprint = PolygonStamped()
        footprint.header.frame_id = self.frames.robot_base
        footprint.polygon.points = [
            Point32(x=float(x), y=float(y)) for x, y in self.config.robot.footprint
        ]
        self._footprint_publisher.publish(footprint)

    def custom_on_deactivate(self) -> None:
        # The robot halts with the gate: this may be the last word that the wheels get.
        self._send(STILL)
        for publisher in self._publishers["robot_command"]:
            publisher.wait_for_all_acked(Duration(seconds=0.2))
        super().custom_on_deactivate()

    # -- STOP ---------------------------------------------------------------------------------

    def _on_stop(
        self, request: StopRobot.Request, response: StopRobot.Response
    ) -> StopRobot.Response:
        operator = request.operator_name or "somebody"
        self._latch.set(operator, request.reason)
        self._halt()
        self._publish_state(time.monotonic(), "stop", 0.0)
        self.node.get_logger().warning(f"STOP by {operator}: {request.reason or 'no reason given'}")
        response.success = True
        response.message = "stopped; a person must release it"
        return response

    def _on_release(
        self, request: ReleaseStop.Request, response: ReleaseStop.Response
    ) -> ReleaseStop.Response:
        response.success = True
        response.message = "released" if self._latch.is_set else "it was not stopped"
        # Commands from before the release are not carried out after it.
        self._queue.clear()
        self._latch.release()
        self._publish_state(time.monotonic(), "", 1.0)
        self.node.get_logger().warning(f"STOP released by {request.operator_name or 'somebody'}")
        return response

    def _halt(self) -> None:
        self._queue.clear()
        self._send(STILL)

    # -- inputs -------------------------------------------------------------------------------

    @property
    def _takes_commands(self) -> bool:
        """Whether commands of others are carried out."""
        return True

    def _wanted(self, now: float) -> Twist2D | None:
        """The twist asked for at this moment; None when none is."""
        return self._queue.current(now)

    def _judged(self, factor: float, limited_by: str) -> None:
        """Called in each turn with the share of the wanted twist that is allowed, and why."""

    def _on_command(self, message: Twist) -> None:
        if not self._takes_commands:
            return
        command = (message.linear.x, message.linear.y, message.angular.z)
        self._queue.put([command], 0.0, time.monotonic())

    def _on_commands(self, message: TwistArray) -> None:
        if self._takes_commands:
            self._queue.put_array(message, time.monotonic())

    def _on_location(self, _message: object) -> None:
        self._standstill.update(self.speed(), time.monotonic())

    def _obstacles(self) -> NDArray[np.float64] | None:
        """Points of the newest scan in the robot's frame, shape (N, 2); None when unknown."""
        source = self.input("sensor_data")
        scan = source.message
        if scan is None or source.age() > self.config.scan_timeout:
            return None
        if scan is not self._points_of:
            try:
                mounted = self.sensor_pose(scan.header.frame_id)
            except TransformError as error:
                self.warn(f"the scan cannot be placed on the robot: {error}")
                return None
            self._points = scan_to_points(
                np.asarray(scan.ranges, dtype=np.float64),
                scan.angle_min,
                scan.angle_increment,
                scan.range_min,
                scan.range_max,
                mounted,
            )
            self._points_of = scan
        return self._points

    # -- the loop -----------------------------------------------------------------------------

    def _execution_step(self) -> None:
        try:
            self._turn(time.monotonic())
        except Exception:
            self._halt()
            raise

    def _turn(self, now: float) -> None:
        wanted = self._wanted(now)
        obstacles = self._obstacles()
        odometry_known = self.input("location").age() <= self.config.odometry_timeout
        self._judge_health(obstacles is not None, odometry_known)

        factor, limited_by = 1.0, ""
        if self._latch.is_set:
            self._queue.clear()
            factor, limited_by = 0.0, "stop"
        elif not odometry_known:
            factor, limited_by = 0.0, "odometry stale"
        elif not self.config.disable_safety_stop:
            if obstacles is None:
                if not self.config.use_without_scan_sensor:
                    factor, limited_by = 0.0, "scan stale"
            elif wanted is not None:
                factor = float(self._zone.factor(obstacles, *wanted))
                factor = 0.0 if factor < BLOCKED_BELOW else factor
                limited_by = "obstacle" if factor < 1.0 else ""
        if not limited_by and self._queue.is_stale(now):
            limited_by = "command stale"

        blocked = limited_by == "obstacle" and factor == 0.0
        # A round body that turns on the spot meets nothing: what is blocked is the way, and the
        # turn that is part of the command leads out of it.
        turn = wanted[2] if wanted and blocked and abs(wanted[2]) >= TURNING else 0.0
        self._drive(wanted, factor, turn, now)
        if wanted and any(wanted):
            emergency = blocked and not turn
        else:
            emergency = self._too_close_ahead(obstacles)
        self._publish_emergency(now, emergency)
        self._judged(factor, limited_by)
        self._publish_state(now, limited_by, factor)

    def _drive(self, wanted: Twist2D | None, factor: float, turn: float, now: float) -> None:
        """Send the command, as far as it is allowed; fall silent when nothing moves for long."""
        if self._latch.is_set:
            self._send(STILL)
            return
        target = STILL if wanted is None else tuple(factor * value for value in wanted)
        dt = 1.0 / self.config.loop_rate
        before = self._sent
        if factor == 0.0:
            # At once: what the limiter would smooth is what must not happen.
            target, before = (0.0, 0.0, turn), (0.0, 0.0, before[2] if turn else 0.0)
        smooth = self._limiter.limit(Command(*target), Command(*before), dt)
        command = (smooth.vx, smooth.vy, smooth.omega)
        if command != STILL or wanted is not None:
            self._moved = now
        if now - self._moved <= SETTLE:
            self._send(command)

    def _too_close_ahead(self, obstacles: NDArray[np.float64] | None) -> bool:
        """Whether something is inside the critical zone, the way that the robot went last."""
        if obstacles is None or self._direction is None or self.config.disable_safety_stop:
            return False
        way = free_way(obstacles, self.config.robot.radius, self._direction)
        return way <= self.config.critical_zone_distance

    def _send(self, command: Twist2D) -> None:
        self._sent = command
        if command[0] or command[1]:
            self._direction = math.atan2(command[1], command[0])
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

    def _judge_health(self, scan_known: bool, odometry_known: bool) -> None:
        scan, odometry = self.input("sensor_data"), self.input("location")
        missing = {}
        needs_scan = not (self.config.disable_safety_stop or self.config.use_without_scan_sensor)
        if needs_scan and not scan_known:
            missing[scan] = f"no scan {_for(scan.age())}"
        if not odometry_known:
            missing[odometry] = f"no odometry {_for(odometry.age())}"
        topics = [f"/{source.topic.name}" for source in missing]
        if not missing:
            self.health.set_healthy()
        elif self.is_starting and not any(self._has_served(source) for source in missing):
            self.health.set_healthy(f"waiting for {', '.join(topics)}")
        else:
            self.health.set_fail_system(topics=topics, message="; ".join(missing.values()))

    def _has_served(self, source: Input) -> bool:
        """Whether an input has been of use since the activation; a scan needs its transform."""
        used = source.received is not None
        return used and (source is not self.input("sensor_data") or self._points_of is not None)

    def _publish_emergency(self, now: float, emergency: bool) -> None:
        if emergency != self._emergency or now - self._emergency_sent >= EMERGENCY_PERIOD:
            self._emergency, self._emergency_sent = emergency, now
            self.publish("emergency_stop", Bool(data=emergency))

    def _publish_state(self, now: float, limited_by: str, factor: float) -> None:
        state = DriveState(
            stopped=self._latch.is_set,
            standstill=self._standstill.reached(now, self.config.odometry_timeout),
            stopped_by=self._latch.operator if self._latch.is_set else "",
            reason=self._latch.reason if self._latch.is_set else "",
            speed_factor=round(factor, 2),
            limited_by=limited_by,
        )
        state.header.frame_id = self.frames.robot_base
        state.header.stamp = self._state.header.stamp
        if state != self._state or now - self._state_sent >= STATE_PERIOD:
            state.header.stamp = self._stamp()
            self._state, self._state_sent = state, now
            self._state_publisher.publish(state)

    def _stamp(self) -> Time:
        return self.node.get_clock().now().to_msg()


def _for(age: float) -> str:
    # Coarse on purpose: a sentence that changes ten times a second cannot be read.
    return "yet" if age == float("inf") else f"for {age:.0f} s" if age >= 1 else "any more"
