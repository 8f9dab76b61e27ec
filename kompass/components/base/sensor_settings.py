"""Settings of components that see what is around the robot."""

import math

from pydantic import Field, model_validator

from kompass.algorithms.mapping.cloud_view import HeightBand
from kompass.components.base.component_config import ComponentConfig

OVERHEAD = 0.1  # m above the robot that count as in its way, unless stated


class SensorSettings(ComponentConfig):
    """What of a point cloud counts; planar scans need none of these."""

    cloud_min_height: float = Field(
        default=0.05,
        ge=-10,
        le=10,
        description="m above the robot's frame; what a point cloud shows lower is the floor",
    )
    cloud_max_height: float | None = Field(
        default=None,
        ge=-10,
        le=100,
        description="m above the robot's frame, of what it goes under; its height and 0.1 m when "
        "left out",
    )
    cloud_memory: float = Field(
        default=20.0,
        ge=0,
        le=3600,
        description="s for which what a cloud has shown within 2 m counts while it is out of sight",
    )
    clouds_may_be_empty: bool = Field(
        default=False,
        description="a cloud without points says that nothing is there, as one of which a filter "
        "has left only obstacles; otherwise that its sensor is covered",
    )

    @model_validator(mode="after")
    def _is_a_band(self) -> "SensorSettings":
        low, high = self.cloud_min_height, self.cloud_max_height
        if high is not None and high <= low:
            raise ValueError(
                f"cloud_max_height = {high:g} m is not above cloud_min_height = {low:g} m; nothing "
                "would be in the way"
            )
        return self

    @property
    def height_band(self) -> HeightBand:
        """In which heights what a cloud shows is in the way; without a robot, in all."""
        high = self.cloud_max_height
        if high is None:
            high = math.inf if self.robot is None else self.robot.height + OVERHEAD
        return HeightBand(self.cloud_min_height, high)
