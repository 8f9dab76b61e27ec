"""A week of missions, edits and faults on the timeline: how long a first look takes, and the disk.

.venv/bin/python benchmarks/timeline_week.py [DAYS]
"""

import random
import statistics
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from kompass.store.timeline_store import TimelineStore
from kompass.timeline.entry import TimelineEntry
from kompass.timeline.happening import Began, Happened, Over
from kompass.timeline.log import TimelineLog
from kompass.timeline.query import TimelineQuery

DAY = 86_400.0
LOOKS = 20


def main() -> None:
    days = float(sys.argv[1]) if len(sys.argv) > 1 else 7.0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        now = 1_800_000_000.0
        with TimelineStore.open(folder, clock=lambda: now) as store:
            began = time.perf_counter()
            count = fill(store, now - days * DAY, now)
            took = time.perf_counter() - began
            print(f"{count} happenings written in {took:.1f} s")
        size = sum(each.stat().st_size for each in folder.iterdir())
        began = time.perf_counter()
        with TimelineStore.open(folder, clock=lambda: now) as store:
            print(f"{store.newest()} entries, the newest of each kind kept: {size / 1e6:.1f} MB,")
            print(f"opened in {1e3 * (time.perf_counter() - began):.0f} ms")
            for what, query in queries(now).items():
                times = []
                for _ in range(LOOKS):
                    began = time.perf_counter()
                    page = store.page(query)
                    times.append(1e3 * (time.perf_counter() - began))
                figures = f"p50 {statistics.median(times):6.1f} ms, most {max(times):6.1f} ms"
                print(f"{what:34s} {figures}; {len(page.entries)} entries, {len(page.slots)} slots")


def fill(store: TimelineStore, begin: float, end: float) -> int:
    """A goal every minute, a firing every ten seconds, an edit every quarter of an hour."""
    log, chance = TimelineLog(), random.Random(1)
    count, batch = 0, list[TimelineEntry]()
    now = begin
    while now < end:
        goal = f"goal {count}"
        seen: list[Happened | Began | Over] = [
            Began(now, "goal", goal, "Goal 1.00, 2.00", source="planner"),
            *(
                Happened(now + 10.0 * k, "rule", f"rule {k}", "near", key=f"rule {chance.random()}")
                for k in range(5)
            ),
            Over(now + 50.0, goal, "Arrived, 2 cm off."),
        ]
        if chance.random() < 1 / 15:
            seen.append(
                Happened(now + 51.0, "edit", "Revision 5 in force", "less noise", who="ava")
            )
        if chance.random() < 1 / 60:
            seen += [
                Began(now + 52.0, "fault", "scan", "Held: no laser scan arrives", level="error"),
                Over(now + 55.0, "scan"),
            ]
        for each in seen:
            count += 1
            batch += log.take(each)
        if len(batch) > 500:
            store.put(batch)
            batch.clear()
        now += 60.0
    store.put(batch)
    return count


def queries(now: float) -> dict[str, TimelineQuery]:
    """What a page asks."""
    week, hour = now - 7 * DAY, now - 3600.0
    return {
        "first look: the last hour": TimelineQuery(count=60, since=hour, until=now, slots=120),
        "a week": TimelineQuery(count=60, since=week, until=now, slots=120),
        "a week, edits only": TimelineQuery(
            count=60, since=week, until=now, slots=120, kinds=("edit",)
        ),
        "a week, words that nobody wrote": TimelineQuery(
            count=60, since=week, until=now, slots=120, text="no such word"
        ),
    }


if __name__ == "__main__":
    main()
