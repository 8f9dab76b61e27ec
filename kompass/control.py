"""The path-following algorithms and their settings, as recipes name them."""

from kompass.components.controller.controllers_id import ControllersID
from kompass.components.controller.follower_settings import (
    DWAConfig,
    MPPIConfig,
    PurePursuitConfig,
    StanleyConfig,
)
from kompass.components.mapping.mapper import MapConfig, ScanModelConfig
from kompass.porting import absent_names

__all__ = [
    "ControllersID",
    "DWAConfig",
    "MPPIConfig",
    "MapConfig",
    "PurePursuitConfig",
    "ScanModelConfig",
    "StanleyConfig",
]

__getattr__ = absent_names("kompass.control")
