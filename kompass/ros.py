"""The names with which a recipe speaks to ROS."""

from kompass import actions
from kompass.components.topic import AllowedTopics, QoSConfig, Topic
from kompass.launch.launcher import Launcher
from kompass.recipe.action import Action
from kompass.recipe.event import Event

__all__ = ["Action", "AllowedTopics", "Event", "Launcher", "QoSConfig", "Topic", "actions"]
