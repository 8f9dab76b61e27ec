"""Many random drives, a process each: what went wrong, and how to see it again."""

from __future__ import annotations

import argparse
import os
import re
import signal
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass, field

from kompass.drills.runner.pool import ENVIRONMENT, in_processes

NICENESS = 10
PROGRESS = 10.0  # s between two lines of it


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

    Each has a process of its own, forked from one that has imported all that they need.

    Parameters
    ----------
    until
        Monotonic time after which none is begun [s].
    """

    def begun() -> Iterator[tuple[int, bool]]:
        for seed in seeds:
            if time.monotonic() >= until:
                return
            yield seed, False

    with closing(in_processes(_make, begun(), jobs, "tests.drills.random_drives")) as drives:
        for ended in drives:
            yield ended.result


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
    return f"scripts/drills 1 --from {seed} --log"


@dataclass
class Tally:
    """How far a series of drives is, and what did not hold in it.

    Attributes
    ----------
    first, count
        The series.
    """

    first: int
    count: int
    done: set[int] = field(default_factory=set)
    bad: dict[int, tuple[str, ...]] = field(default_factory=dict)

    def take(self, driven: Driven) -> None:
        """Add a drive that has ended."""
        self.done.add(driven.seed)
        if driven.findings:
            self.bad[driven.seed] = driven.findings

    @property
    def next(self) -> int:
        """The first of the series that has not ended."""
        return next(
            seed for seed in range(self.first, self.first + self.count + 1) if seed not in self.done
        )

    def progress(self, seconds: float) -> str:
        """In a line."""
        done = len(self.done)
        left = seconds / done * (self.count - done) if done else 0.0
        return f"{done} of {self.count} drives, {len(self.bad)} bad, {_minutes(left)} left"

    def summary(self, seconds: float) -> Iterator[str]:
        """In some lines: what did not hold, how often, and how to go on."""
        done = len(self.done)
        yield f"{done} drives in {_minutes(seconds)}: something did not hold in {len(self.bad)}"
        kinds = Counter(kind for found in self.bad.values() for kind in {_kind(f) for f in found})
        for kind, times in kinds.most_common():
            seed = next(s for s, found in self.bad.items() if kind in map(_kind, found))
            yield f"  {times} times: {kind} (first: {again(seed)})"
        if done < self.count:
            rest = self.first + self.count - self.next
            yield f"  go on with: scripts/drills {rest} --from {self.next}"


def _kind(finding: str) -> str:
    """A finding without what differs from drive to drive: its first line without numbers."""
    first = finding.partition("\n")[0]
    name, of, _ = first.partition(" at ")
    return name if of and name.isidentifier() else re.sub(r"-?\d[\d.]*(e-\d+)?", "#", first)[:100]


def _minutes(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 120.0 else f"{seconds / 60.0:.0f} min"


def run(arguments: list[str]) -> int:
    """The command line; 1 where something did not hold, 130 where it was interrupted."""
    parser = argparse.ArgumentParser(
        prog="scripts/drills",
        description="Drive our own stack through random faults and edits, in virtual time.",
        epilog="Exit codes: 0 all held, 1 something did not, 130 interrupted.",
    )
    parser.add_argument("count", nargs="?", type=int, default=300, help="how many drives (300)")
    parser.add_argument("--from", dest="first", type=int, default=0, help="seed of the first (0)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="at a time")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="begin none after")
    parser.add_argument("--log", action="store_true", help="print all that the nodes write")
    given = parser.parse_args(arguments)
    if given.count < 1 or given.first < 0 or given.jobs < 1:
        parser.error("give a count and --jobs of 1 or more, and --from 0 or more")
    seeds = range(given.first, given.first + given.count)
    began = time.monotonic()
    told, tally = began, Tally(given.first, given.count)
    drives = (
        make(seeds, given.jobs, began + given.seconds)
        if not given.log
        else (_loud(seed) for seed in seeds)
    )
    interrupted = False
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # its processes end with it, too
    try:
        for driven in drives:
            tally.take(driven)
            if given.log or driven.findings:
                _say(driven.drive)
            for finding in driven.findings:
                _say(f"  {finding}")
            if driven.findings:
                _say(f"  again: {again(driven.seed)}")
            if time.monotonic() - told > PROGRESS:
                told = time.monotonic()
                _say(tally.progress(told - began))
    except KeyboardInterrupt:
        interrupted = True
    for line in tally.summary(time.monotonic() - began):
        _say(line)
    return 130 if interrupted else 1 if tally.bad else 0


def _loud(seed: int) -> Driven:
    os.environ |= ENVIRONMENT
    return _make(seed, True)


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
