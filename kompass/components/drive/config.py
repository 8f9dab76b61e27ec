"""Settings of the drive manager."""

from collections.abc import Mapping
from typing import ClassVar

from pydantic import Field, model_validator

from kompass.components.base.mask_settings import MaskSettings


class DriveManagerConfig(MaskSettings):
    """What lies between a command and the wheels."""

    ignored_settings: ClassVar[Mapping[str, str]] = {
        "cmd_rate": "commands are sent at loop_rate",
        "closed_loop": "the base holds the commanded speed",
        "closed_loop_span": "the base holds the commanded speed",
        "cmd_tolerance": "the base holds the commanded speed",
        "smooth_commands": "accelerations are always limited",
        "critical_zone_angle": "the zone is the way that the body sweeps",
        "use_gpu": "the stop zone needs no GPU",
        "pointcloud_angle_resolution": "points of a cloud are told apart by cells of 5 cm",
    }

    loop_rate: float = Field(default=20.0, ge=1.0, le=1e3, description="Hz")
    critical_zone_distance: float = Field(
        default=0.05, gt=0, le=10, description="m from the footprint; nearer means stop"
    )
    slowdown_zone_distance: float = Field(
        default=0.2, gt=0, le=100, description="m from the footprint; nearer means slower"
    )
    disable_safety_stop: bool = False
    scan_timeout: float = Field(
        default=0.5, gt=0, le=60, description="s; an older scan stops the robot"
    )
    odometry_timeout: float = Field(
        default=0.5, gt=0, le=60, description="s; an older odometry stops the robot"
    )
    odometry_jump: float = Field(
        default=0.5,
        gt=0,
        le=1e6,
        description="m beyond what can be driven meanwhile; an odometry that jumps to and fro by "
        "more stops the robot",
    )
    missed_messages: int = Field(
        default=3,
        ge=1,
        le=1000,
        description="scans or odometries in a row whose absence stops the robot, after 0.3 s at "
        "the soonest and after their timeout at the latest",
    )
    command_timeout: float = Field(
        default=0.3, gt=0, le=60, description="s after the last command has run out"
    )
    use_without_scan_sensor: bool = Field(
        default=False, description="drive without a scan too; one that is there still counts"
    )

    command_publishers: int = Field(
        default=1,
        ge=1,
        le=100,
        description="nodes that may publish on each of its command topics; more stop the robot",
    )

    @model_validator(mode="after")
    def _zones_nest(self) -> "DriveManagerConfig":
        if self.slowdown_zone_distance <= self.critical_zone_distance:
            raise ValueError(
                f"slowdown_zone_distance = {self.slowdown_zone_distance} must be greater than "
                f"critical_zone_distance = {self.critical_zone_distance}"
            )
        return self
