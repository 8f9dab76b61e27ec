"""Bring-up time, memory and idle CPU of the four components, without robot and console.

.venv/bin/python benchmarks/bringup.py [RUNS]
"""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

from benchmarks.common import cpu_seconds, pss, spread

RECIPE = Path(__file__).parents[1] / "recipes" / "01_point_navigation.py"
NAMES = ("planner", "controller", "mapper", "drive_manager")
WATCHED = 5.0  # s


def said(pattern: str, output: str) -> str:
    """The first group of the pattern in the output."""
    found = re.search(pattern, output)
    assert found, f"no {pattern!r} in:\n{output}"
    return found[1]


def run() -> dict[str, float]:
    began = time.monotonic()
    process = subprocess.Popen(
        [sys.executable, str(RECIPE)], stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    assert process.stderr is not None
    output = ""
    while "all components active" not in output:
        output += process.stderr.readline()
    whole = time.monotonic() - began
    bringup = float(said(r"all components active in ([\d.]+) s", output))
    pids = [int(said(rf"{name} is process (\d+)", output)) for name in NAMES]
    time.sleep(2.0)
    before = sum(map(cpu_seconds, pids)) + cpu_seconds(process.pid)
    time.sleep(WATCHED)
    busy = sum(map(cpu_seconds, pids)) + cpu_seconds(process.pid) - before
    result = {
        "bringup() to active [s]": bringup,
        "with the interpreter's start and imports [s]": whole,
        "memory of the four, PSS [MiB]": sum(map(pss, pids)),
        "memory with the supervisor, PSS [MiB]": sum(map(pss, pids)) + pss(process.pid),
        "idle CPU, all five [% of a core]": 100 * busy / WATCHED,
    }
    ended = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)
    process.wait(10)
    process.stderr.close()
    result["Ctrl-C to the end [s]"] = time.monotonic() - ended
    return result


def main() -> None:
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    runs = [run() for _ in range(int(sys.argv[1]) if len(sys.argv) > 1 else 5)]
    for key in runs[0]:
        print(f"{key:46} {spread([one[key] for one in runs])}")


if __name__ == "__main__":
    main()
