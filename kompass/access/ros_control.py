"""What may be done over ROS without the robot's key."""

import os
from collections.abc import Mapping
from typing import Literal, get_args

ROS_CONTROL = "KOMPASS_ROS_CONTROL"
RosControl = Literal["off", "read", "full"]
MODES: tuple[RosControl, ...] = get_args(RosControl)
DEFAULT: RosControl = "read"


def ros_control(environment: Mapping[str, str] = os.environ) -> RosControl:
    """What the environment says: ``off`` nothing, ``read`` (the default) look, ``full`` all.

    Raises
    ------
    ValueError
        When it says something else.
    """
    said = environment.get(ROS_CONTROL) or DEFAULT
    if said not in MODES:
        raise ValueError(f"{ROS_CONTROL}={said!r} is none of {', '.join(MODES)}; choose one")
    return said
