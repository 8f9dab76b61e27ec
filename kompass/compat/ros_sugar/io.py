"""Topics under the older import name."""

import sys

from kompass.porting import absent_names
from kompass.ros import AllowedTopics, QoSConfig, Topic

# Recipes name the modules below it too: ``from ros_sugar.io.topic import Topic``.
for _name in ("callbacks", "datatypes", "publisher", "supported_types", "topic", "utils"):
    sys.modules[f"{__name__}.{_name}"] = sys.modules[__name__]

__all__ = ["AllowedTopics", "QoSConfig", "Topic"]

__getattr__ = absent_names("ros_sugar.io")
