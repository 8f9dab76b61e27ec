"""What a plan, a scan and a step of the follower cost on maps of 100² to 4000² cells.

Round posts of 0.3 m, one in each 4 m² by chance, on cells of 5 cm. *Map to path*: from one corner
to the other, and all that it takes before. *Mended way*: what the planner does on large maps, from
what is around the robot to a path to a place 4 m away. *Update*: a scan of 360 rays is taken into
the model of what was seen, and what is near the robot is read from it. *Tick*: a step of MPPI with
its default settings among what is near. Processor time, medians.

.venv/bin/python benchmarks/growth.py [ROUNDS] [FILE.svg]
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from kompass.algorithms.following.mppi import MPPI
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats, inverse, transform_points
from kompass.algorithms.grid import Grid
from kompass.algorithms.mapping.world_model import WorldModel
from kompass.algorithms.planning.planner import GlobalPlanner
from kompass.components.planner.live_map import BEYOND

SIDES = (100, 200, 400, 1000, 2000, 4000)  # cells
RESOLUTION = 0.05  # m
POST, APART = 0.15, 2.0  # m: radius, and the squares of which each has one
RADIUS, REACH = 0.12, 5.0  # m
NEAR_BY = 4.0  # m
STEPS = 40  # of update and tick, on each map
COLOURS = {
    "map to path": "#2f5fd0",
    "mended way": "#8a4fc7",
    "update": "#1f8a5b",
    "tick": "#c2571a",
}


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    found: dict[str, list[float]] = {name: [] for name in COLOURS}
    print("cells   " + "".join(f"{name:>14s}" for name in COLOURS) + "   [ms]", flush=True)
    for side in SIDES:
        taken = [measured(side, seed) for seed in range(rounds)]
        for name, values in found.items():
            values.append(statistics.median(each[name] for each in taken))
        told = "".join(f"{values[-1]:14.2f}" for values in found.values())
        print(f"{side:4d}²   {told}", flush=True)
    if len(sys.argv) > 2:
        Path(sys.argv[2]).write_text(plot(found), encoding="utf-8")


def measured(side: int, seed: int) -> dict[str, float]:
    """Processor time by what is done, on one map [ms]."""
    grid, posts = posted(side, seed)
    extent = side * RESOLUTION
    began = time.process_time()
    planner = GlobalPlanner(grid, robot_radius=RADIUS)
    plan = planner.plan((0.6, 0.6, 0.0), (extent - 0.6, extent - 0.6, None))
    whole = time.process_time() - began

    middle = plan.poses[len(plan.poses) // 2]
    there = next(pose for pose in plan.poses[::-1] if math.dist(pose[:2], middle[:2]) <= NEAR_BY)
    model = WorldModel(RESOLUTION, reach=REACH)
    model.set_map(grid)
    began = time.process_time()
    around = model.grid_around(middle[:2], REACH + BEYOND, 0.0)
    GlobalPlanner(around, robot_radius=RADIUS).plan(middle, (*there[:2].tolist(), None))
    mended = time.process_time() - began
    among = plan.poses[len(plan.poses) // 2 :][:STEPS]
    rays = [seen(posts, pose) for pose in among]
    updates = []
    for number, (pose, ranges) in enumerate(zip(among, rays, strict=True)):
        began = time.process_time()
        model.see(ranges, -math.pi, 2 * math.pi / 360, 0.05, 12.0, tuple(pose), 0.1 * number)
        near = model.near(pose[:2], REACH, 0.1 * number)
        updates.append(time.process_time() - began)

    limits: dict[str, Any] = {
        "max_v": 1.0,
        "max_omega": 2.0,
        "acc": 2.0,
        "decel": 2.0,
        "omega_acc": 4.0,
    }
    follower = MPPI(footprint=Footprint.circle(RADIUS), **limits)
    follower.set_path(plan.poses)
    ticks = []
    for number, pose in enumerate(among):
        points = transform_points(inverse(tuple(pose)), np.concatenate([near[0], near[2]]))
        began = time.process_time()
        follower.step(pose, 0.5, 0.0, 0.1, points)
        if number >= 5:  # its banks of noise are drawn by then
            ticks.append(time.process_time() - began)
    return {
        "map to path": 1e3 * whole,
        "mended way": 1e3 * mended,
        "update": 1e3 * statistics.median(updates),
        "tick": 1e3 * statistics.median(ticks),
    }


def posted(side: int, seed: int) -> tuple[Grid, Floats]:
    """A map with posts, its corners free, and the posts' middles (N, 2) [m]."""
    chance = np.random.default_rng(seed)
    count = max(1, int(side * RESOLUTION // APART))
    corners = APART * np.stack(np.meshgrid(np.arange(count), np.arange(count)), axis=-1)
    posts = (corners + chance.uniform(0.4, APART - 0.4, corners.shape)).reshape(-1, 2)
    extent = side * RESOLUTION
    for end in (0.6, extent - 0.6):
        posts = posts[np.hypot(*(posts - end).T) > 0.8]
    cells = np.zeros((side, side), dtype=np.int8)
    reach = math.ceil(POST / RESOLUTION) + 1
    around = np.arange(-reach, reach + 1)
    for x, y in posts:
        cols, rows = int(x / RESOLUTION) + around, int(y / RESOLUTION) + around
        cols, rows = cols[(cols >= 0) & (cols < side)], rows[(rows >= 0) & (rows < side)]
        away = np.hypot((cols + 0.5)[None] * RESOLUTION - x, (rows + 0.5)[:, None] * RESOLUTION - y)
        cells[rows[:, None], cols[None]] = np.where(
            away <= POST, 100, cells[rows[:, None], cols[None]]
        )
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return Grid(cells, RESOLUTION), posts


def seen(posts: Floats, pose: Floats) -> Floats:
    """What a scanner reads there: ranges (360,) to the posts [m], +inf where there is none."""
    x, y, yaw = pose
    angles = -math.pi + yaw + 2 * math.pi / 360 * np.arange(360)
    near = posts[np.hypot(posts[:, 0] - x, posts[:, 1] - y) < 13.0]
    along = np.outer(np.cos(angles), near[:, 0] - x) + np.outer(np.sin(angles), near[:, 1] - y)
    off = np.outer(np.cos(angles), near[:, 1] - y) - np.outer(np.sin(angles), near[:, 0] - x)
    half = np.sqrt(np.maximum(POST**2 - off**2, 0.0))
    ranges = np.where((along > 0) & (np.abs(off) < POST), along - half, np.inf)
    return np.asarray(ranges.min(axis=1, initial=np.inf), dtype=np.float64)


def plot(found: dict[str, list[float]]) -> str:
    """The same as a picture (SVG), both axes by powers of ten."""
    width, height, left, bottom = 640, 400, 70, 50
    low, high = -1.0, 5.0  # powers of ten [ms]

    def at(side: float, ms: float) -> tuple[float, float]:
        across = (math.log10(side) - 2) / (math.log10(SIDES[-1]) - 2)
        up = (math.log10(max(ms, 10**low)) - low) / (high - low)
        return (
            left + across * (width - left - 110),
            height - bottom - up * (height - bottom - 20),
        )

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        'font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="#fff"/>'
    ]
    for power in range(int(low), int(high) + 1):
        (x, y), (end, _) = at(SIDES[0], 10.0**power), at(SIDES[-1], 10.0**power)
        parts.append(
            f'<path d="M{x:.0f} {y:.0f}H{end:.0f}" stroke="#ddd"/>'
            f'<text x="{x - 8:.0f}" y="{y + 4:.0f}" text-anchor="end">{10.0**power:g} ms</text>'
        )
    for side in SIDES:
        x, y = at(side, 10.0**low)
        parts.append(f'<text x="{x:.0f}" y="{y + 20:.0f}" text-anchor="middle">{side}²</text>')
    for name, values in found.items():
        places = [at(side, ms) for side, ms in zip(SIDES, values, strict=True)]
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        parts.append(
            f'<polyline points="{line}" fill="none" stroke="{COLOURS[name]}" stroke-width="2"/>'
            f'<text x="{places[-1][0] + 8:.0f}" y="{places[-1][1] + 4:.0f}" '
            f'fill="{COLOURS[name]}">{name}</text>'
        )
    return "\n".join([*parts, "</svg>\n"])


if __name__ == "__main__":
    main()
