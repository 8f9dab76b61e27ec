"""Kill the writer of the rule store at random moments, and cut its files at every byte.

Run: python benchmarks/store_crash.py [KILLS] [STEP]

KILLS (300) times a process that applies and confirms revisions in a loop is killed with SIGKILL.
After each, the store must open on the old or the new table, with every revision that was
acknowledged. Then the files as they are around one transaction are cut at every STEP-th byte (1) of
what it wrote: each must open on the old or the new table, and none on neither.
"""

import logging
import os
import random
import select
import signal
import sqlite3
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

from kompass.rules.schema.actions import Log
from kompass.rules.schema.conditions import Compare
from kompass.rules.schema.events import Event
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Table
from kompass.store.database import open_database
from kompass.store.revisions import Revisions
from kompass.store.store import FILE, FORMAT, RuleStore

RULES = 20
LONGEST = 0.1  # s that a writer lives at most
OLD, NEW = 5, 6  # tables before and after the transaction that is cut
SECTOR = 512  # bytes that a disk writes at once
WHOLE = ("log whole", "log half copied")


def table(number: int) -> Table:
    """A table that tells which one it is."""
    return Table(rules=tuple(_rule(place, number if place == 0 else 0) for place in range(RULES)))


def number_of(found: Table) -> int:
    """Which one a table is; fails for one that is not whole."""
    action = found.rules[0].actions[0]
    assert isinstance(action, Log)
    assert found == table(int(action.text))
    return int(action.text)


def _rule(place: int, number: int) -> Rule:
    signal_ = Signal(topic=f"topic_{place}", type="std_msgs/msg/Float64", path=("data",))
    condition = Compare(signal=signal_, operator=">", value=float(place))
    return Rule(
        id=f"rule-{place}", event=Event(condition=condition), actions=(Log(text=str(number)),)
    )


# -- kill -9 --------------------------------------------------------------------------------------


def kill_at_random(folder: Path, kills: int, seed: int = 0) -> Counter[str]:
    """Kill a writer ``kills`` times; what was found afterwards, counted.

    Raises
    ------
    AssertionError
        When something acknowledged is gone, or a table is neither the old nor the new one.
    """
    chance, found = random.Random(seed), Counter[str]()
    with RuleStore.open(folder) as store:
        store.begin_session(table(0), epoch="first", stack="stack")
        store.end_session()
    last = 0  # confirmed
    for round_ in range(kills):
        acknowledged = _killed(folder, last + 1, round_, chance.uniform(0.0, LONGEST))
        with RuleStore.open(folder, clock=_clock(round_)) as store:
            assert not store.notices, store.notices
            for place, number in acknowledged.applied.items():
                assert number_of(store.table(number)) == place
            boot = store.begin_session(table(0), epoch=f"look {round_}", stack="stack")
            confirmed = number_of(boot.table)
            old = acknowledged.confirmed or last
            assert confirmed in (old, old + 1), (confirmed, acknowledged)
            found["the new table" if confirmed == old + 1 else "the old table"] += 1
            found["acknowledged revisions"] += len(acknowledged.applied)
            store.end_session()
        last = confirmed
    return found


def _clock(round_: int) -> Callable[[], float]:
    """Put the rounds far apart: the crash-loop guard would rightly take tables back."""
    return lambda: time.time() + 1000.0 * round_


class Acknowledged(NamedTuple):
    """What a writer has said before it died: revision of each table, and the last confirmed."""

    applied: dict[int, int]
    confirmed: int


def _killed(folder: Path, begin: int, round_: int, after: float) -> Acknowledged:
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        _write(folder, begin, round_, writing)
    os.close(writing)
    # From the moment that it has the store open: before, there is nothing to break.
    select.select([reading], [], [], 10.0)
    time.sleep(after)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    with os.fdopen(reading) as lines:
        said = [line.split() for line in lines if line.endswith("\n")]
    applied = {int(words[1]): int(words[2]) for words in said if words[0] == "applied"}
    confirmed = [int(words[1]) for words in said if words[0] == "confirmed"]
    return Acknowledged(applied, confirmed[-1] if confirmed else 0)


def _write(folder: Path, begin: int, round_: int, out: int) -> None:
    """Apply and confirm one table after the other until killed; runs in the child."""
    try:
        store = RuleStore.open(folder, clock=_clock(round_))
        store.begin_session(table(0), epoch=f"round {round_}", stack="stack")
        os.write(out, b"open\n")
        place = begin
        while True:
            at_once = place % 2 == 0
            made = store.append(table(place), author="ava", role="engineer", confirmed=at_once)
            number = made.number
            os.write(out, f"applied {place} {number}\n".encode())
            if not at_once:
                store.set_confirmed(number, author="ava", role="engineer")
            os.write(out, f"confirmed {place}\n".encode())
            place += 1
    finally:
        os._exit(1)


