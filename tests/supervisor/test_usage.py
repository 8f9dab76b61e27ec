"""What a process takes is told as the kernel counts it."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

from kompass.supervisor.usage import UsageMeter
from tests.support.processes import wait_until


def test_a_process_that_computes_and_one_that_sleeps_are_told_apart() -> None:
    busy = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    idle = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    try:
        meter = UsageMeter()
        first = meter.look([busy.pid, idle.pid], time.monotonic())
        assert first[busy.pid].cpu is None, "there is nothing to compare with"

        def seen() -> bool:
            found = meter.look([busy.pid, idle.pid], time.monotonic())
            used, rested = found[busy.pid].cpu, found[idle.pid].cpu
            return used is not None and rested is not None and used > 0.1 and rested < 0.02

        time.sleep(0.5)  # over which is measured
        wait_until(seen, 20, "the one that computes")
    finally:
        for process in (busy, idle):
            process.kill()
            process.wait()
    assert meter.look([busy.pid], time.monotonic()) == {}


def test_memory_is_that_of_the_process() -> None:
    (usage,) = UsageMeter().look([os.getpid()], time.monotonic()).values()
    status = Path("/proc/self/status").read_text().splitlines()
    (line,) = (line for line in status if line.startswith("VmRSS"))
    kernel = int(line.split()[1]) * 1024
    assert 0.8 < usage.memory / kernel < 1.2
