"""The core classes under the older import name."""

from kompass.actions import Action
from kompass.ros import Event

__all__ = ["Action", "Event"]
