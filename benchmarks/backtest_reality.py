"""Whether a back-test tells the truth: a faulted run, replayed with the table that ran and another.

    python benchmarks/backtest_reality.py [MINUTES]

The same table must give the same firings: rules, times, leaves. With one threshold moved, exactly
that rule's firings may differ, and must be those that its scans call for (worked out apart from
the engine). Then another table is applied while the robot drives: back-tested from that moment, it
must fire as it did.
"""

import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from kompass.backtest.report import BacktestFiring
from tests.recorder.reality import (
    EDITED,
    NEAR,
    Reality,
    applied_table,
    expected_near,
    last_applied,
    reality_table,
    recorded,
    same_times,
    since,
)
from tests.support.robot import Robot
from tests.support.stack import Stack

THRESHOLD = 0.45  # m


def _verdicts(firings: list[BacktestFiring]) -> str:
    count = Counter(f.verdict for f in firings)
    return ", ".join(f"{count[verdict]} {verdict}" for verdict in ("same", "new", "gone"))


def _applied_then(reality: Reality, seconds: float) -> bool:
    """Whether a table that is applied now fires as a back-test from this moment says."""
    table = applied_table(THRESHOLD)
    reality.apply(table)
    reality.drive(seconds)
    applied = last_applied(reality.save("applied"))
    firings = list(reality.backtest(table, "applied", seconds=applied.seconds).firings)
    print(f"applied, and back-tested from then: {_verdicts(firings)}")
    return [(f.rule_id, round(f.time, 5), f.verdict, f.leaves) for f in firings] == [
        (f.rule_id, round(f.time, 5), "same", f.leaves) for f in applied.firings
    ]


def main() -> None:
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else 5.0
    stack = Stack.simulated()
    robot = Robot(stack.domain)
    try:
        robot.ready()
        reality = Reality(robot)
        table = reality_table(THRESHOLD)
        reality.begin(stack, table)
        reality.drive(minutes * 60)
        path = reality.save("reality")
        record = recorded(path)
        print(f"{path.stat().st_size / 1e6:.1f} MB, {len(record.firings)} firings recorded")

        shares: list[float] = []
        began = time.monotonic()
        report = reality.backtest(table, "reality", progress=shares.append)
        seconds = time.monotonic() - began
        length = report.end - report.start
        same = since(report, record.in_force)
        identical = [(f.rule_id, round(f.time, 5), f.verdict, f.leaves) for f in same] == [
            (f.rule_id, round(f.time, 5), "same", f.leaves) for f in record.firings
        ]
        print(
            f"same table: {_verdicts(same)}; {length:.0f} s ({report.messages} messages) in "
            f"{seconds:.1f} s = {length / seconds:.0f} x real time ({length / report.seconds:.0f} "
            f"x without starting), progress told {len(shares)} times"
        )
        print("  " + ", ".join(f"{t.rule_id} {t.recorded}/{t.proposed}" for t in report.tallies))

        for firing in same:
            if firing.verdict != "same":
                print(f"  {firing.verdict}: {firing.rule_id} at {firing.at:.6f} s {firing.text}")

        edited = THRESHOLD - EDITED
        other = since(reality.backtest(reality_table(edited), "reality"), record.in_force)
        touched = sorted({f.rule_id for f in other if f.verdict != "same"})
        near = [f.time for f in other if f.rule_id == NEAR and f.verdict != "gone"]
        wanted = expected_near(path, edited, record)
        print(
            f"threshold {THRESHOLD} -> {edited:.2f} m: {_verdicts(other)}, all of rules {touched}; "
            f"'{NEAR}' fires {len(near)} times, expected {len(wanted)}"
        )
        as_expected = same_times(near, wanted) and set(touched) <= {NEAR, "not-near"}
        as_applied = _applied_then(reality, minutes * 60)
        print(f"{identical=} {as_expected=} {as_applied=}")
        sys.exit(0 if identical and as_expected and as_applied else 1)
    finally:
        robot.close()
        stack.close()


if __name__ == "__main__":
    main()
