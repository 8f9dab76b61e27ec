"""Draws scenarios from a seed: the same seed, number and options give the same one everywhere.

Only :meth:`random.Random.random` is asked for chance, whose sequence Python promises to keep, and
its seed is a hash of seed and number that depends on no hash seed of the process.
"""

from __future__ import annotations

import difflib
import hashlib
import math
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from random import Random
from typing import Annotated, TypeVar

import numpy as np
from pydantic import Field, ValidationInfo, field_validator

from kompass.algorithms.distance_field import DistanceField
from kompass.algorithms.planning.free_space import FreeSpace
from kompass.drills.scenario import (
    BODY_CLEARANCE,
    LONGEST,
    USUAL_ROBOT,
    Goal,
    RobotName,
    Scenario,
    ScheduledFault,
    Start,
)
from kompass.rules.schema.model import Model
from kompass.simulation.faults.fault_names import (
    AT_ONCE,
    DOOR_CLOSED,
    FAULTS,
    MACHINE_FAULTS,
    MAP_WITHHELD,
    NEEDS_CAMERA,
    TARGETED,
    WRONG,
    UnknownFault,
    check_camera,
    check_fault,
    check_place,
)
from kompass.simulation.faults.fault_parameters import PARAMETERS
from kompass.simulation.physics.robot_model import RobotModel, robot_model
from kompass.simulation.worlds.rasterize import rasterize
from kompass.simulation.worlds.registry import world, world_names
from kompass.simulation.worlds.world import World

ALL = "all"
_FIRST_GOAL = 2.0  # s after the start at which the first goal is sent
_AHEAD = 1.0  # s before a goal at which somebody begins to answer wrongly
USUAL_WORLDS = tuple(name for name in world_names() if name != "depot")
_LONGEST_STEM = 90  # characters of a scenario's name before the number of its drive
_TRIES = 50  # places looked at for a goal that is far enough
# Where a fault begins on its way, as shares of the least time that the way can take: the robot has
# set off, and cannot have arrived.
_EARLY, _LATE = 0.15, 0.75
# A way along eight directions of a grid is up to so much longer than the one that is driven.
_STRAIGHTER = math.cos(math.pi / 8.0)
_DURATIONS = (3.0, 20.0)  # s
_SWEPT = 0.10  # m beside its way that a body which is no circle passes over where it turns
_T = TypeVar("_T")


def expand_faults(
    names: Iterable[str], nodes: Sequence[str], robot: str = USUAL_ROBOT
) -> tuple[str, ...]:
    """Names of faults, with ``all`` and what takes a parameter written out, each once.

    Parameters
    ----------
    names
        As after ``--faults``: names, ``all``, or ``kill`` and the like for every parameter.
    nodes
        Of the recipe's components: each of them is killed, stopped and so on.
    robot
        Which drives: ``all`` are those that can happen to it.

    Raises
    ------
    UnknownFault
        There is no such fault, its parameter cannot be read, or it is not for that robot.
    """
    kinds = {whole.partition(":")[0]: whole for whole in (*FAULTS, *MACHINE_FAULTS)}
    model = robot_model(robot)
    usual = [kind for kind in kinds if model.camera is not None or kind not in NEEDS_CAMERA]
    found: list[str] = []
    for name in names:
        for one in usual if name == ALL else (name,):
            kind, _, word = kinds.get(one, one).partition(":")
            if one in kinds and word:
                values = nodes if word == "NAME" else _usual(kind)
                found += [f"{kind}:{value}" for value in values]
            else:
                found.append(one)
    for name in found:
        check_camera(name, model)
    return tuple(dict.fromkeys(map(check_fault, found)))


