"""What the environment says of the monitor; the command line sets it."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import NamedTuple

from kompass.store.paths import ROBOT_NAME

PROBATION = "KOMPASS_PROBATION"
SAFE_MODE = "KOMPASS_SAFE_MODE"
DEFAULT_PROBATION = 60.0  # s


class MonitorSettings(NamedTuple):
    """How the monitor runs.

    Attributes
    ----------
    robot
        Name of the robot.
    probation
        Seconds after which an applied table is taken back unless confirmed; 0 for never.
    safe_mode
        Whether the recipe's table is in force, whatever is stored.
    """

    robot: str
    probation: float = DEFAULT_PROBATION
    safe_mode: bool = False

    @classmethod
    def of(cls, environment: Mapping[str, str] = os.environ) -> MonitorSettings:
        """Read the settings from environment variables.

        Raises
        ------
        ValueError
            When one is malformed.
        """
        text = environment.get(PROBATION, "")
        try:
            probation = float(text) if text else DEFAULT_PROBATION
        except ValueError:
            probation = math.nan
        if not 0.0 <= probation < math.inf:
            raise ValueError(f"{PROBATION} = {text!r}: give seconds, 0 for none")
        return cls(
            robot=environment.get(ROBOT_NAME) or os.uname().nodename,
            probation=probation,
            safe_mode=environment.get(SAFE_MODE, "") not in ("", "0"),
        )
