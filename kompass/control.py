"""The algorithms of the controller and their settings, as recipes name them."""

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
from kompass.components.mapping.mapper import MapConfig, ScanModelConfig
from kompass.porting import absent_names

__all__ = [
    "ControllersID",
    "DVZConfig",
    "DWAConfig",
    "MPPIConfig",
    "MapConfig",
    "PurePursuitConfig",
    "ScanModelConfig",
    "StanleyConfig",
    "VisionRGBDFollowerConfig",
    "VisionRGBFollowerConfig",
]

__getattr__ = absent_names("kompass.control")
