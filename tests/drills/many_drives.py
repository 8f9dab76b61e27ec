"""Many random drives, a process each: what went wrong, and how to see it again."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context

from kompass.drills.runner.worker import ENVIRONMENT

NICENESS = 10
PRELOADED = ["tests.drills.random_drives"]


@dataclass(frozen=True)
class Driven:
    """One drive, as far as it is told.

    Attributes
    ----------
    drive
        What happened in it.
    findings
        What did not hold; empty where all did.
    """

    seed: int
    drive: str
    findings: tuple[str, ...]


def make(seeds: Iterable[int], jobs: int, until: float = float("inf")) -> Iterator[Driven]:
    """Make the drives of some seeds, as they end.

    Parameters
    ----------
    until
        Monotonic time after which none is begun [s].
    """
    os.environ |= ENVIRONMENT
    context = get_context("forkserver")
    context.set_forkserver_preload(PRELOADED)
    waiting = iter(seeds)
    with ProcessPoolExecutor(jobs, mp_context=context, max_tasks_per_child=1) as pool:
        under_way = {}

        def begin() -> None:
            seed = next(waiting, None)
            if seed is not None and time.monotonic() < until:
                under_way[pool.submit(_make, seed, False)] = seed

        for _ in range(2 * jobs):
            begin()
        while under_way:
            done = next(as_completed(list(under_way)))
            under_way.pop(done)
            yield done.result()
            begin()


def _make(seed: int, loud: bool) -> Driven:
    from tests.drills.random_drives import drive_once

    if not loud:
        os.nice(NICENESS)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
    outcome = drive_once(seed)
    if loud:
        for line in outcome.log:
            _say(line)
    return Driven(seed, outcome.drive, tuple(outcome.findings))


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def again(seed: int) -> str:
    """The command that makes one drive again."""
    return f"scripts/drills 1 --seed {seed} --log"


def run(arguments: list[str]) -> int:
    """The command line; 1 where something did not hold."""
    parser = argparse.ArgumentParser(
        prog="scripts/drills",
        description="Drive our own stack through random faults and edits, in virtual time.",
    )
    parser.add_argument("count", nargs="?", type=int, default=300, help="how many drives (300)")
    parser.add_argument("--seed", type=int, default=0, help="of the first; the others follow")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="at a time")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="begin none after")
    parser.add_argument("--log", action="store_true", help="print all that the nodes write")
    given = parser.parse_args(arguments)
    seeds = range(given.seed, given.seed + given.count)
    began, bad, count = time.monotonic(), 0, 0
    drives = (
        make(seeds, given.jobs, began + given.seconds)
        if not given.log
        else (_loud(seed) for seed in seeds)
    )
    for driven in drives:
        count += 1
        if count % 50 == 0:
            _say(f"{count} drives, {bad} bad")
        if given.log:
            _say(driven.drive)
        if driven.findings:
            bad += 1
            _say(driven.drive)
            for finding in driven.findings:
                _say(f"  {finding}")
            _say(f"  again: {again(driven.seed)}")
    took = time.monotonic() - began
    _say(f"{count} drives in {took:.0f} s: something did not hold in {bad}")
    return 1 if bad else 0


def _loud(seed: int) -> Driven:
    os.environ |= ENVIRONMENT
    return _make(seed, True)


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
