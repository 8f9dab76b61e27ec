"""Answer whether a goal would be accepted, and how long the way is."""

from collections.abc import Callable
from typing import Any

import numpy as np
from geometry_msgs.msg import Point
from kompass_interfaces.srv import CheckGoal
from nav_msgs.msg import Path

from kompass.algorithms.geometry import Pose2D, wrap_angle
from kompass.algorithms.planning.failure import PlanningFailure, code_of
from kompass.algorithms.planning.planner import GlobalPlanner
from kompass.components.base.convert import pose_of
from kompass.robot import RobotConfig

SHARE_OF_TOP_SPEED = 0.85  # what a robot keeps on average that slows for curves and the end


def check_goal(
    ready: Callable[[], tuple[GlobalPlanner, Pose2D]],
    explain: Callable[[PlanningFailure], None],
    robot: RobotConfig,
    to_path: Callable[[Any], Path],
    request: CheckGoal.Request,
    response: CheckGoal.Response,
) -> CheckGoal.Response:
    """Fill the response of CheckGoal.

    Parameters
    ----------
    ready
        Gives planner and pose, or raises PlanningFailure.
    explain
        Raises a failure anew where more can be said.
    robot
        For its speeds.
    to_path
        Makes the preview's message.
    """
    x, y, yaw = pose_of(request.goal)
    try:
        planner, pose = ready()
        try:
            plan = planner.plan(pose, (x, y, yaw if request.use_heading else None))
        except PlanningFailure as failure:
            explain(failure)
            raise
    except PlanningFailure as failure:
        response.reachable = False
        response.reason = code_of(failure.reason)
        response.message = failure.message
        if failure.nearest is not None:
            response.has_nearest = True
            response.nearest = Point(x=float(failure.nearest[0]), y=float(failure.nearest[1]))
        return response
    response.reachable = True
    response.reason = code_of("")
    response.message = "The way is clear."
    response.preview = to_path(plan.poses)
    response.length = plan.length
    response.duration = duration(plan.poses, plan.length, pose, robot)
    return response


def duration(poses: Any, length: float, pose: Pose2D, robot: RobotConfig) -> float:
    """Estimated time to drive a path [s]: its length, and the turns at both ends."""
    speed = SHARE_OF_TOP_SPEED * robot.ctrl_vx_limits.max_vel
    omega = SHARE_OF_TOP_SPEED * robot.ctrl_omega_limits.max_vel
    if speed <= 0 or omega <= 0:
        return 0.0
    direction = float(np.arctan2(*(poses[min(3, len(poses) - 1), :2] - poses[0, :2])[::-1]))
    arriving = float(np.arctan2(*(poses[-1, :2] - poses[max(-4, -len(poses)), :2])[::-1]))
    turns = abs(wrap_angle(direction - pose[2])) + abs(wrap_angle(poses[-1, 2] - arriving))
    return float(length / speed + turns / omega)
