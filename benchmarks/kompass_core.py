"""The same work by kompass-core (0.8.8) and here: processor time, in turn, ours by theirs.

kompass-core is in an environment of its own (``pip install kompass-core==0.8.8 numpy``).

.venv/bin/python benchmarks/kompass_core.py PYTHON_OF_KOMPASS_CORE [ROUNDS]
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from kompass.algorithms.following.dwa import DWA, DWAParams
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.grid import Grid
from kompass.algorithms.mapping.local_map import LocalMapBuilder
from kompass.algorithms.mapping.occupancy_memory import OccupancyMemory, SensorModel
from kompass.algorithms.planning.planner import GlobalPlanner

PEER = Path(__file__).parent / "peer" / "kompass_core_calls.py"
RESOLUTION, RADIUS = 0.05, 0.1  # m
# Each with how many calls make a turn of ours and of theirs, and the most that ours may take.
ROWS = {
    "map": (40, 20, 0.15),
    "bayesian": (20, 10, 0.15),
    "dwa 360": (20, 2, 0.03),
    "dwa 3600": (20, 1, 0.02),
    "plan": (2, 2, 1.0),
}
LIMITS = {"max_v": 1.0, "max_omega": 2.0, "acc": 5.0, "decel": 10.0, "omega_acc": 10.0}


def main() -> None:
    peer = subprocess.Popen(
        [sys.argv[1], str(PEER)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 7
    assert peer.stdin is not None
    assert peer.stdout is not None
    for name, (ours, theirs, most) in ROWS.items():
        call = MAKE[name]()
        call()
        here, there, told = [], [], ""
        for _ in range(rounds):
            began = time.process_time()
            for _ in range(ours):
                call()
            here.append((time.process_time() - began) / ours)
            print(name, theirs, file=peer.stdin, flush=True)
            took, *more = peer.stdout.readline().split()
            there.append(float(took))
            if more:
                told = f"; their paths: {more[0]} m (median), least gap to a wall {more[1]} m"
        ratios = [one / other for one, other in zip(here, there, strict=True)]
        ratio = statistics.median(ratios)
        print(
            f"{name:9s} ours {1e3 * statistics.median(here):8.3f} ms, theirs "
            f"{1e3 * statistics.median(there):8.3f} ms: {ratio:.4f} "
            f"({min(ratios):.4f} … {max(ratios):.4f}), at most {most:g}{told}",
            flush=True,
        )
    peer.stdin.close()
    peer.wait()


def flower(rays: int) -> tuple[np.ndarray, np.ndarray]:
    """A scan with walls at 3 to 7 m."""
    angles = -np.pi + np.arange(rays) * 2 * np.pi / rays
    return 5.0 + 2.0 * np.sin(20 * angles), angles


def mapper(bayesian: bool) -> Callable[[], object]:
    """A scan of 3,600 rays on 400 x 400 cells."""
    builder = LocalMapBuilder(20.0, 20.0, RESOLUTION)
    memory = OccupancyMemory(builder.rows, builder.cols, RESOLUTION, SensorModel())
    ranges, angles = flower(3600)
    at = 0.0

    def call() -> object:
        nonlocal at
        at += 0.001
        cells = builder.update(ranges, float(angles[0]), 2 * np.pi / 3600, 0.05, 20.0)
        if not bayesian:
            return cells
        memory.take(cells, (at, 0.0, at))
        return memory.cells((at, 0.0, at))

    return call


def dwa(rays: int) -> Callable[[], object]:
    """4,704 velocities, ten places of each, among what a scan shows."""
    params = DWAParams(
        linear_samples=48, angular_samples=98, prediction_time=1.0, turn_in_place_angle=np.pi
    )
    follower = DWA(params, footprint=Footprint.circle(RADIUS), **LIMITS)
    follower.set_path(np.column_stack([np.linspace(0, 10, 1000), np.zeros(1000), np.zeros(1000)]))
    ranges, angles = flower(rays)
    cos, sin = np.cos(angles), np.sin(angles)

    def call() -> object:
        points = np.column_stack([ranges * cos, ranges * sin])
        follower.reset()
        return follower.step((1.0, 0.05, 0.05), 0.5, 0.0, 0.1, points)

    return call


def plan() -> Callable[[], object]:
    """From corner to corner of 200 x 200 cells with three walls that must be passed in turn."""
    cells = np.zeros((200, 200), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[60, :150] = cells[120, 50:] = cells[160, :140] = 100
    grid = Grid(cells, RESOLUTION, (-5.0, -5.0, 0.0))

    def call() -> object:
        planner = GlobalPlanner(grid, robot_radius=RADIUS)
        made = planner.plan((-4.0, -4.0, 0.0), (4.0, 4.0, 0.0))
        assert made.room > 0.0
        return made

    return call


MAKE: dict[str, Callable[[], Callable[[], object]]] = {
    "map": lambda: mapper(False),
    "bayesian": lambda: mapper(True),
    "dwa 360": lambda: dwa(360),
    "dwa 3600": lambda: dwa(3600),
    "plan": plan,
}


if __name__ == "__main__":
    main()
