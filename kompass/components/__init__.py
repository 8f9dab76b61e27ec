"""The components of the navigation stack."""

from kompass.components.actions import component_action
from kompass.components.component import Component
from kompass.components.component_config import ComponentConfig, ComponentRunType
from kompass.components.controller import Controller
from kompass.components.controller_config import ControllerConfig
from kompass.components.drive_config import DriveManagerConfig
from kompass.components.drive_manager import DriveManager
from kompass.components.map_server import MapServer, MapServerConfig
from kompass.components.mapper import LocalMapper, LocalMapperConfig, MapConfig
from kompass.components.planner import Planner
from kompass.components.planner_config import PlannerConfig
from kompass.components.topics_keys import TopicsKeys

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
    "Planner",
    "PlannerConfig",
    "TopicsKeys",
    "component_action",
]
