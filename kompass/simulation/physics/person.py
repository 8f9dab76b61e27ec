"""People who walk into the robot's way: upright cylinders that look where they go."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kompass.simulation.worlds.world import World

RADIUS = 0.20  # m
HEIGHT = 1.70  # m
SPEED = 1.0  # m/s
# Nobody walks into the robot: a person waits when the next step would end closer to its shell, so
# that what they have of contacts is the robot's doing.
KEPT_CLEAR = 0.05  # m
PATIENCE = 2.0  # s of waiting, after which a person who wants to cross goes back

# Names of their bodies in the physics.
AHEAD, CROSSING = "person_ahead", "person_crossing"
PEOPLE = (AHEAD, CROSSING)

_TRIES = 40
_AHEAD = (0.7, 1.2)  # m from the robot's middle to the person's
_ASIDE = 0.1  # m to either side of the middle of the way
_STEP_IN = (0.0, 0.5, 1.0)  # m from where a person comes who steps into the way
_CROSS = (0.6, 0.9, 1.2, 1.5)  # m to either side that a person crosses, as far as there is room
_STRIDE = 0.05  # m between the places that must be free

Point = tuple[float, float]


@dataclass(frozen=True)
class Walk:
    """A straight way through free space, in ``map``.

    Attributes
    ----------
    start
        Where the person comes from (x, y), metres.
    goal
        Where the person is bound for.
    """

    start: Point
    goal: Point


class Person:
    """Walks to the goal and stands there.

    Parameters
    ----------
    name
        Of the body in the physics; one of ``PEOPLE``.
    walk
        From where to where.
    passes
        Whether the person is gone once there, and turns back when there is no getting through.
    """

    def __init__(self, name: str, walk: Walk, *, passes: bool) -> None:
        self.name = name
        self.position = walk.start
        self.gone = False
        self._back, self._goal = walk.start, walk.goal
        self._passes = passes
        self._waited = 0.0

    def advance(self, robot: Point, dt: float, radius: float) -> None:
        """Walk for ``dt`` seconds, with a robot of ``radius`` [m] at ``robot`` (x, y)."""
        x, y = self.position
        left = math.dist(self.position, self._goal)
        if left == 0.0:
            self.gone = self._passes
            return
        share = min(1.0, SPEED * dt / left)
        ahead = (x + share * (self._goal[0] - x), y + share * (self._goal[1] - y))
        near = math.dist(ahead, robot)
        if near < RADIUS + radius + KEPT_CLEAR and near < math.dist(self.position, robot):
            self._waited += dt
            if self._passes and self._waited >= PATIENCE:
                self._waited = 0.0
                self._back, self._goal = self._goal, self._back
            return
        self._waited = 0.0
        self.position = self._goal if share == 1.0 else ahead


def step_in(
    world: World, pose: tuple[float, float, float], random: np.random.Generator
) -> Walk | None:
    """A way from beside the robot's path to a place on it.

    Parameters
    ----------
    world
        What stands in the way of people.
    pose
        Of the robot (x, y) and the direction in which it travels, radians.
    random
        Says how far ahead, and from which side.

    Returns
    -------
    Walk | None
        None when there is no room for a person on the path ahead.
    """
    for _ in range(_TRIES):
        ahead, aside, side = random.uniform(*_AHEAD), random.uniform(-_ASIDE, _ASIDE), _side(random)
        stand = _beside(pose, ahead, aside)
        # From as far away as there is room for, be it none: then somebody is suddenly there.
        least, *longer = (
            Walk(_beside(pose, ahead, aside + side * length), stand) for length in _STEP_IN
        )
        if _free(world, pose, least):
            return next((walk for walk in reversed(longer) if _free(world, pose, walk)), least)
    return None


def cross(
    world: World, pose: tuple[float, float, float], random: np.random.Generator
) -> Walk | None:
    """A way from one side of the robot's path to the other; see ``step_in``.

    Returns
    -------
    Walk | None
        None when there is no room on either side of the path ahead.
    """
    for _ in range(_TRIES):
        ahead, side = random.uniform(*_AHEAD), _side(random)
        least, *longer = (
            Walk(_beside(pose, ahead, side * length), _beside(pose, ahead, -side * length))
            for length in _CROSS
        )
        if _free(world, pose, least):
            return next((walk for walk in reversed(longer) if _free(world, pose, walk)), least)
    return None


def _side(random: np.random.Generator) -> float:
    return 1.0 if random.random() < 0.5 else -1.0


def _beside(pose: tuple[float, float, float], ahead: float, left: float) -> Point:
    x, y, yaw = pose
    cos, sin = math.cos(yaw), math.sin(yaw)
    return x + ahead * cos - left * sin, y + ahead * sin + left * cos


def _free(world: World, pose: tuple[float, float, float], walk: Walk) -> bool:
    """Whether there is room for all of a walk, and the robot sees where it meets its path."""
    way = _between(walk.start, walk.goal)
    if not world.on_floor(way).all() or (world.distance(way) < RADIUS).any():
        return False
    x, y, yaw = pose
    ahead = math.cos(yaw) * (walk.goal[0] - x) + math.sin(yaw) * (walk.goal[1] - y)
    view = _between((x, y), _beside(pose, ahead, 0.0))
    # What is behind a wall is not ahead of the robot.
    return bool((world.distance(view) >= 0.0).all())


def _between(start: Point, goal: Point) -> np.ndarray:
    count = math.ceil(math.dist(start, goal) / _STRIDE) + 1
    return np.linspace(start, goal, count)
