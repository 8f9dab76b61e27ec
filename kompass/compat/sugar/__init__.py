"""Import name of the interface package up to 2024; the interfaces live in automatika_ros_sugar."""

from kompass.launch.launcher import Launcher

__all__ = ["Launcher"]
