"""Sampling-based search with OMPL over a distance field."""

from __future__ import annotations

import difflib
import inspect
import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from ompl import base, geometric, util

from kompass.algorithms.distance_field import DistanceField
from kompass.algorithms.geometry import Floats

# What a core of 2020 makes in a second [1/s]: the unit in which a search is given its time.
CHECKS_PER_SECOND = 50_000


def planner_names() -> list[str]:
    """The geometric planners of the installed OMPL, by class name."""
    return sorted(
        name
        for name, kind in inspect.getmembers(geometric, inspect.isclass)
        if issubclass(kind, base.Planner)
    )


def resolve_planner(planner_id: str) -> str:
    """The class name for ``"RRTConnect"`` or ``"ompl.geometric.RRTConnect"``.

    Raises
    ------
    ValueError
        The installed OMPL has no such planner.
    """
    name = planner_id.rsplit(".", 1)[-1]
    known = planner_names()
    if name in known:
        return name
    near = difflib.get_close_matches(name, known, n=1)
    hint = f"did you mean {near[0]!r}?" if near else "choose one of"
    raise ValueError(f"planner_id: {planner_id!r} is not in this OMPL; {hint} {', '.join(known)}")


class _Budget:
    """Checks that a search may still make; asking whether it is over counts as one, too."""

    def __init__(self, timeout: float) -> None:
        self._left = max(1, round(timeout * CHECKS_PER_SECOND))

    def spend(self) -> None:
        self._left -= 1

    def is_over(self) -> bool:
        # Some planners go round without a check.
        self._left -= 1
        return self._left < 0


class _ClearMotion(base.MotionValidator):  # type: ignore[misc]
    """Straight motions that keep the clearance all along, checked by stepping over open space."""

    def __init__(self, space: Any, field: DistanceField, required: float, budget: _Budget) -> None:
        super().__init__(space)
        self._clear = field.segment_clear
        self._required = required
        self._spend = budget.spend

    def checkMotion(self, start: Any, end: Any, *_last_valid: Any) -> bool:
        # OMPL's second form also asks for the last valid state; planners that use it start from
        # "none", which is what leaving it alone means: they keep whole motions only.
        self._spend()
        return self._clear(start[0], start[1], end[0], end[1], self._required)


def search(
    field: DistanceField,
    required: float,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    bounds: tuple[Floats, Floats],
    planner: str,
    timeout: float,
    seed: int,
) -> Floats | None:
    """An exact solution as a polyline (N, 2) in the world, or None within ``timeout`` [s].

    Approximate solutions, which end somewhere else, are no solutions. The time is counted in
    checks and not by the clock, so that the same input and seed give the same polyline on a busy
    machine and on an idle one, planners included that optimise until their time is up.
    """
    start, goal = np.asarray(start, dtype=np.float64), np.asarray(goal, dtype=np.float64)
    level = util.getLogLevel()
    # OMPL prints by itself, and reports setting a seed twice as an error although it obeys.
    util.setLogLevel(util.LogLevel.LOG_NONE)
    try:
        util.RNG.setSeed(seed)
        space = base.RealVectorStateSpace(2)
        box = base.RealVectorBounds(2)
        margin = field.grid.resolution
        low = np.minimum(np.minimum(bounds[0], start), goal) - margin
        high = np.maximum(np.maximum(bounds[1], start), goal) + margin
        for axis in range(2):
            box.setLow(axis, float(low[axis]))
            box.setHigh(axis, float(high[axis]))
        space.setBounds(box)
        setup = geometric.SimpleSetup(space)
        information = setup.getSpaceInformation()
        budget = _Budget(timeout)
        at_xy, spend = field.at_xy, budget.spend

        def is_clear(state: Any) -> bool:
            spend()
            return at_xy(state[0], state[1]) >= required

        setup.setStateValidityChecker(is_clear)
        validator = _ClearMotion(information, field, required, budget)
        information.setMotionValidator(validator)
        first, last = space.allocState(), space.allocState()
        for axis in range(2):
            first[axis], last[axis] = float(start[axis]), float(goal[axis])
        setup.setStartAndGoalStates(first, last)
        setup.setPlanner(getattr(geometric, planner)(information))
        setup.solve(base.PlannerTerminationCondition(budget.is_over))
        if not setup.haveExactSolutionPath():
            return None
        states = setup.getSolutionPath().getStates()
        points = np.array([(state[0], state[1]) for state in states])
    finally:
        util.setLogLevel(level)
    return points if math.isfinite(float(points.sum())) else None
