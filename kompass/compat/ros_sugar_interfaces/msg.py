"""Messages under an older import name: the very same classes, so that types match on the wire."""

from automatika_ros_sugar.msg import ComponentStatus

__all__ = ["ComponentStatus"]
