"""Reads worlds of BARN, the Benchmark for Autonomous Robot Navigation, from a file."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Self

import numpy as np
from pydantic import ConfigDict, Field, ValidationError, model_validator

from kompass.invalid import first_invalid
from kompass.json_once import GivenTwice, read_json
from kompass.rules.schema.model import Model
from kompass.simulation.worlds.shapes import Cylinder
from kompass.simulation.worlds.world import World

_FAR = 100.0  # m; no world of BARN is larger
# BARN's ground has no end. This floor keeps so much beside the field and behind the goal [m].
_BESIDE, _BEHIND = 1.0, 1.5
_HEIGHT = 1.0  # m, of the cylinders


Metres = Annotated[float, Field(strict=True, ge=-_FAR, le=_FAR)]
Radius = Annotated[float, Field(strict=True, gt=0.0, le=10.0)]
Point = tuple[Metres, Metres]


class BarnWorld(Model):
    """One world.

    Attributes
    ----------
    index
        Its number in BARN.
    cylinders
        What stands in it: (x, y, radius) of each [m].
    path
        BARN's own way through it, from the start to the goal [m].
    optimal_length
        Of that way [m].
    """

    index: Annotated[int, Field(strict=True, ge=0)]
    cylinders: Annotated[
        tuple[tuple[Metres, Metres, Radius], ...],
        Field(min_length=1, max_length=5000),
    ]
    path: Annotated[tuple[Point, ...], Field(min_length=2)]
    optimal_length: Annotated[float, Field(strict=True, gt=0.0, le=1000.0)]

    @property
    def name(self) -> str:
        """What reports call it."""
        return f"barn_{self.index}"

    def place(
        self, start: tuple[float, float, float], goal: Point, *, obstacles: bool = True
    ) -> World:
        """The world to drive in, or with its floor and outer wall alone."""
        points = np.array([[x, y] for x, y, _ in self.cylinders] + [start[:2], goal])
        left, low = (float(value) for value in points.min(axis=0))
        right, high = (float(value) for value in points.max(axis=0))
        left, low = _down(left - _BESIDE), _down(low - _BESIDE / 2)
        right, high = -_down(-right - _BESIDE), -_down(-high - _BEHIND)
        standing = enumerate(self.cylinders) if obstacles else ()
        return World(
            name=self.name,
            title=f"BARN world {self.index}",
            floor=((left, low), (right, low), (right, high), (left, high)),
            start=start,
            obstacles=tuple(
                Cylinder(f"cylinder_{number}", (x, y), radius, height=_HEIGHT)
                for number, (x, y, radius) in standing
            ),
        )


class BarnFile(Model):
    """Worlds, with where the robot starts in each of them, and where it goes.

    Attributes
    ----------
    start
        x, y [m], yaw [rad].
    goal
        x, y [m].
    """

    # The file may say more, as where it comes from.
    model_config = ConfigDict(extra="ignore")

    start: tuple[Metres, Metres, Annotated[float, Field(ge=-math.tau, le=math.tau)]]
    goal: Point
    boxes: Annotated[tuple[object, ...], Field(max_length=0)] = ()
    worlds: Annotated[tuple[BarnWorld, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _names_differ(self) -> Self:
        seen: set[int] = set()
        for world in self.worlds:
            if world.index in seen:
                raise ValueError(f"two worlds have the index {world.index}; give each its own")
            seen.add(world.index)
        return self

    def chosen(self, indices: Sequence[int]) -> tuple[BarnWorld, ...]:
        """The worlds of some indices, all for none.

        Raises
        ------
        KeyError
            With the first index that there is not.
        """
        if not indices:
            return self.worlds
        known = {world.index: world for world in self.worlds}
        return tuple(known[index] for index in indices)


class BadWorlds(ValueError):
    """A file of worlds that cannot be read; the message says where, and what to do."""


def read_barn(file: Path) -> BarnFile:
    """The worlds of a file.

    Raises
    ------
    BadWorlds
        When there is no such file, or something in it is not as it must be.
    """
    try:
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise BadWorlds(f"{file}: {error.strerror}; give a file of BARN worlds (JSON)") from None
    except UnicodeDecodeError:
        raise BadWorlds(f"{file}: it is no text; give a file of BARN worlds (JSON)") from None
    try:
        return BarnFile.model_validate(read_json(text))
    except json.JSONDecodeError as error:
        raise BadWorlds(
            f"{file}:{error.lineno}: it is no JSON ({error.msg}); write it anew"
        ) from None
    except ValidationError as error:
        first = first_invalid(error)
        value = json.dumps(first.value, default=str)
        short = value if len(value) <= 60 else f"{value[:60]}…"
        where = f"{first.where} = " if first.where else ""
        raise BadWorlds(f"{file}: {where}{short}: {first.text}") from None
    except GivenTwice as error:
        raise BadWorlds(f"{file}: {error}") from None
    except ValueError as error:  # of a number that has thousands of digits
        raise BadWorlds(f"{file}: {str(error).partition(';')[0]}; write it anew") from None
    except RecursionError:
        raise BadWorlds(f"{file}: it is nested too deeply to be read; write it anew") from None


def _down(value: float) -> float:
    """To a multiple of 5 cm, as maps have it."""
    return round(math.floor(value / 0.05 + 1e-6) * 0.05, 6)
