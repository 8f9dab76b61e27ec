"""What a silent process does, as the kernel tells it of real ones."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from kompass.supervisor.cpu_usage import CpuUsage, Work

LOOKED_AT = 1.0  # s
COMPUTES = "while True: sum(range(1000))"
SLEEPS = "import time; time.sleep(60)"


@pytest.fixture
def processes() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def begin(processes: ExitStack, program: str, nice: int) -> int:
    """A process on the first of our processors; its pid."""
    (first, *_) = sorted(os.sched_getaffinity(0))

    def settle() -> None:
        os.sched_setaffinity(0, {first})
        os.nice(nice)

    process = subprocess.Popen([sys.executable, "-c", program], preexec_fn=settle)
    processes.callback(process.wait)
    processes.callback(process.kill)
    return process.pid


def watched(pid: int) -> Work:
    time.sleep(0.5)  # until it does what it is to do
    usage, began = CpuUsage(), time.monotonic()
    usage.look(pid, began)
    time.sleep(LOOKED_AT)
    return usage.look(pid, time.monotonic())


def test_one_that_gets_no_processor_waits_for_it(processes: ExitStack) -> None:
    starved = begin(processes, COMPUTES, 19)
    begin(processes, COMPUTES, 0)

    work = watched(starved)

    assert work.computing
    assert work.waited > 0.5 * LOOKED_AT


def test_one_that_sleeps_waits_for_no_processor(processes: ExitStack) -> None:
    work = watched(begin(processes, SLEEPS, 0))

    assert not work.computing
    assert work.waited < 0.1 * LOOKED_AT


def test_of_one_that_is_gone_nothing_is_told() -> None:
    process = subprocess.Popen([sys.executable, "-c", "pass"])
    process.wait()

    assert CpuUsage().look(process.pid, 0.0) == Work(computing=False, waited=0.0)
