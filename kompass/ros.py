"""The names with which a recipe speaks to ROS."""

from kompass.components.topic import AllowedTopics, QoSConfig, Topic
from kompass.launch.launcher import Launcher

__all__ = ["AllowedTopics", "Launcher", "QoSConfig", "Topic"]
