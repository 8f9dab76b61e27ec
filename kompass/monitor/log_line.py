"""Write to the ROS log at a level that is not known before."""

from __future__ import annotations

from typing import Any


def write_log(logger: Any, level: str, text: str) -> None:
    """Write a line at "debug", "info", "warning" or "error".

    rclpy keeps the severity of each line of code that logs, and raises when it changes: so each has
    a line of its own.
    """
    match level:
        case "debug":
            logger.debug(text)
        case "info":
            logger.info(text)
        case "warning":
            logger.warning(text)
        case _:
            logger.error(text)
