"""What is wrong with a goal that is no number, for people."""

import math

from geometry_msgs.msg import Pose
from kompass_interfaces.action import PlanPath

from kompass.components.base.convert import pose_of

FARTHEST = 1e6  # m from the origin of the map; nobody means what is further away


def pose_fault(pose: Pose) -> str:
    """Why nobody can be sent to a pose; empty when its place and heading are numbers."""
    x, y, yaw = pose_of(pose)
    for name, value in (("x", x), ("y", y)):
        if not math.isfinite(value):
            return f"The goal's {name} = {value} is no place; give finite metres."
        if abs(value) > FARTHEST:
            limit = f"{FARTHEST / 1000:.0f} km"
            return f"The goal's {name} = {value:g} m is no place; give one within {limit}."
    if not math.isfinite(yaw):
        q = pose.orientation
        given = f"({q.x}, {q.y}, {q.z}, {q.w})"
        return f"The goal's orientation = {given} is no heading; give a unit quaternion."
    return ""


def goal_fault(goal: PlanPath.Goal) -> str:
    """Why a goal cannot be pursued, whatever the map; empty when it can."""
    tolerance = goal.end_tolerance
    for name, value in (
        ("lateral_distance_error", tolerance.lateral_distance_error),
        ("orientation_error", tolerance.orientation_error),
    ):
        if not math.isfinite(value) or value < 0.0:
            return f"The goal's {name} = {value} is no tolerance; give 0, for the set one, or more."
    return pose_fault(goal.goal)
