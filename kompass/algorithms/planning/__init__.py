"""Global planning: from where the robot is to where it should be, over a known map."""

from kompass.algorithms.planning.failure import PlanningFailure, Reason
from kompass.algorithms.planning.planner import GlobalPlanner, Plan

__all__ = ["GlobalPlanner", "Plan", "PlanningFailure", "Reason"]
