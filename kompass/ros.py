"""The names with which a recipe speaks to ROS."""

import logging

from kompass import actions
from kompass.launch.launcher import Launcher
from kompass.porting import absent_names
from kompass.rclpy_ext.topic import AllowedTopics, QoSConfig, Topic
from kompass.recipe.action import Action
from kompass.recipe.clients import ActionClientConfig, ServiceClientConfig
from kompass.recipe.event import Event

logger = logging.getLogger("kompass")

__all__ = [
    "Action",
    "ActionClientConfig",
    "AllowedTopics",
    "Event",
    "Launcher",
    "QoSConfig",
    "ServiceClientConfig",
    "Topic",
    "actions",
    "logger",
]

__getattr__ = absent_names("kompass.ros")