def check_targets(names: Iterable[str], targets: Sequence[str]) -> None:
    """Refuse faults of processes and nodes that are not there.

    Parameters
    ----------
    names
        Of faults, written out.
    targets
        The processes of the stack, and the nodes in them.

    Raises
    ------
    UnknownFault
        Nobody is called so.
    """
    for name in names:
        kind, _, target = name.partition(":")
        if kind in TARGETED and target not in targets:
            near = difflib.get_close_matches(target, targets, n=1, cutoff=0.4)
            hint = f"did you mean {near[0]!r}? " if near else ""
            raise UnknownFault(
                f"fault {name!r}: the recipe has no process or node {target!r}; {hint}it has "
                f"{', '.join(sorted(targets))}"
            )


def _usual(kind: str) -> Sequence[str]:
    """What stands behind the colon of a fault that does not name a node."""
    if kind == DOOR_CLOSED:
        return [door.name for name in world_names() for door in world(name).doorways]
    return [PARAMETERS[kind].example]


class DrawOptions(Model):
    """What scenarios are drawn from.

    Attributes
    ----------
    worlds
        Of the embedded robot; each comes up equally often. The depot, whose ways take minutes, is
        drawn from only when it is named.
    faults
        Names, written out (:func:`expand_faults`); each comes up equally often as the first of its
        drive. Empty for drives without faults.
    faults_per_drive, goals
        How many.
    lasting
        Share of the faults that never end, 0 to 1. From most of them nothing recovers: the best
        is to stand and say why.
    robot
        Which embedded one drives: its size is where it can go, its usual speed what times are
        estimated by.
    half_width, radius
        Of the body that the recipe describes [m]: from its middle to its nearest side, and of the
        circle around it. The embedded robot's own count where they are larger.
    clearance
        What it keeps from walls beyond its body [m].
    shortest
        Least length of the way to a goal [m], where the world has room for it.
    """

    worlds: Annotated[tuple[str, ...], Field(min_length=1)] = USUAL_WORLDS
    robot: RobotName = USUAL_ROBOT
    faults: tuple[str, ...] = ()
    faults_per_drive: Annotated[int, Field(ge=1, le=10)] = 1
    goals: Annotated[int, Field(ge=1, le=20)] = 1
    lasting: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    half_width: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0
    radius: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0
    clearance: Annotated[float, Field(ge=0.0, le=1.0)] = 0.10
    shortest: Annotated[float, Field(ge=0.0, le=100.0)] = 2.0

    @field_validator("worlds")
    @classmethod
    def _worlds_exist(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(world(name).name for name in names)

    @field_validator("faults")
    @classmethod
    def _faults_exist(cls, names: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
        # Of what was given before it; a robot that there is not is refused for itself.
        if (robot := info.data.get("robot")) is not None:
            for name in names:
                check_camera(name, robot_model(robot))
        return tuple(map(check_fault, names))


def draw(seed: int, number: int, options: DrawOptions) -> Scenario:
    """Scenario ``number`` (from 0) of a seed.

    Raises
    ------
    ValueError
        The number is negative, the robot has no room in a world, or the drive would last too long.
    """
    if number < 0:
        raise ValueError(f"number: {number}; give 0 or more")
    # Not of the options: an option that is added later leaves what was drawn without it as it was.
    digest = hashlib.sha256(f"{seed}/{number}".encode()).digest()
    random = Random(int.from_bytes(digest[:16], "big"))
    # Faults and worlds alternate: few drives already meet every one of both. Which come first is of
    # the seed: with fewer drives than faults it is not always the same ones that are left out.
    possible = [name for name in options.faults if _fitting(name, options.worlds)]
    turn, place_in_turn = divmod(number, max(len(possible), 1))
    order = _shuffled(possible, f"{seed}/turn {turn}")
    first = order[place_in_turn] if order else ""
    places = _fitting(first, options.worlds) if first else options.worlds
    place = places[(place_in_turn + turn) % len(places)]
    faults = [name for name in options.faults if fits(name, world(place))]
    robot = robot_model(options.robot)
    try:
        room = _room_in(place, options)
    except NoRoom as error:
        others = ", ".join(roomy(options))
        remedy = f"take one that has: {others}" if others else "no other one has, either"
        raise ValueError(f"{error}; {remedy}") from None

    here = room.place(random)
    start = Start(x=here.x, y=here.y, yaw=_heading(random))
    goals: list[Goal] = []
    ways: list[tuple[float, float]] = []  # when each can begin, and how long it takes at least
    begin = _FIRST_GOAL
    for index in range(options.goals):
        there, length = room.another_place(here, options.shortest, random)
        yaw = _heading(random) if random.random() < 0.5 else None
        goals.append(Goal(x=there.x, y=there.y, yaw=yaw, at=None if index else _FIRST_GOAL))
        ways.append((begin, _STRAIGHTER * length / robot.usual_speed))
        begin += ways[-1][1]
        here = there
    chosen = _choose(first, faults, options.faults_per_drive, random)
    # Thrice the least time and a minute of healing: a robot that comes through does so in less.
    limit = math.ceil(3.0 * begin + 60.0 + _DURATIONS[1] * len(chosen))
    if limit > LONGEST:
        raise ValueError(
            f"goals: {options.goals} at {robot.usual_speed:g} m/s may take {limit} s, and no drive "
            f"lasts longer than {LONGEST:g} s; give fewer goals"
        )
    broken = [_schedule(name, ways, options.lasting, random) for name in chosen]
    return Scenario(
        name=f"{seed}-{number}",
        world=place,
        robot=options.robot,
        seed=int.from_bytes(digest[16:20], "big") >> 1,
        start=start,
        goals=tuple(goals),
        faults=tuple(sorted(broken, key=lambda fault: (fault.at, fault.name))),
        limit=float(limit),
    )


def roomy(options: DrawOptions) -> Iterator[str]:
    """Worlds in which the robot of some options has room to drive; not the depot.

    Each is looked at when it is asked for, which takes a while.
    """
    for name in USUAL_WORLDS:
        try:
            _room_in(name, options)
        except NoRoom:
            continue
        yield name


def _room_in(name: str, options: DrawOptions) -> _Room:
    robot = robot_model(options.robot)
    return _room(
        *(name, options.robot, options.clearance),
        *(max(options.half_width, robot.half_width), max(options.radius, robot.radius)),
    )


def repeated(scenario: Scenario, seed: int, count: int) -> tuple[Scenario, ...]:
    """A scenario several times, with other noise of sensors and delays of messages in each.

    The first is the scenario itself, with its own seed.
    """
    if count == 1:
        return (scenario,)
    stem = scenario.name
    if len(stem) > _LONGEST_STEM:  # what is cut off still tells it from others
        stem = f"{stem[: _LONGEST_STEM - 9]}-{hashlib.sha256(stem.encode()).hexdigest()[:8]}"
    found: list[Scenario] = []
    for number in range(count):
        digest = hashlib.sha256(f"{seed}/{number}/{scenario.seed}".encode()).digest()
        chance = int.from_bytes(digest[16:20], "big") >> 1 if number else scenario.seed
        name = f"{stem}-{number}"
        found.append(scenario.model_copy(update={"name": name, "seed": chance}))
    return tuple(found)


def _fitting(fault: str, names: Sequence[str]) -> list[str]:
    """Those of some worlds that have what a fault breaks."""
    return [name for name in names if fits(fault, world(name))]


def fits(fault: str, place: World) -> bool:
    """Whether a world has what a fault breaks."""
    try:
        check_place(fault, place)
    except UnknownFault:
        return False
    return True


def _shuffled(items: Sequence[_T], of: str) -> list[_T]:
    """Fisher's and Yates' way, with :meth:`random.Random.random` alone."""
    random = Random(int.from_bytes(hashlib.sha256(of.encode()).digest()[:16], "big"))
    found = list(items)
    for last in range(len(found) - 1, 0, -1):
        other = int(random.random() * (last + 1))
        found[last], found[other] = found[other], found[last]
    return found


def _choose(first: str, faults: Sequence[str], count: int, random: Random) -> list[str]:
    if not first:
        return []
    chosen = [first]
    while len(chosen) < min(count, len(faults)):
        chosen.append(_one([name for name in faults if name not in chosen], random))
    return chosen


def _schedule(
    name: str, ways: Sequence[tuple[float, float]], lasting: float, random: Random
) -> ScheduledFault:
    """A fault while one of the goals is under way."""
    begin, least = _one(ways, random)
    at = begin + least * _between(_EARLY, _LATE, random)
    duration = _between(*_DURATIONS, random)
    stays = random.random() < lasting
    if name.startswith(AT_ONCE):
        duration = 0.0
    elif name.startswith(WRONG):
        # Whoever answers once for each goal has to be asked while he is wrong.
        at, duration = _FIRST_GOAL - _AHEAD, _AHEAD + duration
    elif name == MAP_WITHHELD:
        # It can only be there from the start; it must last until somebody asks for a plan.
        at, duration = 0.0, _FIRST_GOAL + duration
    if stays:
        duration = 0.0
    return ScheduledFault(name=name, at=round(at, 2), duration=round(duration, 2))


class NoRoom(ValueError):
    """A robot is too large for a world."""


class _Place:
    """A cell where the robot has room."""

    def __init__(self, cell: int, x: float, y: float) -> None:
        self.cell = cell
        self.x, self.y = round(x, 3), round(y, 3)


class _Room:
    """Where a robot can get to in a world from where the world has it start."""

    def __init__(
        self, name: str, robot: RobotModel, clearance: float, half_width: float, radius: float
    ) -> None:
        place = world(name)
        field = DistanceField(rasterize(place))
        required = half_width + clearance
        if radius > half_width:
            required += _SWEPT
        self._free = FreeSpace(field, required)
        start = (place.start[0], place.start[1])
        entry = self._free.entry(start, 1.0, 0.0)
        if entry is None:
            raise _no_room(name, robot, required)
        self._cells = self._free.region(entry)
        if radius > half_width:
            # It goes through where it is narrow, but begins, and ends, where it can stand any way.
            required = radius + BODY_CLEARANCE
            wide = place.distance(self._free.centres(self._cells)) >= required
            self._cells = self._cells[wide]
            if not len(self._cells):
                raise _no_room(name, robot, required)

    def place(self, random: Random) -> _Place:
        """Anywhere in it."""
        cell = int(self._cells[int(random.random() * len(self._cells))])
        x, y = self._free.centres(np.array([cell]))[0]
        return _Place(cell, float(x), float(y))

    def another_place(self, here: _Place, shortest: float, random: Random) -> tuple[_Place, float]:
        """A place, and the length of the way to it [m]; the farthest seen if none is far enough."""
        best: tuple[_Place, float] | None = None
        for _ in range(_TRIES):
            there = self.place(random)
            way = self._free.shortest(here.cell, there.cell)
            assert way is not None  # all cells are of one region
            length = round(way[1], 2)
            if best is None or length > best[1]:
                best = there, length
            if length >= shortest:
                return there, length
        assert best is not None
        return best


@lru_cache(maxsize=16)
def _room(name: str, robot: str, clearance: float, half_width: float, radius: float) -> _Room:
    return _Room(name, robot_model(robot), clearance, half_width, radius)


def _no_room(name: str, robot: RobotModel, required: float) -> NoRoom:
    return NoRoom(
        f"world {name!r} has no room for the robot {robot.name}, which needs {required:.2f} m on "
        "every side"
    )


def _one(items: Sequence[_T], random: Random) -> _T:
    return items[int(random.random() * len(items))]


def _between(low: float, high: float, random: Random) -> float:
    return low + (high - low) * random.random()


def _heading(random: Random) -> float:
    return round(_between(-math.pi, math.pi, random), 3)
