"""The controller, its settings, and where it sees obstacles."""

from kompass.porting import absent_names

__getattr__ = absent_names("kompass.components.controller")
