"""An action server of your own: the robot goes its rounds.

A component that pursues *goals* is asked through an action: whoever sends one can follow it, cancel
it, and learns how it ended. This one drives named rounds, point after point, through the planner's
own action; so paths, obstacles and STOP are looked after as always.

    kompass-console run recipes/08_patrol.py --sim

Try it: one round, with a rule on the page (Rules, New rule; its action sends a goal to
/patrol/follow_path, with the path_name west), or from another terminal, where a ROS installation
has brought the command ros2. A click on the floor of the page calls the robot off.

    ros2 topic pub --once /patrol/start std_msgs/msg/Empty
    ros2 action send_goal --feedback /patrol/follow_path kompass_interfaces/action/FollowPath \\
        "{request: {path_name: west}}"

Start with --fault boxed_in:20:60, and send the robot on a round: after twenty seconds walls stand
around it for a minute. The round ends, and a rule tries to break free, every five seconds: as long
as no way is free it fails and says so; then the robot frees itself and goes the round once more.
"""

import math

import numpy as np
from kompass_interfaces.action import FollowPath, PlanPath
from pydantic import Field
from sugar.msg import ComponentStatus

from kompass.actions import Action, LogInfo, send_component_action_server_goal
from kompass.components import (
    Component,
    Controller,
    DriveManager,
    LocalMapper,
    Planner,
    PlannerConfig,
)
from kompass.config import BaseComponentConfig
from kompass.control import ControllersID
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotGeometry,
    RobotType,
)
from kompass.ros import Event, Launcher, Topic

my_robot = RobotConfig(
    model_type=RobotType.DIFFERENTIAL_DRIVE,
    geometry_type=RobotGeometry.Type.CYLINDER,
    geometry_params=np.array([0.1, 0.3]),
    ctrl_vx_limits=LinearCtrlLimits(max_vel=0.22, max_acc=1.5, max_decel=2.5),
    ctrl_omega_limits=AngularCtrlLimits(max_vel=1.5, max_acc=3.0, max_decel=3.0),
)


class PatrolConfig(BaseComponentConfig):
    """The rounds."""

    rounds: dict[str, list[tuple[float, float]]] = Field(
        default={"west": [(-1.5, -0.5), (-1.5, 0.5)]}, description="points (x, y) by name [m]"
    )
    near: float = Field(default=0.1, gt=0.0, le=1.0, description="m; how near a point is reached")


class Patrol(Component):
    """Drives rounds by name."""

    config: PatrolConfig
    config_class = PatrolConfig

    def create_interfaces(self) -> None:
        self.planner = self.node.create_action_client(PlanPath, "planner/plan_path")

    # A coroutine, so that the component goes on while it waits. A plain function may wait, too: it
    # runs on a thread of its own then, and must mind what it shares with the other methods.
    async def main_action_callback(self, goal_handle) -> FollowPath.Result:
        result = FollowPath.Result()
        name = goal_handle.request.request.path_name
        points = self.config.rounds.get(name)
        if points is None:
            self.warn(f"there is no round '{name}'; known are {', '.join(self.config.rounds)}")
            goal_handle.abort()
            return result
        self.health.set_healthy()  # a new round is a new try
        for number, point in enumerate(points, start=1):
            self.publishers_dict["point"].publish(number)
            ended = await self.drive_to(point, goal_handle)
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return result
            if not ended.reached_end:
                if ended.outcome in (ended.OUTCOME_BLOCKED, ended.OUTCOME_STUCK):
                    self.health.set_fail_system(components=["planner"], message=ended.message)
                self.warn(f"round '{name}' ended before point {number}: {ended.message}")
                goal_handle.abort()
                return result
        goal_handle.succeed()
        result.reached_end = True
        return result

    async def drive_to(self, point: tuple[float, float], goal_handle) -> PlanPath.Result:
        """Send the planner a goal, hand on what it reports, and wait for its end."""
        goal = PlanPath.Goal()
        goal.goal.position.x, goal.goal.position.y = point
        goal.end_tolerance.lateral_distance_error = self.config.near
        goal.end_tolerance.orientation_error = math.pi
        feedback = FollowPath.Feedback()

        def report(message) -> None:
            feedback.tracking_error.lateral_distance_error = message.feedback.distance_left
            goal_handle.publish_feedback(feedback)

        sent = await self.planner.send_goal_async(goal, feedback_callback=report)
        if not sent.accepted:
            return PlanPath.Result(message="the planner is not active")
        ended = sent.get_result_async()
        while not ended.done():
            # Cancelled, or the component was stopped: then the goal is active no more.
            if goal_handle.is_cancel_requested or not goal_handle.is_active:
                await sent.cancel_goal_async()
            await self.sleep(0.1)
        return ended.result().result

    def note(self, number: int) -> bool:
        """Tell people where the round is."""
        self.get_logger().info(f"on the way to point {number}")
        return True


point = Topic(name="/patrol/point", msg_type="Int32")
patrol = Patrol("patrol", main_action_type=FollowPath, outputs={"point": point})
patrol.run_type = "ActionServer"

planner = Planner(component_name="planner", config=PlannerConfig(goals_from_topics=True))
planner.run_type = "ActionServer"
planner.inputs(goal_point=Topic(name="/clicked_point", msg_type="PointStamped"))
controller = Controller(component_name="controller")
controller.algorithm = ControllersID.DWA
controller.direct_sensor = True
mapper = LocalMapper(component_name="mapper")
driver = DriveManager(component_name="drive_manager")

west = FollowPath.Goal()
west.request.path_name = "west"
start = Event(Topic(name="/patrol/start", msg_type="Empty")).as_rule(
    "patrol-start", name="Start → the western round"
)
next_point = Event(point).as_rule("patrol-point", name="Next point → note it")
# As long as the round is blocked, not once when it becomes so: the first try may be in vain.
blocked = Event(
    patrol.status_topic.msg.status == ComponentStatus.STATUS_FAILURE_SYSTEM_LEVEL,
    keep_event_delay=5.0,
).as_rule("patrol-blocked", name="Round blocked → break free, go again", mode={"kind": "single"})
go_west = send_component_action_server_goal(component=patrol, request_msg=west)

launcher = Launcher()
launcher.kompass(
    components=[planner, controller, mapper, driver, patrol],
    events_actions={
        start: [LogInfo(msg="a round begins"), go_west],
        next_point: Action(patrol.note, args=(point.msg.data,)),
        blocked: [Action(driver.move_to_unblock), go_west],
    },
    multi_processing=True,
)
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.robot = my_robot
launcher.bringup()
