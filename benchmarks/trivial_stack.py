"""Bring-up, stop, idle CPU and memory of four components that do nothing.

Aims: bring-up and stop ≤ 1 s, idle CPU ≤ 5 % of a core, memory ≤ 130 MiB.
Beside the four: the supervisor, which forks them, the monitor and the recorder.

Run: python benchmarks/trivial_stack.py [RUNS]
"""

import sys
import time

from benchmarks.common import cpu_seconds, pss, spread
from benchmarks.recipe_run import Recipe, prepare_environment

SETTLED = 3.0  # s after the start, when discovery is over
WATCHED = 5.0  # s


def run() -> dict[str, float]:
    recipe = Recipe("trivial_four.py")
    four = [pid for name, pid in recipe.pids.items() if name.startswith("idler")]
    beside = [pid for name, pid in recipe.pids.items() if not name.startswith("idler")]
    everybody = [*four, *beside, recipe.process.pid]
    time.sleep(SETTLED)
    before = {pid: cpu_seconds(pid) for pid in everybody}
    time.sleep(WATCHED)
    busy = {pid: 100 * (cpu_seconds(pid) - before[pid]) / WATCHED for pid in everybody}
    memory = {pid: pss(pid) for pid in everybody}
    result = {
        "bringup() to active [s]": recipe.bringup,
        "with the interpreter's start and imports [s]": recipe.whole,
        "idle CPU of the four [% of a core]": sum(busy[pid] for pid in four),
        "idle CPU of all [% of a core]": sum(busy.values()),
        "memory of the four, PSS [MiB]": sum(memory[pid] for pid in four),
        "memory of all, PSS [MiB]": sum(memory.values()),
    }
    result["Ctrl-C to the end [s]"] = recipe.stop()
    return result


def main() -> None:
    prepare_environment()
    runs = [run() for _ in range(int(sys.argv[1]) if len(sys.argv) > 1 else 5)]
    for key in runs[0]:
        print(f"{key:46} {spread([one[key] for one in runs])}")


if __name__ == "__main__":
    main()
