"""Plans for three bodies over the maps of BARN's worlds: found, gap, length, processor time.

Between places drawn by chance, at least 3 m apart, of which one can be reached from the other. The
*optimum* is the shortest way of the body's inscribed circle that keeps the clearance (where there
is none, that of what is kept in any case): over cells in 32 directions, pulled tight. For a body
with corners it is a bound, since its turns are not in it.

.venv/bin/python benchmarks/plan_footprint.py WORLDS.json [PATHS] [EVERY]
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from kompass.algorithms.distance_field import DistanceField
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats
from kompass.algorithms.grid import Grid
from kompass.algorithms.planning.failure import PlanningFailure
from kompass.algorithms.planning.outline_planner import OutlinePlanner
from kompass.algorithms.planning.planner import GlobalPlanner
from kompass.algorithms.planning.shorten import path_length, pull_tight
from kompass.bench.barn_file import read_barn
from kompass.bench.score import least_gap
from kompass.simulation.physics.robot_model import JACKAL, TURTLEBOT3, RobotModel
from kompass.simulation.worlds.rasterize import rasterize

RESOLUTION = 0.05  # m
CLEARANCE = 0.1  # m, as the planner has it
APART = 3.0  # m
TRIES = 60  # pairs of places that are drawn for one path
LONG_BOX = (0.80, 0.40)  # m
BODIES = {
    "TurtleBot3": TURTLEBOT3,
    "Jackal": JACKAL,
    "long box": replace(JACKAL, box=LONG_BOX, radius=math.hypot(*LONG_BOX) / 2),
}


class Optimum:
    """Shortest ways of a circle over a map.

    Parameters
    ----------
    field
        Of the obstacles.
    required
        The circle's radius, and what it keeps [m].
    """

    def __init__(self, field: DistanceField, required: float) -> None:
        self._field, self._required = field, required
        grid = field.grid
        rows, cols = np.indices(grid.cells.shape)
        self._centres = grid.cell_to_world(np.column_stack([cols.ravel(), rows.ravel()]))
        free = (field.at(self._centres) >= required).reshape(grid.cells.shape)
        sources, targets, lengths = [], [], []
        for dx in range(-3, 4):
            for dy in range(4):
                if math.gcd(dx, dy) != 1 or (dy == 0 and dx < 0):
                    continue
                beyond = np.zeros_like(free)
                left, right = max(0, -dx), grid.width - max(0, dx)
                beyond[: grid.height - dy, left:right] = free[dy:, left + dx : right + dx]
                first = np.flatnonzero(free & beyond)
                last = first + dy * grid.width + dx
                clear = field.segments_clear(self._centres[first], self._centres[last], required)
                sources += [first[clear], last[clear]]
                targets += [last[clear], first[clear]]
                lengths.append(np.full(2 * int(clear.sum()), math.hypot(dx, dy) * grid.resolution))
        count = len(self._centres)
        self._graph = csr_matrix(
            (np.concatenate(lengths), (np.concatenate(sources), np.concatenate(targets))),
            shape=(count, count),
        )

    def length(self, start: Floats, goal: Floats) -> float:
        """Of the shortest way between two places (x, y) [m]; inf where there is none."""
        grid = self._field.grid
        cols, rows = grid.world_to_cell(np.stack([start, goal])).T
        first, last = (rows * grid.width + cols).tolist()
        away, before = dijkstra(self._graph, indices=first, return_predecessors=True)
        if not math.isfinite(away[last]):
            return math.inf
        chain = [last]
        while chain[-1] != first:
            chain.append(int(before[chain[-1]]))
        way = np.concatenate([start[None], self._centres[chain[::-1][1:-1]], goal[None]])
        return path_length(pull_tight(way, self._field, self._required))


def main() -> None:
    file = read_barn(Path(sys.argv[1]))
    paths = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    worlds = file.worlds[:: int(sys.argv[3]) if len(sys.argv) > 3 else 1]
    for name, model in BODIES.items():
        each = math.ceil(paths / len(worlds))
        found: list[dict[str, float]] = []
        refused = 0
        for world in worlds:
            grid = rasterize(world.place(file.start, file.goal), RESOLUTION)
            made, missing = planned(grid, model, np.array(world.cylinders), each, world.index)
            found += made
            refused += missing
        told(name, found, refused)


def planned(
    grid: Grid, model: RobotModel, posts: Floats, count: int, seed: int
) -> tuple[list[dict[str, float]], int]:
    """What became of so many paths over one map, and how many pairs of places had none."""
    chance = np.random.default_rng(seed)
    began = time.process_time()
    planner: Any = made(grid, model)
    built = time.process_time() - began
    optima = [
        Optimum(planner.field, radius(model) + kept)
        for kept in ((CLEARANCE,) if model.box is None else (CLEARANCE, 0.0))
    ]
    found: list[dict[str, float]] = []
    refused = 0
    for _ in range(TRIES * count):
        if len(found) == count:
            break
        cells = chance.integers((0, 0), (grid.width, grid.height), (2, 2))
        start, goal = grid.cell_to_world(cells)
        if math.dist(start, goal) < APART:
            continue
        began = time.process_time()
        try:
            plan = planner.plan((*start, chance.uniform(-math.pi, math.pi)), (*goal, None))
        except PlanningFailure as failure:
            refused += failure.reason == "no_path"
            continue
        took = time.process_time() - began
        lengths = (each.length(start, goal) for each in optima)
        shortest = next(filter(math.isfinite, lengths), math.inf)
        found.append(
            {
                "search": took,
                "whole": built + took,
                "gap": least_gap(model, along(plan.poses), posts)[0],
                "longer": plan.length / shortest,
            }
        )
    return found, refused


def made(grid: Grid, model: RobotModel) -> GlobalPlanner:
    """The planner that the component would make for a body."""
    if model.box is None:
        return GlobalPlanner(grid, robot_radius=model.radius, clearance=CLEARANCE)
    return OutlinePlanner(grid, footprint=body(model), clearance=CLEARANCE, least=0.0)


def body(model: RobotModel) -> Footprint:
    """A box's outline."""
    assert model.box is not None
    x, y = model.box[0] / 2, model.box[1] / 2
    return Footprint(np.array([(x, y), (-x, y), (-x, -y), (x, -y)]))


