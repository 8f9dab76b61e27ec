"""The components of the navigation stack."""

from kompass.components.base.actions import component_action
from kompass.components.base.component import Component
from kompass.components.base.component_config import ComponentConfig, ComponentRunType
from kompass.components.controller.config import ControllerConfig
from kompass.components.controller.controller import Controller
from kompass.components.drive.config import DriveManagerConfig
from kompass.components.drive.drive_manager import DriveManager
from kompass.components.mapping.map_server import MapServer, MapServerConfig
from kompass.components.mapping.mapper import LocalMapper, LocalMapperConfig, MapConfig
from kompass.components.motion.config import MotionServerConfig
from kompass.components.motion.motion_server import MotionServer
from kompass.components.planner.config import PlannerConfig
from kompass.components.planner.planner import Planner
from kompass.components.topics_keys import TopicsKeys
from kompass.porting import absent_names

__all__ = [
    "Component",
    "ComponentConfig",
    "ComponentRunType",
    "Controller",
    "ControllerConfig",
    "DriveManager",
    "DriveManagerConfig",
    "LocalMapper",
    "LocalMapperConfig",
    "MapConfig",
    "MapServer",
    "MapServerConfig",
    "MotionServer",
    "MotionServerConfig",
    "Planner",
    "PlannerConfig",
    "TopicsKeys",
    "component_action",
]

__getattr__ = absent_names("kompass.components")
