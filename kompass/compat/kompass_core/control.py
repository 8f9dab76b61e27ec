"""Control algorithms under the older import name."""

from kompass.control import ControllersID

__all__ = ["ControllersID"]
