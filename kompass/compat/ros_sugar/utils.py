"""What marks the actions of components, under the older import name."""

from kompass.components import component_action
from kompass.porting import absent_names

__all__ = ["component_action"]

__getattr__ = absent_names("ros_sugar.utils")
