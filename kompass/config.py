"""Configuration: validated models, and the files that fill them."""

from kompass.components.base.component_config import ComponentConfig, ComponentRunType
from kompass.porting import absent_names
from kompass.robot import RobotConfig, RobotFrames
from kompass.settings import Settings
from kompass.zones.mask import Mask

BaseComponentConfig = ComponentConfig

__all__ = [
    "BaseComponentConfig",
    "ComponentConfig",
    "ComponentRunType",
    "Mask",
    "RobotConfig",
    "RobotFrames",
    "Settings",
]

__getattr__ = absent_names("kompass.config")
