"""The core classes under the older import name."""

import sys

from kompass.actions import Action
from kompass.components.base.base_component import BaseComponent
from kompass.ros import Event

# Recipes name the modules below it too: ``from ros_sugar.core.event import Event``.
for _name in ("action", "component", "event"):
    sys.modules[f"{__name__}.{_name}"] = sys.modules[__name__]

__all__ = ["Action", "BaseComponent", "Event"]
