"""The launcher under an older import name."""

from kompass.launch.launcher import Launcher

__all__ = ["Launcher"]
