"""The faults that the embedded robot can be given: their names, and orders for them.

Nothing here needs MuJoCo or ROS, so that a command line can check an order before it starts
anything.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable
from dataclasses import dataclass

FAULTS = {
    "lidar_unplugged": "no scan is published",
    "scan_frozen": "every scan repeats the ranges of the first one, with a new stamp",
    "scan_rate_halved": "every other scan is left out",
    "odometry_frozen": "odometry and transforms repeat one pose and twist, with new stamps",
    "odometry_silent": "no odometry and no transforms are published",
    "wheel_blocked": "the left wheel does not turn",
    "way_blocked": "a wall stands across the way, right ahead of the robot",
    "boxed_in": "walls stand around the robot, too close to leave",
    "map_withheld": "the map server has no map until /map_server/load_map is called",
    "start_occupied": "the map says that something stands where the robot is",
    "stop:NAME": "a process of the stack is stopped (SIGSTOP); it goes on when the fault ends",
    "kill:NAME": "a process of the stack is killed (SIGKILL), once",
}
MAP_WITHHELD = "map_withheld"
AT_ONCE = "kill:"  # nothing is left of it that could end
TARGETED = ("stop", "kill")  # followed by the name of a process or of a node in it


class UnknownFault(ValueError):
    """There is no such fault, or the order for it cannot be read; the message tells the remedy."""


@dataclass(frozen=True)
class FaultOrder:
    """A fault to be switched on some time after the start.

    Attributes
    ----------
    name
        One of ``FAULTS``, with a process in the place of NAME.
    after
        Seconds after the start.
    duration
        Seconds after which it ends by itself; 0 for never.
    """

    name: str
    after: float = 0.0
    duration: float = 0.0


def check_fault(name: str) -> str:
    """``name``, if there is such a fault.

    Raises
    ------
    UnknownFault
        There is none; the message offers the nearest.
    """
    kind, colon, target = name.partition(":")
    if colon and kind in TARGETED:
        if not target:
            raise UnknownFault(f"fault {name!r} names no process; write for example {kind}:mapper")
        return name
    if name in FAULTS and kind not in TARGETED:
        return name
    if kind in TARGETED:
        raise UnknownFault(f"fault {name!r} names no process; write for example {kind}:mapper")
    known = [one.partition(":")[0] for one in FAULTS]
    near = difflib.get_close_matches(kind, known, n=1, cutoff=0.4)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise UnknownFault(f"there is no fault {name!r}; {hint}known are {', '.join(FAULTS)}")


def parse_fault(text: str) -> FaultOrder:
    """Read ``NAME``, ``NAME:SECONDS`` or ``NAME:SECONDS:DURATION``, as on a command line.

    Raises
    ------
    UnknownFault
        There is no such fault, or the seconds are none.
    """
    name, times = _split(text)
    for each in times:
        if not (math.isfinite(each) and each >= 0.0):
            raise UnknownFault(f"fault {text!r}: {each:g} s is no time; give seconds of 0 or more")
    after, duration = (*times, 0.0, 0.0)[:2]
    check_fault(name)
    if name == MAP_WITHHELD and after:
        raise UnknownFault(
            f"fault {text!r}: a map that was given cannot be withheld; leave out {after:g}"
        )
    if duration and name.startswith(AT_ONCE):
        raise UnknownFault(f"fault {text!r}: it is over at once; leave out {duration:g}")
    return FaultOrder(name, after, duration)


def _split(text: str) -> tuple[str, list[float]]:
    """The name, and up to two times behind it."""
    name, times = text, list[float]()
    while len(times) < 2:
        before, colon, last = name.rpartition(":")
        try:
            time = float(last) if colon else None
        except ValueError:
            time = None
        if time is None:
            break
        name, times = before, [time, *times]
    return name, times


def withholds_map(orders: Iterable[str]) -> bool:
    """Whether the map server must start without a map.

    Raises
    ------
    UnknownFault
        One of the orders cannot be read.
    """
    return MAP_WITHHELD in [parse_fault(text).name for text in orders]


def help_text() -> str:
    """One line for each fault."""
    return "\n".join(f"{name}: {text}" for name, text in FAULTS.items())
