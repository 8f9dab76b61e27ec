"""The path-following algorithms and their settings, as recipes name them."""

from kompass.components.controllers_id import ControllersID
from kompass.components.follower_settings import DWAConfig, PurePursuitConfig, StanleyConfig
from kompass.components.mapper import MapConfig

__all__ = [
    "ControllersID",
    "DWAConfig",
    "MapConfig",
    "PurePursuitConfig",
    "StanleyConfig",
]
