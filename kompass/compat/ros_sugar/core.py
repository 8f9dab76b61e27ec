"""The core classes under the older import name."""

import sys

from kompass.actions import Action
from kompass.ros import Event

# Recipes name the modules below it too: ``from ros_sugar.core.event import Event``.
for _name in ("action", "event"):
    sys.modules[f"{__name__}.{_name}"] = sys.modules[__name__]

__all__ = ["Action", "Event"]