def radius(model: RobotModel) -> float:
    """Of the circle in the body [m]."""
    return model.radius if model.box is None else body(model).inscribed_radius


def along(poses: Floats) -> Floats:
    """Poses (N, 3) as they are driven: it has turned to the first leg before it sets off."""
    turned = poses.copy()
    if len(turned) > 1:
        turned[0, 2] = math.atan2(*(turned[1, 1::-1] - turned[0, 1::-1]))
    return turned


def told(name: str, found: list[dict[str, float]], refused: int) -> None:
    values = {key: np.array([each[key] for each in found]) for key in found[0]}
    whole, search = 1e3 * values["whole"], 1e3 * values["search"]
    longer = values["longer"][np.isfinite(values["longer"])]
    print(
        f"{name}: {len(found)} paths, {refused} more were not found though both ends are free; "
        f"{int((values['gap'] <= 0).sum())} overlaps, least gap {values['gap'].min():.3f} m; "
        f"length {np.median(longer):.3f} of the optimum (95 % {np.percentile(longer, 95):.3f}, "
        f"worst {longer.max():.3f}); map to path p50 {np.percentile(whole, 50):.0f} ms, p95 "
        f"{np.percentile(whole, 95):.0f} ms; of it the search p50 {np.percentile(search, 50):.0f}, "
        f"p95 {np.percentile(search, 95):.0f} ms of CPU",
        flush=True,
    )


if __name__ == "__main__":
    main()
