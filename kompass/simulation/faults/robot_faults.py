"""Faults of the robot itself and of the place it is in: broken parts, walls, doors and people."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Protocol

import numpy as np

from kompass.simulation.faults import faulty_parts as faulty
from kompass.simulation.faults.fault_manager import NotYet
from kompass.simulation.faults.fault_names import DOOR_CLOSED, check_camera, check_place
from kompass.simulation.physics import person
from kompass.simulation.physics.barriers import ACROSS_GAP, Barriers
from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.shapes import Box

SLIP = 0.4  # share of its turning that a slipping wheel loses
HEADING_JUMP = math.radians(20.0)  # at most, of a localizer that loses its place
_DOOR_CLEARANCE = 0.05  # m from the robot's shell to a door that closes
# Of a robot that brakes for what has come into its way: s until it does, and how hard [m/s²].
_NOTICED, _BRAKES = 0.3, 1.5
_TRAVELS = 0.01  # m/s; faster backwards, and the way ahead is behind


_SLOTS = ("battery", "drive", "lidar", "localizer", "wheels")


class _FaultyPart(Protocol):
    sound: Any


# By the attribute of the robot that a part stands in for.
_Parts = Mapping[str, _FaultyPart]
_Break = Callable[[SimulatedRobot, str, np.random.Generator], _Parts]


def _lidar_unplugged(robot: SimulatedRobot, _: str, __: np.random.Generator) -> _Parts:
    return {"lidar": faulty.UnpluggedLidar(robot.lidar)}


def _scan_frozen(robot: SimulatedRobot, _: str, __: np.random.Generator) -> _Parts:
    return {"lidar": faulty.FrozenLidar(robot.lidar)}


def _scan_rate_halved(robot: SimulatedRobot, _: str, __: np.random.Generator) -> _Parts:
    return {"lidar": faulty.SlowLidar(robot.lidar)}


def _scan_noise(robot: SimulatedRobot, metres: str, random: np.random.Generator) -> _Parts:
    return {"lidar": faulty.NoisyLidar(robot.lidar, float(metres), random, robot.kind.lidar)}


def _scan_late(robot: SimulatedRobot, delay: str, _: np.random.Generator) -> _Parts:
    return {"lidar": faulty.LateLidar(robot.lidar, float(delay), lambda: robot.time)}


def _odometry_frozen(robot: SimulatedRobot, _: str, __: np.random.Generator) -> _Parts:
    return {
        "localizer": faulty.FrozenLocalizer(robot.localizer),
        "wheels": faulty.FrozenOdometry(robot.wheels),
    }


def _odometry_silent(robot: SimulatedRobot, _: str, __: np.random.Generator) -> _Parts:
    return {
        "localizer": faulty.SilentLocalizer(robot.localizer),
        "wheels": faulty.SilentOdometry(robot.wheels),
    }


def _odometry_late(robot: SimulatedRobot, delay: str, _: np.random.Generator) -> _Parts:
    return {
        "localizer": faulty.LateLocalizer(robot.localizer, float(delay), lambda: robot.time),
        "wheels": faulty.LateOdometry(robot.wheels, float(delay), lambda: robot.time),
    }


def _localizer_jump(robot: SimulatedRobot, metres: str, random: np.random.Generator) -> _Parts:
    direction = random.uniform(0.0, math.tau)
    turn = random.uniform(-HEADING_JUMP, HEADING_JUMP)
    x, y = float(metres) * math.cos(direction), float(metres) * math.sin(direction)
    return {"localizer": faulty.JumpedLocalizer(robot.localizer, (x, y, turn))}


def _localizer_drift(robot: SimulatedRobot, rate: str, random: np.random.Generator) -> _Parts:
    direction = random.uniform(0.0, math.tau)
    return {"localizer": faulty.DriftingLocalizer(robot.localizer, float(rate), direction)}


def _wheel_blocked(robot: SimulatedRobot, _: str, __: np.random.Generator) -> _Parts:
    return {"drive": faulty.BlockedWheelDrive(robot.drive)}


def _wheel_slip(robot: SimulatedRobot, wheel: str, _: np.random.Generator) -> _Parts:
    return {"drive": faulty.SlippingDrive(robot.drive, _grip(wheel))}


def _grip(wheel: str) -> tuple[float, float]:
    """Which share of the turning of (left, right) moves the robot when ``wheel`` slips."""
    slipping = 1.0 - SLIP
    return (1.0 if wheel == "right" else slipping), (1.0 if wheel == "left" else slipping)


def _battery_low(robot: SimulatedRobot, _: str, __: np.random.Generator) -> _Parts:
    return {"battery": faulty.LowBattery(robot.battery)}


_PARTS: dict[str, _Break] = {
    "lidar_unplugged": _lidar_unplugged,
    "scan_frozen": _scan_frozen,
    "scan_rate_halved": _scan_rate_halved,
    "scan_noise": _scan_noise,
    "scan_late": _scan_late,
    "odometry_frozen": _odometry_frozen,
    "odometry_silent": _odometry_silent,
    "odometry_late": _odometry_late,
    "localizer_jump": _localizer_jump,
    "localizer_drift": _localizer_drift,
    "wheel_blocked": _wheel_blocked,
    "wheel_slip": _wheel_slip,
    "battery_low": _battery_low,
}
_WALLS = ("way_blocked", "low_box", "boxed_in")
_AHEAD = ("way_blocked", "low_box")
_SURFACES = ("glass", "mirrors")
# Who comes, how the way is found, and whether it ends with the person's being through.
_PEOPLE = {
    "person_ahead": (person.AHEAD, person.step_in, False),
    "person_crossing": (person.CROSSING, person.cross, True),
}
ROBOT_FAULTS = (*_PARTS, *_WALLS, *_SURFACES, *_PEOPLE, DOOR_CLOSED)


class RobotFaults:
    """Breaks and repairs one robot. Faults may overlap and end in any order.

    Each beginning of a fault has chances of its own, drawn from the robot's seed, which other
    faults do not change.

    Parameters
    ----------
    robot
        As it was built; its parts are taken for sound.
    """

    def __init__(self, robot: SimulatedRobot) -> None:
        self._robot = robot
        walls = Barriers(robot.kind.radius)
        self._walls = {
            "way_blocked": walls.across,
            "low_box": walls.low,
            "boxed_in": walls.box,
        }
        self._sound = {slot: getattr(robot, slot) for slot in _SLOTS}
        self._active: dict[str, _Parts] = {}
        self._begun: dict[str, int] = {}
        self._surfaces: dict[str, frozenset[str]] = {}
        self._people: dict[str, person.Person] = {}

    @property
    def active(self) -> tuple[str, ...]:
        """Faults that are on, in the order in which they came."""
        return tuple(self._active)

    def knows(self, name: str) -> bool:
        """Whether it is one of ``ROBOT_FAULTS``, with or without a parameter."""
        return _kind(name) in ROBOT_FAULTS

    def begin(self, name: str) -> bool:
        """Switch a fault on, as ``check_fault`` returns it; nothing happens when it is.

        Raises
        ------
        UnknownFault
            The world has no such doorway, or the robot no camera to see with what stands there.
        NotYet
            There is no room for a person ahead of the robot, or it stands in the doorway.
        """
        if name in self._active:
            return True
        check_camera(name, self._robot.kind)
        kind, _, argument = name.partition(":")
        random = self._robot.chance(f"{name} {self._begun.get(name, 0)}")
        parts: _Parts = {}
        if kind in _PARTS:
            parts = _PARTS[kind](self._robot, argument, random)
        elif kind in _WALLS:
            self._robot.put_up(self._walls[kind], ahead=self._braking() if kind in _AHEAD else 0.0)
        elif kind in _SURFACES:
            self._surfaces[name] = self._some_solids(float(argument), random)
        elif kind in _PEOPLE:
            self._let_in(kind, random)
        else:
            self._close_door(name, argument)
        self._active[name] = parts
        self._begun[name] = self._begun.get(name, 0) + 1
        self._rebuild()
        return True

    def end(self, name: str) -> None:
        """Switch it off; but for where the robot has come to, it might never have been on."""
        if name not in self._active:
            return
        del self._active[name]
        kind, _, argument = name.partition(":")
        self._surfaces.pop(name, None)
        if kind in _WALLS:
            self._robot.take_down(self._walls[kind])
        elif kind in _PEOPLE:
            self._robot.send_away(self._people.pop(kind))
        elif kind == DOOR_CLOSED:
            self._robot.open_door(self._door(argument))
        self._rebuild()

    def ended(self) -> Iterable[str]:
        """People who have crossed."""
        through = [name for name, walker in self._people.items() if walker.gone]
        for name in through:
            self.end(name)
        return through

    def _rebuild(self) -> None:
        """Put the broken parts in front of the sound ones, in the order in which they broke."""
        robot = self._robot
        for slot, sound in self._sound.items():
            front = sound
            for parts in self._active.values():
                if slot in parts:
                    parts[slot].sound = front
                    front = parts[slot]
            setattr(robot, slot, front)
        left = right = 1.0
        for name in self._active:
            if _kind(name) == "wheel_slip":
                grip = _grip(name.partition(":")[2])
                left, right = left * grip[0], right * grip[1]
        robot.slip = (1.0 / left - 1.0, 1.0 / right - 1.0)
        glass, mirrors = (
            set[str]().union(
                *(made for name, made in self._surfaces.items() if _kind(name) == kind)
            )
            for kind in _SURFACES
        )
        robot.set_surfaces(glass, mirrors)

    def _braking(self) -> float:
        """By how much farther ahead of a fast robot a wall must be to be no ambush [m]."""
        speed = max(0.0, float(self._robot.truth().twist[0]))
        return max(0.0, speed * _NOTICED + speed**2 / (2.0 * _BRAKES) - ACROSS_GAP)

    def _some_solids(self, share: float, random: np.random.Generator) -> frozenset[str]:
        names = [shape.name for shape in self._robot.world.solids]
        count = max(1, round(share * len(names)))
        return frozenset(names[index] for index in random.permutation(len(names))[:count])

    def _let_in(self, kind: str, random: np.random.Generator) -> None:
        body, find_way, passes = _PEOPLE[kind]
        truth = self._robot.truth()
        x, y, yaw = truth.pose
        heading = yaw + math.pi if truth.twist[0] < -_TRAVELS else yaw
        walk = find_way(self._robot.world, (x, y, heading), random)
        if walk is None:
            raise NotYet(
                f"{kind}: there is no room for a person ahead of the robot; turn it, or drive on"
            )
        self._people[kind] = person.Person(body, walk, passes=passes)
        self._robot.let_in(self._people[kind])

    def _close_door(self, name: str, doorway: str) -> None:
        check_place(name, self._robot.world)
        door = self._door(doorway)
        place = np.array([self._robot.truth().pose[:2]])
        if float(door.distance(place)[0]) < self._robot.kind.radius + _DOOR_CLEARANCE:
            raise NotYet(f"{name}: the robot stands in the doorway; have it drive on")
        self._robot.close_door(door)

    def _door(self, name: str) -> Box:
        return next(door for door in self._robot.world.doorways if door.name == name)


def _kind(name: str) -> str:
    return name.partition(":")[0]
