"""Plans for a Jackal-sized box over the maps of BARN's worlds: found, gap, length, processor time.

.venv/bin/python benchmarks/plan_footprint.py WORLDS.json [EVERY]
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

from kompass.algorithms.footprint import Footprint
from kompass.algorithms.planning.failure import PlanningFailure
from kompass.algorithms.planning.outline_planner import OutlinePlanner
from kompass.bench.barn_file import read_barn
from kompass.bench.score import least_gap
from kompass.bench.stack import described
from kompass.simulation.physics.robot_model import JACKAL
from kompass.simulation.worlds.rasterize import rasterize

RESOLUTION = 0.05  # m
CLEARANCE = 0.1  # m, as the planner has it


def main() -> None:
    file = read_barn(Path(sys.argv[1]))
    every = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    body = Footprint(described(JACKAL).footprint)
    made, planned, gaps, lengths, refused = [], [], [], [], []
    for world in file.worlds[::every]:
        grid = rasterize(world.place(file.start, file.goal), RESOLUTION)
        began = time.process_time()
        planner = OutlinePlanner(grid, footprint=body, clearance=CLEARANCE, least=0.0)
        ready = time.process_time()
        try:
            plan = planner.plan(file.start, (*file.goal, None))
        except PlanningFailure as failure:
            refused.append(f"{world.name}: {failure.message}")
            continue
        made.append(ready - began)
        planned.append(time.process_time() - ready)
        gaps.append(least_gap(JACKAL, plan.poses, np.array(world.cylinders))[0])
        lengths.append(plan.length / world.optimal_length)
    both = 1e3 * (np.array(made) + np.array(planned))
    print(
        f"{len(gaps)} of {len(gaps) + len(refused)} worlds have a way; least gap of the body to a "
        f"cylinder {min(gaps):.3f} m; {sum(gap <= 0 for gap in gaps)} overlaps; "
        f"{np.median(lengths):.2f} of the length of BARN's way (median)\n"
        f"map to path: p50 {np.percentile(both, 50):.0f} ms, p95 {np.percentile(both, 95):.0f} ms; "
        f"of it the search p50 {1e3 * np.percentile(planned, 50):.0f} ms, "
        f"p95 {1e3 * np.percentile(planned, 95):.0f} ms of CPU"
    )
    for line in refused:
        print(line)


if __name__ == "__main__":
    main()
