"""The path-following algorithms and their settings, as recipes name them."""

from kompass.components.controller.controllers_id import ControllersID
from kompass.components.controller.follower_settings import (
    DWAConfig,
    PurePursuitConfig,
    StanleyConfig,
)
from kompass.components.mapping.mapper import MapConfig

__all__ = [
    "ControllersID",
    "DWAConfig",
    "MapConfig",
    "PurePursuitConfig",
    "StanleyConfig",
]
