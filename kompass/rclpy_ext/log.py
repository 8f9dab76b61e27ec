"""Write to the ROS log without looking for the line of code that called."""

from __future__ import annotations

from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.logging import LoggingSeverity

from kompass.printable import printable

_SEVERITIES = {
    "debug": LoggingSeverity.DEBUG,
    "info": LoggingSeverity.INFO,
    "warning": LoggingSeverity.WARN,
    "error": LoggingSeverity.ERROR,
}


def write_log(logger: Any, level: str, text: str) -> None:
    """Write a line to the ROS log.

    rclpy's own methods (7.1.6) find out which line of code called them, which takes longer than all
    else that the monitor does about a firing (1.5 ms: they look at files), and they raise when one
    line logs at two severities. What a rule did has no interesting line of code.

    Parameters
    ----------
    logger
        Of a node.
    level
        "debug", "info", "warning" or "error".
    text
        The line; what could steer a terminal is escaped.
    """
    severity = _SEVERITIES[level]
    if logger.is_enabled_for(severity):
        line = printable(text)
        rclpy_implementation.rclpy_logging_rcutils_log(severity, logger.name, line, "", "", 0)
