"""What the robot's nodes log, as pages are told of it."""

from __future__ import annotations

from typing import Literal, get_args

from pydantic import BaseModel

LogLevel = Literal["debug", "info", "warning", "error", "fatal"]
LOG_LEVELS: tuple[LogLevel, ...] = get_args(LogLevel)  # the least first


class LogLine(BaseModel):
    """One message of a node's log.

    Attributes
    ----------
    number
        Counts the lines since the console was started.
    time
        When it was written (s since the epoch, by the clock of whoever wrote it).
    node
        The logger: a node's name, or one below it.
    text
        May have several lines.
    where
        Function, file and line of the program that wrote it; empty where that is not told.
    left_out
        How many lines before this one, at least, there was no room for.
    """

    number: int
    time: float
    level: LogLevel
    node: str
    text: str
    where: str
    left_out: int = 0


class LogPage(BaseModel):
    """The newest lines of the robot's log that were asked for, newest first.

    `more` says that there are others between the last of them and what was asked for; `nodes` are
    all loggers of which there are lines, and `newest` the number of the last line of all.
    """

    lines: list[LogLine]
    more: bool
    newest: int
    nodes: list[str]
