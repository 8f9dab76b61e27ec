"""Settings of the planner."""

import difflib
import math
from collections.abc import Mapping
from typing import ClassVar

from pydantic import Field, field_validator

from kompass.algorithms.planning.sampling import planner_names
from kompass.components.base.mask_settings import MaskSettings
from kompass.settings import Settings, notice_once

STAND_IN = "RRTConnect"
# Geometric planners of OMPL that other builds of it offer.
ELSEWHERE = (
    *("ABITstar", "AITstar", "BiEST", "EST", "LBTRRT", "LazyLBTRRT", "LazyPRM", "LazyPRMstar"),
    *("LazyRRT", "PDST", "ProjEST", "RRTXstatic", "RRTsharp", "SBL", "SST", "STRIDE", "TRRT"),
)


def usable_planner(planner_id: str) -> str:
    """Class name of the planner, or of its stand-in when this OMPL does not have it.

    Raises
    ------
    ValueError
        When no OMPL has it.
    """
    name = planner_id.rpartition(".")[2]
    known = planner_names()
    if name in known:
        return name
    if name in ELSEWHERE:
        notice_once(f"planner_id: this OMPL has no {name}; {STAND_IN} takes its place")
        return STAND_IN
    close = difflib.get_close_matches(name, [*known, *ELSEWHERE], n=1)
    remedy = f"did you mean {close[0]!r}?" if close else f"choose one of {', '.join(known)}"
    raise ValueError(f"{planner_id!r} is no geometric planner of OMPL; {remedy}")


class OmplConfig(Settings):
    """The section ``<node>.ompl``. A field left out (None) leaves the planner's own setting."""

    ignored_settings: ClassVar[Mapping[str, str]] = {
        "log_level": "OMPL says nothing of its own",
        "simplification_timeout": "a path is simplified until it is short",
        "goal_tolerance": "paths end exactly at the goal",
        "optimization_objective": "the planner looks for the shortest path",
        "optimization_objective_threshold": "the planner looks for the shortest path",
        "map_resolution": "the map tells it",
        **dict.fromkeys([*ELSEWHERE, *planner_names()], "planners keep their own settings"),
    }

    planning_timeout: float | None = Field(default=None, gt=0, le=60, description="s")
    planner_id: str | None = None

    @field_validator("planner_id")
    @classmethod
    def _is_known(cls, value: str | None) -> str | None:
        if value is not None:
            usable_planner(value)
        return value


class PlannerConfig(MaskSettings):
    """How paths are found, and how long a goal is pursued."""

    ignored_settings: ClassVar[Mapping[str, str]] = {
        "algorithm": "the planner is always one of OMPL",
        "depth_conversion_factor": "the planner takes no depth images",
        "depth_range": "the planner takes no depth images",
        "visualization": "the page shows the path",
        "detailed_logging": "log_level says how much is written",
        "number_of_sent_cmds": "the planner sends paths, and no commands",
        "safety_stop_dist": "the drive manager stops the robot, at its critical_zone_distance",
        "stop_angle_range": "the drive manager stops the robot, for what is in its way",
        "retries": "a goal is pursued as long as its patience lasts",
    }

    loop_rate: float = Field(default=1.0, ge=0.01, le=100, description="Hz; replanning checks")
    points_per_meter: float = Field(default=10, ge=1, le=1000, description="of the path")
    distance_tolerance: float = Field(
        default=0.05, gt=0, le=10, description="m; for goals that state no tolerance"
    )
    orientation_tolerance: float = Field(
        default=0.1,
        gt=0,
        le=math.pi,
        description="rad; for goals with a heading that state no tolerance",
    )
    clearance: float = Field(
        default=0.1,
        ge=0,
        le=10,
        description="m between footprint and obstacle along the path; less with use_sensor, where "
        "there is no other way",
    )
    unknown_is_obstacle: bool = True
    use_sensor: bool = Field(
        default=False, description="plan around what sensor_data shows, too; a map is not needed"
    )
    obstacle_memory: float = Field(
        default=120.0,
        gt=0,
        le=86400,
        description="s; what was seen is forgotten after so long out of sight",
    )
    planner_id: str = Field(
        default="RRTConnect",
        description="geometric planner of OMPL, for a round robot; for others cells are searched",
    )
    planning_timeout: float = Field(
        default=1.0, gt=0, le=60, description="s, counted in checks: 50,000 to the second"
    )
    patience: float = Field(
        default=15.0,
        gt=0,
        le=86400,
        description="s without a plan or progress before a goal is given up",
    )
    goals_from_topics: bool = Field(
        default=False,
        description="as an ActionServer, send oneself a goal for each message on goal_point",
    )
    location_timeout: float = Field(default=0.5, gt=0, le=60, description="s")
    ompl: OmplConfig = Field(
        default_factory=OmplConfig, description="from older files; comes before the fields above"
    )

    @field_validator("planner_id")
    @classmethod
    def _is_known(cls, value: str) -> str:
        usable_planner(value)
        return value

    @property
    def chosen_planner(self) -> str:
        """The planner to use, as it was named."""
        return self.ompl.planner_id or self.planner_id

    @property
    def chosen_timeout(self) -> float:
        """Time that it may take [s]."""
        return self.ompl.planning_timeout or self.planning_timeout
