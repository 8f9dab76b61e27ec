"""Processor time of one step of a follower among posts, a Jackal-sized box at 20 Hz and 2 m/s.

The followers alternate; what the rest of the controller does is not in it.

.venv/bin/python benchmarks/controller_tick.py [ROUNDS]
"""

from __future__ import annotations

import math
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from kompass.algorithms.following.dwa import DWA
from kompass.algorithms.following.mppi import MPPI
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import inverse, transform_points
from kompass.bench.stack import described
from kompass.simulation.physics.robot_model import JACKAL
from tests.algorithms.worlds import STRAIGHT, drive

LIMITS: dict[str, Any] = {
    "max_v": 2.0,
    "max_omega": 4.0,
    "acc": 4.0,
    "decel": 4.0,
    "omega_acc": 10.0,
}
RADIUS, LONGEST = 0.075, 20.0  # m, s


class Timed:
    """A follower that notes how long each of its steps takes [s]."""

    def __init__(self, follower: Any) -> None:
        self._follower = follower
        self.took: list[float] = []

    def step(self, *args: Any) -> Any:
        began = time.process_time()
        step = self._follower.step(*args)
        self.took.append(time.process_time() - began)
        return step


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    turn = np.linspace(0, 2 * math.pi, 24, endpoint=False)
    ring = RADIUS * np.column_stack([np.cos(turn), np.sin(turn)])
    middles = [(x, y) for x in np.arange(0.8, 6.0, 0.9) for y in (-1.2, -0.45, 0.5, 1.3)]
    posts = np.concatenate([ring + middle for middle in middles])
    body = Footprint(described(JACKAL).footprint)
    for _ in range(rounds):
        for kind in (DWA, MPPI):
            follower = kind(footprint=body, **LIMITS)
            follower.set_path(STRAIGHT)
            timed = Timed(follower)
            run = drive(
                timed,
                (0.0, 0.0, 0.0),
                dt=0.05,
                limit=LONGEST,
                points=lambda pose: transform_points(inverse(pose), posts),
            )
            ms = 1e3 * np.array(timed.took)
            print(
                f"{kind.__name__:5s} {len(ms)} steps, arrived {run.arrived}: "
                f"p50 {np.median(ms):.1f} ms, p99 {np.percentile(ms, 99):.1f} ms"
            )


if __name__ == "__main__":
    main()
