"""The faults that the embedded robot can be given: their names, and orders for them.

Nothing here needs MuJoCo or ROS, so that a command line can check an order before it starts
anything.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kompass.simulation.faults.fault_parameters import PARAMETERS

if TYPE_CHECKING:
    from kompass.simulation.physics.robot_model import RobotModel
    from kompass.simulation.worlds.world import World

FAULTS = {
    "lidar_unplugged": "no scan is published",
    "scan_frozen": "every scan repeats the ranges of the first one, with a new stamp",
    "scan_rate_halved": "every other scan is left out",
    "scan_noise:METRES": "ranges scatter, by this standard deviation on top of the lidar's own",
    "scan_late:DELAY": "scans come so many seconds late, with their old stamps",
    "glass:SHARE": "the lidar sees through this share of walls and obstacles; they are solid",
    "mirrors:SHARE": "the lidar's rays are thrown back by this share of walls and obstacles",
    "odometry_frozen": "odometry and transforms repeat one pose and twist, with new stamps",
    "odometry_silent": "no odometry and no transforms are published",
    "odometry_late:DELAY": "odometry and transforms come so many seconds late, with old stamps",
    "localizer_jump:METRES": "the filtered pose is off by so much, in a direction of chance",
    "localizer_drift:RATE": "the filtered pose goes astray by so many metres per metre driven",
    "wheel_blocked": "the left wheel does not turn",
    "wheel_slip:WHEEL": "the left, the right or both wheels turn more than they move the robot",
    "battery_low": "the battery has no more than 12 %, and does not fill",
    "way_blocked": "a wall stands across the way, right ahead of the robot",
    "low_box": "a box of 10 cm, which a lidar looks over, stands in the way of a robot that has a "
    "camera",
    "boxed_in": "walls stand around the robot, too close to leave",
    "person_ahead": "a person steps into the robot's way and stands there",
    "person_crossing": "a person crosses the robot's way and is gone; the fault ends with that",
    "door_closed:DOORWAY": "a door closes a doorway of the world, which the map does not know",
    "map_withheld": "the map server has no map until /map_server/load_map is called",
    "start_occupied": "the map says that something stands where the robot is",
    "stop:NAME": "a process of the stack is stopped (SIGSTOP); it goes on when the fault ends",
    "kill:NAME": "a process of the stack is killed (SIGKILL), once",
}
# Faults of the machine. Only a drill has them: its processes, its network and its time are virtual.
MACHINE_FAULTS = {
    "starve:NAME": "every callback of a process takes twenty times longer",
    "hang:NAME": "a callback of a process does not return; it does when the fault ends",
    "flicker:NAME": "a process is stopped (SIGSTOP) and let go on, again and again",
    "disk_full": "no file can be written; what is in one already stays",
    "wrong:NAME": "a component answers wrongly: its paths, commands, maps or numbers are not right",
    "network_late:DELAY": "every message takes so many seconds longer",
    "network_loss:SHARE": "this share of the messages is lost, where nobody sends them again",
}
MAP_WITHHELD = "map_withheld"
AT_ONCE = "kill:"  # nothing is left of it that could end
# Followed by the name of a process or of a node in it; the first two, a robot in real time has too.
SIGNALLED = ("stop", "kill")
WRONG = "wrong:"
TARGETED = (*SIGNALLED, "starve", "hang", "flicker", "wrong")
DOOR_CLOSED = "door_closed"
# Others would run into it.
NEEDS_CAMERA = ("low_box",)
_ALL = {**FAULTS, **MACHINE_FAULTS}
_MACHINE_KINDS = {name.partition(":")[0] for name in MACHINE_FAULTS}


class UnknownFault(ValueError):
    """There is no such fault, or the order for it cannot be read; the message tells the remedy."""


@dataclass(frozen=True)
class FaultOrder:
    """A fault to be switched on some time after the start.

    Attributes
    ----------
    name
        One of ``FAULTS``, with its parameter in the place of what is in capitals.
    after
        Seconds after the start.
    duration
        Seconds after which it ends by itself; 0 for never.
    """

    name: str
    after: float = 0.0
    duration: float = 0.0


def check_fault(name: str) -> str:
    """``name`` as it is always written, if there is such a fault, of the robot or of the machine.

    Raises
    ------
    UnknownFault
        There is none, or its parameter cannot be read; the message tells the remedy.
    """
    kind, _, argument = name.partition(":")
    parameter = PARAMETERS.get(kind)
    if parameter is not None:
        example = f"write for example {kind}:{parameter.example}"
        if not argument:
            (whole,) = (one for one in _ALL if one.partition(":")[0] == kind)
            missing = whole.partition(":")[2]
            raise UnknownFault(f"fault {name!r} needs {missing} behind a colon; {example}")
        try:
            return f"{kind}:{parameter.read(argument)}"
        except ValueError as error:
            raise UnknownFault(f"fault {name!r}: {error}; {example}") from None
    if name in _ALL:
        return name
    known = [one.partition(":")[0] for one in _ALL]
    near = difflib.get_close_matches(kind, known, n=1, cutoff=0.6)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise UnknownFault(f"there is no fault {name!r}; {hint}known are {', '.join(FAULTS)}")


def is_of_machine(name: str) -> bool:
    """Whether only a drill has this fault."""
    return name.partition(":")[0] in _MACHINE_KINDS


def only_in_drills(name: str) -> str:
    """Why the embedded robot cannot be given a fault of the machine, and what can be done."""
    instead = {"hang": "stop", "flicker": "stop", "starve": "stop"}.get(name.partition(":")[0])
    target = name.partition(":")[2]
    hint = f"; {instead}:{target} is the nearest there is here" if instead else ""
    return (
        f"fault {name!r} is one of the machine, which only a drill has "
        f"(kompass-console drill RECIPE --faults {name}){hint}"
    )


def check_place(name: str, place: World) -> None:
    """Refuse a fault that a world has no room for: the closing of a door that it does not have.

    Raises
    ------
    UnknownFault
        With the doorways that there are.
    """
    kind, _, argument = name.partition(":")
    doors = [door.name for door in place.doorways]
    if kind == DOOR_CLOSED and argument not in doors:
        remedy = f"choose of {', '.join(doors)}" if doors else "take a world that has doorways"
        raise UnknownFault(
            f"fault {name!r}: the world {place.name!r} has no doorway {argument!r}; {remedy}"
        )


def check_camera(name: str, robot: RobotModel) -> None:
    """Refuse a fault that only a robot with a camera can see.

    Raises
    ------
    UnknownFault
        The robot has none.
    """
    if name in NEEDS_CAMERA and robot.camera is None:
        raise UnknownFault(
            f"fault {name!r}: the robot {robot.name} has no camera, and would run into it; take "
            "turtlebot3-plus"
        )


def parse_fault(text: str) -> FaultOrder:
    """Read ``NAME``, ``NAME:SECONDS`` or ``NAME:SECONDS:DURATION``, as on a command line.

    A fault that takes a parameter has it in its name: ``scan_noise:0.05:20`` begins after 20 s.

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
    name = check_fault(name)
    if is_of_machine(name):
        raise UnknownFault(only_in_drills(name))
    if name == MAP_WITHHELD and after:
        raise UnknownFault(
            f"fault {text!r}: a map that was given cannot be withheld; leave out {after:g}"
        )
    if duration and name.startswith(AT_ONCE):
        raise UnknownFault(f"fault {text!r}: it is over at once; leave out {duration:g}")
    return FaultOrder(name, after, duration)


def _split(text: str) -> tuple[str, list[float]]:
    """The name with its parameter, and up to two times behind it."""
    name, times = text, list[float]()
    colons = 1 if text.partition(":")[0] in PARAMETERS else 0
    while len(times) < 2 and name.count(":") > colons:
        before, _, last = name.rpartition(":")
        try:
            time = float(last)
        except ValueError:
            time = None
        if time is None:
            break
        name, times = before, [time, *times]
    return name, times


def parse_faults(
    texts: Iterable[str], place: World, robot: RobotModel | None = None
) -> list[FaultOrder]:
    """Read orders for a robot in a world; ``robot`` is None where it is not known yet.

    Raises
    ------
    UnknownFault
        One of them cannot be read, or not be carried out in that world or with that robot.
    """
    orders = [parse_fault(text) for text in texts]
    for order in orders:
        check_place(order.name, place)
        if robot is not None:
            check_camera(order.name, robot)
    return orders


def withholds_map(orders: Iterable[FaultOrder]) -> bool:
    """Whether the map server must start without a map."""
    return MAP_WITHHELD in [order.name for order in orders]


def help_text() -> str:
    """One line for each fault."""
    return "\n".join(f"{name}: {text}" for name, text in FAULTS.items())
