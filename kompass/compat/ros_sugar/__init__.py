"""Import names of recipes written for the ros_sugar package; the things live in kompass."""

from kompass.porting import absent_names
from kompass.ros import Launcher

__all__ = ["Launcher"]

__getattr__ = absent_names("ros_sugar")
