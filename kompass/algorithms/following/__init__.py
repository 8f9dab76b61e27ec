"""Following a path: where along it the robot is, and which twist keeps it there."""

from kompass.algorithms.following.command import Command, FollowStep
from kompass.algorithms.following.dwa import DWA, DWAParams
from kompass.algorithms.following.follower import FollowerParams, NoCommand, PathFollower
from kompass.algorithms.following.limits import Limits
from kompass.algorithms.following.path_tracker import PathTracker
from kompass.algorithms.following.pure_pursuit import PurePursuit, PurePursuitParams
from kompass.algorithms.following.stanley import Stanley, StanleyParams

__all__ = [
    "DWA",
    "Command",
    "DWAParams",
    "FollowStep",
    "FollowerParams",
    "Limits",
    "NoCommand",
    "PathFollower",
    "PathTracker",
    "PurePursuit",
    "PurePursuitParams",
    "Stanley",
    "StanleyParams",
]
