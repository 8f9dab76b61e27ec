"""Following a path: where along it the robot is, and which twist keeps it there."""

from kompass.algorithms.following.command import Command, FollowStep
from kompass.algorithms.following.dwa import DWA, DWAParams, NoCommand
from kompass.algorithms.following.limits import Limits
from kompass.algorithms.following.path_tracker import PathTracker
from kompass.algorithms.following.pure_pursuit import PurePursuit, PurePursuitParams
from kompass.algorithms.following.stanley import Stanley, StanleyParams

__all__ = [
    "DWA",
    "Command",
    "DWAParams",
    "FollowStep",
    "Limits",
    "NoCommand",
    "PathTracker",
    "PurePursuit",
    "PurePursuitParams",
    "Stanley",
    "StanleyParams",
]
