"""The global planner, and the life of a goal."""

from kompass.porting import absent_names

__getattr__ = absent_names("kompass.components.planner")