# -- cut files ------------------------------------------------------------------------------------


class Files(NamedTuple):
    """The database and its log at one moment, as a power cut would leave them."""

    database: bytes
    log: bytes


class Moments(NamedTuple):
    """The files before and after one apply, and after the log was copied into the database."""

    before: Files
    after: Files
    copied: Files


def around_a_transaction(folder: Path, *, restarted: bool) -> Moments:
    """Watch one apply.

    With ``restarted`` the log is written again from its beginning, over what an earlier
    transaction left there; otherwise it grows.
    """
    with RuleStore.open(folder) as store:
        store.begin_session(table(0), epoch="cut", stack="stack")
        for place in range(1, OLD + 1):
            store.append(table(place), author="ava", role="engineer", confirmed=True)
        if restarted:
            _copy_log(folder, "RESTART")
        before = _files(folder)
        store.append(table(NEW), author="ava", role="engineer", confirmed=True)
        after = _files(folder)
        _copy_log(folder, "PASSIVE")
        return Moments(before, after, _files(folder))


def _copy_log(folder: Path, how: str) -> None:
    with closing(sqlite3.connect(folder / FILE)) as other:
        other.execute(f"PRAGMA wal_checkpoint({how})")


def _files(folder: Path) -> Files:
    return Files((folder / FILE).read_bytes(), (folder / f"{FILE}-wal").read_bytes())


def cuts(moments: Moments, step: int) -> Iterator[tuple[str, Files]]:
    """Yield the log cut short, and half written over the old one, at every ``step``-th byte that
    the transaction changed; then the database into which the log was half copied."""
    old, new = moments.before.log, moments.after.log
    first = next((i for i, (a, b) in enumerate(zip(old, new, strict=False)) if a != b), len(old))
    last = len(new)
    while last <= len(old) and old[last - 1] == new[last - 1]:
        last -= 1
    for at in range(first, last, step):
        yield "log cut short", Files(moments.after.database, new[:at])
        if at < len(old):
            yield "log half written", Files(moments.after.database, new[:at] + old[at:])
    yield "log whole", moments.after
    was, copied = moments.after.database, moments.copied.database
    for at in range(0, len(copied), max(step, SECTOR)):
        yield "log half copied", Files(copied[:at] + was[at:], new)


def opens_on(files: Files, folder: Path) -> int:
    """Put the files into an empty folder, open them, and tell which table is in force."""
    folder.mkdir(exist_ok=True)
    (folder / FILE).write_bytes(files.database)
    (folder / f"{FILE}-wal").write_bytes(files.log)
    connection, notice = open_database(folder / FILE, FORMAT)
    try:
        assert not notice, notice
        revisions = Revisions(connection)
        (newest,), _ = revisions.before(0, 1)
        pointers = revisions.pointers(newest.recipe)
        assert pointers == (newest.number, newest.number)
        return number_of(revisions.table(newest.number))
    finally:
        connection.close()
        for left in folder.iterdir():
            left.unlink()


def cut_everywhere(folder: Path, step: int) -> Counter[str]:
    """Open the files cut at every ``step``-th byte; what was found, counted.

    Raises
    ------
    AssertionError
        When a table is neither the old nor the new one.
    """
    found = Counter[str]()
    for restarted in (False, True):
        moments = around_a_transaction(folder / f"source {restarted}", restarted=restarted)
        for how, files in cuts(moments, step):
            number = opens_on(files, folder / "cut")
            assert number in ((NEW,) if how in WHOLE else (OLD, NEW)), (how, number)
            found[f"{how}: opened on the {'new' if number == NEW else 'old'} table"] += 1
    return found


def main() -> None:
    kills = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    step = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    logging.getLogger("kompass.store").setLevel(logging.ERROR)
    with tempfile.TemporaryDirectory() as folder:
        begin = time.monotonic()
        print(f"killed {kills} times:")
        for what, count in sorted(kill_at_random(Path(folder) / "kills", kills).items()):
            print(f"  {count:7d} {what}")
        # What is on the disk is given by the cut: memory serves as well, and faster.
        memory = Path("/dev/shm")
        place = memory if memory.is_dir() else Path(folder)
        print(f"cut at every {'byte' if step == 1 else f'{step}th byte'}:")
        with tempfile.TemporaryDirectory(dir=place) as cut:
            for what, count in sorted(cut_everywhere(Path(cut), step).items()):
                print(f"  {count:7d} {what}")
        print(f"nothing lost, in {time.monotonic() - begin:.0f} s")


if __name__ == "__main__":
    main()
