"""What nodes write for people, collected."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, NamedTuple

from kompass.virtual.scheduler import Scheduler

LEVELS = ("debug", "info", "warning", "error", "fatal")


class LogEntry(NamedTuple):
    """A line of the log.

    Attributes
    ----------
    time
        Monotonic [ns].
    node
        Name of the logger: that of the node, with its namespace.
    """

    time: int
    node: str
    level: str
    text: str


Write = Callable[[LogEntry], object]


class VirtualLog:
    """The log of a node; see :class:`kompass.bus.node.Log`.

    Parameters
    ----------
    write
        Takes the lines.
    """

    def __init__(self, name: str, scheduler: Scheduler, write: Write) -> None:
        self._name, self._scheduler, self._write = name, scheduler, write
        self._level = LEVELS.index("info")
        self._written: dict[tuple[str, int], int] = {}

    @property
    def name(self) -> str:
        return self._name

    def set_level(self, level: str) -> None:
        """From which level on is written.

        Raises
        ------
        ValueError
            When there is none of that name.
        """
        if level not in LEVELS:
            raise ValueError(f"level = {level!r} of a log is none of {', '.join(LEVELS)}")
        self._level = LEVELS.index(level)

    def debug(self, message: str, **options: Any) -> bool:
        return self._log("debug", message, **options)

    def info(self, message: str, **options: Any) -> bool:
        return self._log("info", message, **options)

    def warning(self, message: str, **options: Any) -> bool:
        return self._log("warning", message, **options)

    def error(self, message: str, **options: Any) -> bool:
        return self._log("error", message, **options)

    def fatal(self, message: str, **options: Any) -> bool:
        return self._log("fatal", message, **options)

    def _log(self, level: str, message: str, *, throttle_duration_sec: float = 0.0) -> bool:
        if LEVELS.index(level) < self._level:
            return False
        now = self._scheduler.now
        if throttle_duration_sec:
            # As rclpy does: each line of code that writes is held back by itself.
            caller = sys._getframe(2)
            place = caller.f_code.co_filename, caller.f_lineno
            before = self._written.get(place)
            if before is not None and now - before < throttle_duration_sec * 1e9:
                return False
            self._written[place] = now
        self._write(LogEntry(now, self._name, level, str(message)))
        return True
