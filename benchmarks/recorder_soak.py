"""What the flight recorder costs: processor time and disk, with the simulated robot driving.

    python benchmarks/recorder_soak.py [MINUTES]

Aim: less than 3 % of a core, and the ring within its bounds.
"""

import os
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from mcap.reader import make_reader

from kompass.recorder.rotating_recording import RotationBounds, rotation_files
from tests.recorder.reality import Reality, reality_table
from tests.support.robot import Robot
from tests.support.stack import Stack

TICKS = os.sysconf("SC_CLK_TCK")


def processor_time(pid: int) -> float:
    """Seconds of processor time that a process has used, its own and the kernel's for it."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def memory(pid: int) -> float:
    """Proportional share of memory [MiB]."""
    for line in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines():
        if line.startswith("Pss:"):
            return int(line.split()[1]) / 1024
    return 0.0


def size_of(path: Path) -> int:
    """Bytes of a file; 0 for one that has gone, as the oldest of a ring do."""
    try:
        return path.stat().st_size
    except FileNotFoundError:
        return 0


def main() -> None:
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else 30.0
    stack = Stack.simulated()
    robot = Robot(stack.domain)
    try:
        robot.ready()
        reality = Reality(robot)
        reality.apply(reality_table(0.45))
        pid = stack.pid_of("recorder")
        (ring,) = stack.data_dir.glob("*/recordings/ring")
        began, used = time.monotonic(), processor_time(pid)
        largest = 0
        while (passed := time.monotonic() - began) < minutes * 60:
            try:
                reality.drive(min(20.0, minutes * 60 - passed))
            except AssertionError as error:
                # Not what is measured: on a machine with much else to do an answer may be late.
                print(f"  {error}", flush=True)
            size = sum(size_of(path) for path in rotation_files(ring))
            largest = max(largest, size)
            share = (processor_time(pid) - used) / (time.monotonic() - began)
            print(
                f"{passed / 60:5.1f} min  {share:6.2%} of a core  {size / 1e6:6.1f} MB in "
                f"{len(rotation_files(ring))} files  {memory(pid):.1f} MiB",
                flush=True,
            )
        passed = time.monotonic() - began
        share = (processor_time(pid) - used) / passed
        path = reality.save("soak")
        with path.open("rb") as stream:
            summary = make_reader(stream, validate_crcs=True).get_summary()
        assert summary is not None
        assert summary.statistics is not None
        numbers, bounds = summary.statistics, RotationBounds()
        length = (numbers.message_end_time - numbers.message_start_time) * 1e-9
        print(
            f"recorder: {share:.2%} of a core over {passed / 60:.1f} min, "
            f"{numbers.message_count / length:.0f} messages/s, at most {largest / 1e6:.1f} MB on "
            f"disk (bound {bounds.size / 1e6:.0f} MB), the last {length / 60:.1f} min kept"
        )
        within = largest <= bounds.size and length <= bounds.age + 2 * bounds.file_age
        sys.exit(0 if share < 0.03 and within else 1)
    finally:
        robot.close()
        stack.close()


if __name__ == "__main__":
    main()
