"""How much faster than real time a drive is made, on one core: standing, and driving.

.venv/bin/python benchmarks/drill_speed.py [SECONDS] [--profile]
"""

from __future__ import annotations

import cProfile
import os
import pstats
import sys
import tempfile
import time
from collections.abc import Callable
from multiprocessing import get_context
from pathlib import Path

from kompass.drills.runner.pool import ENVIRONMENT
from kompass.drills.runner.worker import stack_of
from kompass.drills.scenario import Goal, Scenario

RECIPES = Path(__file__).parents[1] / "recipes"
SHOWN = 25  # functions of a profile
STANDING, DWA, PURSUIT = "standing", "driving with DWA", "driving with pure pursuit"
KINDS = {
    STANDING: ("03_events_and_actions.py", 30.0),
    DWA: ("03_events_and_actions.py", None),
    PURSUIT: ("01_point_navigation.py", 10.0),
}
# There and back, for as long as it takes.
GOALS = ((1.9, 0.0), (-1.0, 1.6), (0.6, 0.6), (0.0, -1.7))


def main() -> None:
    given = [argument for argument in sys.argv[1:] if not argument.startswith("-")]
    seconds = float(given[0]) if given else 60.0
    # A process each, as a drill has it.
    context = get_context("spawn")
    os.environ |= ENVIRONMENT
    for kind in KINDS:
        process = context.Process(target=drive, args=(kind, seconds, "--profile" in sys.argv))
        process.start()
        process.join()


def drive(kind: str, seconds: float, profile: bool) -> None:
    """Make one drive, and tell what it took."""
    from kompass.drills.runner.run import run_drive

    recipe, aim = KINDS[kind]
    there = [Goal(x=x, y=y) for x, y in GOALS * max(1, int(seconds / 40))]
    goals = [Goal(x=0.0, y=-1.7, at=seconds - 0.1)] if kind == STANDING else there
    scenario = Scenario(name=kind, world="hexagon", seed=1, goals=tuple(goals), limit=seconds)
    with tempfile.TemporaryDirectory(prefix="kompass-drill-") as folder:
        os.environ["KOMPASS_DATA_DIR"] = folder
        stack = stack_of(RECIPES / recipe)
        # What is imported and made once is not what a second of driving costs.
        first = scenario.model_copy(update={"limit": 5.0, "goals": (Goal(x=0.0, y=-1.7),)})
        run_drive(stack_of(RECIPES / recipe), first)
        profiler = cProfile.Profile()
        if profile:
            profiler.enable()
        took = _took(lambda: run_drive(stack, scenario))
        profiler.disable()
    told = "" if aim is None else f" (aim {aim:g} ×{'' if seconds / took >= aim else ' ✗'})"
    print(f"{kind:26} {seconds / took:5.1f} × real time{told}; {took:.2f} s for {seconds:g} s")
    if profile:
        pstats.Stats(profiler).sort_stats("tottime").print_stats(SHOWN)


def _took(work: Callable[[], object]) -> float:
    began = time.process_time()
    work()
    return time.process_time() - began


if __name__ == "__main__":
    main()
