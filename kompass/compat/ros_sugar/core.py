"""The core classes under the older import name."""

import sys

from kompass.actions import Action
from kompass.components.base.base_component import BaseComponent
from kompass.porting import absent_names
from kompass.ros import Event

# Recipes name the modules below it too: ``from ros_sugar.core.event import Event``.
for _name in ("action", "component", "event", "fallbacks", "monitor", "routine", "status"):
    sys.modules[f"{__name__}.{_name}"] = sys.modules[__name__]

__all__ = ["Action", "BaseComponent", "Event"]

__getattr__ = absent_names("ros_sugar.core")
