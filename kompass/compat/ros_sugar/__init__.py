"""Import names of recipes written for the ros_sugar package; the things live in kompass."""

from kompass.ros import Launcher

__all__ = ["Launcher"]
