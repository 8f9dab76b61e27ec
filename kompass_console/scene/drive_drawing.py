"""A scenario's drives under both tables, made ready to be played in the scene."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np
import numpy.typing as npt

from kompass.drills.drive import DriveMoment, DriveResult
from kompass.simulation.worlds.rasterize import rasterize
from kompass.simulation.worlds.registry import world
from kompass_console.scene.layers.map import MapDrawing, map_drawing
from kompass_console.scene.way import Way

Side: TypeAlias = Literal["in_force", "proposed"]
SIDES: tuple[Side, ...] = get_args(Side)
MarkKind: TypeAlias = Literal["fault", "firing", "stop", "contact"]
MARK_KINDS: tuple[MarkKind, ...] = get_args(MarkKind)

_APART = 0.25  # m; of marks of a kind that are nearer to each other the first is drawn
_TOLD = 2.0  # s for which a robot's name tells what has just happened


@dataclass(frozen=True, slots=True)
class Mark:
    """Something happened there (m, frame `map`), at this second of the drive."""

    at: float
    kind: MarkKind
    x: float
    y: float


@dataclass(frozen=True, slots=True)
class SideDrawing:
    """A drive under one of the tables."""

    way: Way
    marks: tuple[Mark, ...]
    happened: tuple[tuple[float, str], ...]
    stops: tuple[tuple[float, bool], ...]  # when STOP was pressed (True), and released

    def news(self, time: float) -> str:
        """What has just happened, and whether STOP is in force; empty when neither."""
        told = [text for at, text in self.happened if at <= time < at + _TOLD]
        stopped = [pressed for at, pressed in self.stops if at <= time][-1:] == [True]
        text = told[-1] if told else ""
        # What pressed it is told first; then that it holds, whatever else happens.
        if stopped and "STOP" not in text:
            return f"STOP · {text}" if text else "STOP"
        return text


@dataclass(frozen=True, slots=True)
class DriveDrawing:
    """Two drives of one scenario, and where they were.

    `id` is the drill's and the scenario's; `goals` are places (N, 2) in m; `end` is the second at
    which both are over.
    """

    id: tuple[str, str]
    place: MapDrawing
    goals: npt.NDArray[np.float64]
    sides: dict[Side, SideDrawing]
    end: float


def drive_drawing(drill: str, proposed: DriveResult, in_force: DriveResult) -> DriveDrawing:
    """Drawing of a scenario's two drives."""
    scenario = proposed.scenario
    return DriveDrawing(
        id=(drill, scenario.name),
        place=_place(scenario.world),
        goals=np.array([(goal.x, goal.y) for goal in scenario.goals]),
        sides={"in_force": _side(in_force), "proposed": _side(proposed)},
        end=max(proposed.duration, in_force.duration),
    )


@functools.lru_cache(maxsize=4)
def _place(name: str) -> MapDrawing:
    return map_drawing(rasterize(world(name)))


def _side(drive: DriveResult) -> SideDrawing:
    happened = [moment for moment in drive.moments if moment.kind in MARK_KINDS]
    return SideDrawing(
        way=Way(drive.track, drive.scenario.first_pose[2]),
        marks=tuple(_apart(happened)),
        happened=tuple((moment.at, _words(moment)) for moment in happened),
        stops=tuple(
            (moment.at, moment.kind == "stop")
            for moment in drive.moments
            if moment.kind in ("stop", "release")
        ),
    )


def _words(moment: DriveMoment) -> str:
    """As people say it: a fault without the signs of its name."""
    if moment.kind != "fault":
        return moment.text
    name, _, rest = moment.text.partition(" ")
    return f"{name.replace('_', ' ').replace(':', ' ')} {rest}"


def _apart(moments: list[DriveMoment]) -> Iterator[Mark]:
    kept: list[Mark] = []
    for moment in moments:
        if moment.x is None or moment.y is None:
            continue
        for kind in MARK_KINDS:
            if kind == moment.kind and not any(
                mark.kind == kind and math.dist((mark.x, mark.y), (moment.x, moment.y)) < _APART
                for mark in kept
            ):
                kept.append(Mark(moment.at, kind, moment.x, moment.y))
    yield from kept
