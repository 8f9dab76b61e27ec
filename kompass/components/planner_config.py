"""Settings of the planner."""

from pydantic import Field

from kompass.components.component_config import ComponentConfig


class PlannerConfig(ComponentConfig):
    """How paths are found, and how long a goal is pursued."""

    loop_rate: float = Field(default=1.0, ge=0.01, le=100, description="Hz; replanning checks")
    points_per_meter: float = Field(default=10, ge=1, le=1000)
    distance_tolerance: float = Field(
        default=0.05, gt=0, description="m; for goals that state no tolerance"
    )
    orientation_tolerance: float = Field(
        default=0.1, gt=0, description="rad; for goals with a heading that state no tolerance"
    )
    clearance: float = Field(
        default=0.1, ge=0, description="m between footprint and obstacle along the path"
    )
    unknown_is_obstacle: bool = True
    planner_id: str = Field(default="RRTConnect", description="geometric planner of OMPL")
    planning_timeout: float = Field(default=1.0, gt=0, le=60, description="s")
    patience: float = Field(
        default=15.0, gt=0, description="s without a plan or progress before a goal is given up"
    )
    goals_from_topics: bool = Field(
        default=False,
        description="as an ActionServer, send oneself a goal for each message on goal_point",
    )
    location_timeout: float = Field(default=0.5, gt=0, description="s")
