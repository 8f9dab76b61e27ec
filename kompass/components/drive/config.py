"""Settings of the drive manager."""

from pydantic import Field, model_validator

from kompass.components.base.component_config import ComponentConfig


class DriveManagerConfig(ComponentConfig):
    """What lies between a command and the wheels."""

    loop_rate: float = Field(default=20.0, ge=1.0, le=1e3, description="Hz")
    critical_zone_distance: float = Field(
        default=0.05, gt=0, description="m from the footprint; nearer means stop"
    )
    slowdown_zone_distance: float = Field(
        default=0.2, gt=0, description="m from the footprint; nearer means slower"
    )
    disable_safety_stop: bool = False
    scan_timeout: float = Field(default=0.5, gt=0, description="s; an older scan stops the robot")
    odometry_timeout: float = Field(
        default=0.5, gt=0, description="s; an older odometry stops the robot"
    )
    command_timeout: float = Field(
        default=0.3, gt=0, description="s after the last command has run out"
    )

    use_without_scan_sensor: bool = Field(
        default=False, description="drive without a scan too; one that is there still counts"
    )
    closed_loop: bool = Field(
        default=True, description="without effect: the base holds the commanded speed"
    )
    closed_loop_span: int = Field(default=3, ge=1, le=10, description="without effect")
    cmd_tolerance: float = Field(default=0.01, ge=0, description="without effect")
    smooth_commands: bool = Field(
        default=True, description="without effect: accelerations are always limited"
    )
    critical_zone_angle: float = Field(
        default=45.0,
        gt=0,
        le=360,
        description="degrees; without effect: the zone is the way that the body sweeps",
    )
    use_gpu: bool = Field(default=False, description="without effect")
    pointcloud_angle_resolution: float = Field(default=0.1, gt=0, description="without effect")

    @model_validator(mode="after")
    def _zones_nest(self) -> "DriveManagerConfig":
        if self.slowdown_zone_distance <= self.critical_zone_distance:
            raise ValueError(
                f"slowdown_zone_distance = {self.slowdown_zone_distance} must be greater than "
                f"critical_zone_distance = {self.critical_zone_distance}"
            )
        return self
