"""Control algorithms under the older import name."""

from kompass.control import (
    ControllersID,
    DVZConfig,
    DWAConfig,
    PurePursuitConfig,
    StanleyConfig,
    VisionRGBDFollowerConfig,
    VisionRGBFollowerConfig,
)
from kompass.porting import absent_names

__all__ = [
    "ControllersID",
    "DVZConfig",
    "DWAConfig",
    "PurePursuitConfig",
    "StanleyConfig",
    "VisionRGBDFollowerConfig",
    "VisionRGBFollowerConfig",
]

__getattr__ = absent_names("kompass_core.control")
