"""Settings of the controller."""

import enum
import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, model_validator

from kompass.components.base.mask_settings import MaskSettings
from kompass.components.controller.controllers_id import ControllersID
from kompass.components.controller.follower_settings import (
    DVZConfig,
    DWAConfig,
    MPPIConfig,
    PurePursuitConfig,
    StanleyConfig,
    VisionRGBDFollowerConfig,
    VisionRGBFollowerConfig,
)


class CmdPublishType(enum.Enum):
    """How commands leave the controller."""

    TWIST_SEQUENCE = "Sequence"
    TWIST_PARALLEL = "Parallel"
    TWIST_ARRAY = "Array"


def _by_value(kind: type[enum.Enum]) -> Any:
    def read(value: Any) -> Any:
        if isinstance(value, str):
            for member in kind:
                if value.lower() in (member.value.lower(), member.name.lower()):
                    return member
            known = ", ".join(member.value for member in kind)
            raise ValueError(f"{value!r} is none of {known}")
        return value

    return BeforeValidator(read)


class ControllerConfig(MaskSettings):
    """How a path becomes commands."""

    ignored_settings: ClassVar[Mapping[str, str]] = {
        "prediction_horizon": "it is a setting of the algorithm's section",
        "debug": "what the controller does is on its topics and in its log",
    }

    loop_rate: float = Field(default=20.0, ge=0.1, le=1e3, description="Hz")
    algorithm: Annotated[ControllersID, _by_value(ControllersID)] = ControllersID.MPPI
    control_time_step: float = Field(
        default=0.1, gt=0, le=10, description="s that one command holds"
    )
    ctrl_publish_type: Annotated[CmdPublishType, _by_value(CmdPublishType)] = (
        CmdPublishType.TWIST_ARRAY
    )
    use_direct_sensor: bool = Field(
        default=False,
        description="DWA, DVZ and MPPI take obstacles from the scan itself instead of the local "
        "map; MPPI then tells what moves",
    )
    sensor_timeout: float = Field(
        default=0.5,
        gt=0,
        le=60,
        description="s; an older scan, local map or detection stops the robot",
    )
    location_timeout: float = Field(default=0.5, gt=0, le=60, description="s; an older pose stops")
    progress_timeout: float = Field(
        default=5.0, gt=0, le=3600, description="s; a robot that gets nowhere for so long is stuck"
    )
    patience: float = Field(
        default=20.0, gt=0, le=3600, description="s without progress that end a goal"
    )
    paths_folder: str | None = Field(
        default=None,
        description="from which relative places of files of ControlPath set out; `paths` in the "
        "robot's folder unless given",
    )
    goal_dist_tolerance: float = Field(default=0.03, gt=0, le=10, description="m")
    goal_orientation_tolerance: float = Field(default=0.05, gt=0, le=math.pi, description="rad")
    DWA: DWAConfig = Field(default_factory=DWAConfig)
    DVZ: DVZConfig = Field(default_factory=DVZConfig)
    MPPI: MPPIConfig = Field(default_factory=MPPIConfig)
    Stanley: StanleyConfig = Field(default_factory=StanleyConfig)
    PurePursuit: PurePursuitConfig = Field(default_factory=PurePursuitConfig)
    VisionRGBFollower: VisionRGBFollowerConfig = Field(default_factory=VisionRGBFollowerConfig)
    VisionRGBDFollower: VisionRGBDFollowerConfig = Field(default_factory=VisionRGBDFollowerConfig)

    @model_validator(mode="after")
    def _can_be_driven(self) -> "ControllerConfig":
        steered = self.robot is not None and self.robot.turning_radius > 0
        if steered and self.algorithm is ControllersID.DWA:
            raise ValueError(
                "algorithm = DWA, and model_type of the robot is ACKERMANN: DWA turns on the spot "
                "to get round things, which steered wheels cannot; choose MPPI, which looks at "
                "obstacles, too, or PurePursuit or Stanley"
            )
        return self
