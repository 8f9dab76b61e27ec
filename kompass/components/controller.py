"""The controller: follows the path, to its very end."""

from typing import Any, ClassVar

import numpy as np
from geometry_msgs.msg import PoseStamped, Twist
from kompass_interfaces.msg import TwistArray

from kompass.algorithms.following.command import Command, FollowStep
from kompass.algorithms.following.follower import PathFollower
from kompass.algorithms.following.pure_pursuit import PurePursuit, PurePursuitParams
from kompass.algorithms.following.stanley import Stanley, StanleyParams
from kompass.components.component_config import ComponentRunType
from kompass.components.controller_config import CmdPublishType, ControllerConfig
from kompass.components.convert import Pose2D, path_poses, quaternion_msg
from kompass.components.limits import velocity_limits
from kompass.components.located import Located
from kompass.components.topic import LATCHED, AllowedTopics, Topic
from kompass.control import ControllersID

# Facing farther off than this the robot turns first: swinging in while driving would take it off
# the path by more than the clearance that the path keeps.
TURN_IN_PLACE = 0.4  # rad


class Controller(Located):
    """Turns ``plan`` and ``location`` into commands; stops when its inputs stop.

    A path ends with its last pose, heading included. An empty path clears the old one.
    """

    config: ControllerConfig
    config_class = ControllerConfig
    allowed_run_types = (ComponentRunType.TIMED,)
    allowed_inputs: ClassVar = {
        "plan": AllowedTopics(["Path"]),
        "location": AllowedTopics(["Odometry", "PoseStamped", "Pose"]),
    }
    allowed_outputs: ClassVar = {
        "command": AllowedTopics(["Twist"]),
        "multi_command": AllowedTopics(["TwistArray"]),
        "tracked_point": AllowedTopics(["PoseStamped"]),
    }
    default_inputs: ClassVar = {
        "plan": [Topic(name="/plan", msg_type="Path")],
        "location": [Topic(name="/odom", msg_type="Odometry")],
    }
    default_outputs: ClassVar = {
        "command": [Topic(name="/control", msg_type="Twist")],
        "multi_command": [Topic(name="/control_list", msg_type="TwistArray")],
        "tracked_point": [Topic(name="/tracked_point", msg_type="PoseStamped")],
    }
    qos: ClassVar = {"plan": LATCHED}

    def __init__(self, component_name: str = "controller", **kwargs: object) -> None:
        super().__init__(component_name, **kwargs)

    @property
    def algorithm(self) -> ControllersID:
        """The path-following algorithm."""
        return self.config.algorithm

    @algorithm.setter
    def algorithm(self, value: ControllersID | str) -> None:
        self.config.algorithm = value  # type: ignore[assignment]  # validated and converted

    def init_variables(self) -> None:
        self._follower = self._make_follower()
        self._has_path = False

    def _make_follower(self) -> PathFollower:
        limits = velocity_limits(self.config.robot)
        common = {
            "turn_in_place_angle": TURN_IN_PLACE,
            "goal_tolerance": self.config.goal_dist_tolerance,
            "heading_tolerance": self.config.goal_orientation_tolerance,
        }
        speeds = {
            "max_v": limits.vx.max_vel,
            "max_omega": limits.omega.max_vel,
            "acc": limits.vx.max_acc,
            "decel": limits.vx.max_decel,
            "omega_acc": limits.omega.max_acc,
        }
        if self.config.algorithm is ControllersID.STANLEY:
            return Stanley(StanleyParams(**common), **speeds)
        return PurePursuit(PurePursuitParams(**common), **speeds)

    def custom_on_activate(self) -> None:
        super().custom_on_activate()
        self.input("plan").on_message = self._on_plan

    def custom_on_deactivate(self) -> None:
        if self._has_path:
            self._command(Command())
        super().custom_on_deactivate()

    def _on_plan(self, message: Any) -> None:
        poses = path_poses(message)
        if len(poses) < 2 or not np.all(np.isfinite(poses)):
            if self._has_path:
                self._has_path = False
                self._command(Command())
            return
        if not self._has_path:
            self._follower.reset()
        self._follower.set_path(poses)
        self._has_path = True

    def _execution_step(self) -> None:
        source = self.input("location")
        pose = self.pose()
        if pose is None or source.age() > self.config.location_timeout:
            self.health.set_fail_system(
                topics=[f"/{source.topic.name}"], message="the robot does not know where it is"
            )
            if self._has_path:
                self._command(Command())
                self._follower.reset()
            return
        self.health.set_healthy()
        if not self._has_path:
            return
        vx, _, omega = self.speed()
        step = self._follower.step(pose, vx, omega, 1.0 / self.config.loop_rate)
        self._command(step.command)
        self._publish_tracked_point(step, pose)
        if step.phase == "arrived":
            self._has_path = False

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
