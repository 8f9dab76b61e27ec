"""The robot's log (/rosout): heard without ever being held up by it.

Whoever logs in a loop writes tens of thousands of lines a second. To be called for each of them
would keep this process from all else, STOP included. So nobody is called: what DDS has kept is
looked at ten times a second, as bytes; of these a few are read, the worst first, and the rest is
counted.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

from kompass_console.link.log_ring import LogRing
from kompass_console.schema.log_models import LogLevel, LogLine
from kompass_console.schema.models import LogInfo
from kompass_console.schema.plain import LONGEST_LABEL, plain, plain_lines

TOPIC = "/rosout"
PERIOD = 0.1  # s between two looks
KEPT = 40  # lines of one look

_WAIT = 1000  # messages that DDS keeps in between; more are lost, and not even counted
# As nodes offer it: who comes later hears of the last ten seconds.
_QOS = QoSProfile(
    depth=_WAIT,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
_AT = 12  # where the level is in a message's bytes: behind the encapsulation and the stamp
_LEVELS: tuple[tuple[int, LogLevel], ...] = (
    (50, "fatal"),
    (40, "error"),
    (30, "warning"),
    (20, "info"),
)


class Rosout:
    """Looks at the log with a node that no executor serves.

    Parameters
    ----------
    node
        For nothing else, and not on any executor.
    ring
        Where the lines go.
    """

    def __init__(self, node: Node, ring: LogRing) -> None:
        self._node = node
        self._ring = ring
        self._subscription: Any = node.create_subscription(Log, TOPIC, _never, _QOS, raw=True)

    def look(self) -> None:
        """Take what has come. On one thread."""
        taken: list[bytes] = []
        with self._subscription.handle:
            while len(taken) < _WAIT:
                found = self._subscription.handle.take_message(Log, True)
                if found is None:
                    break
                taken.append(found[0])
        if taken:
            chosen = worst(taken, KEPT)
            lines = [_line(deserialize_message(raw, Log)) for raw in chosen]
            self._ring.add(lines, len(taken) - len(lines))

    def info(self) -> LogInfo:
        """By what pages see that they have to ask again."""
        return LogInfo(
            available=self._node.count_publishers(TOPIC) > 0,
            newest=self._ring.newest,
            newest_warning=self._ring.newest_warning,
        )


def worst(messages: Sequence[bytes], most: int) -> list[bytes]:
    """Of serialized messages the worst, and of those the newest, in the order in which they came.

    A few lines that say what is wrong are worth more than many that say that all goes on.
    """
    if len(messages) <= most:
        return list(messages)
    order = sorted(range(len(messages)), key=lambda i: (messages[i][_AT : _AT + 1], i))
    return [messages[i] for i in sorted(order[-most:])]


def level_of(number: int) -> LogLevel:
    """The name of a level of ROS; numbers between two count as the lower one."""
    return next((level for least, level in _LEVELS if number >= least), "debug")


def _line(message: Any) -> LogLine:
    where = ""
    if message.file:
        file = plain(message.file, LONGEST_LABEL).rsplit("/", 1)[-1]
        function = plain(message.function, LONGEST_LABEL)
        where = f"{function}, {file}:{message.line}" if function else f"{file}:{message.line}"
    return LogLine(
        number=0,
        time=message.stamp.sec + message.stamp.nanosec * 1e-9,
        level=level_of(message.level),
        node=plain(message.name, LONGEST_LABEL),
        text=plain_lines(message.msg),
        where=where,
    )


def _never(_: object) -> None:
    raise AssertionError("no executor serves this node")
