"""Back-test a table on a recording on disk."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from kompass.backtest.engine import backtest
from kompass.backtest.event_log import LoggedEvent, Lost
from kompass.backtest.report import BacktestReport
from kompass.recorder.mcap.reader import Recording
from kompass.recorder.places import known_recording, rotation_folder
from kompass.recorder.replay.replay import Replay
from kompass.recorder.rotating_recording import rotation_files
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.schema.table import Table

REPORT_PERIOD = 0.1  # s between two words of progress


class Backtested(NamedTuple):
    """A report, and what a person must know of the recording to judge it; empty for nothing."""

    report: BacktestReport
    remark: str


class NoRecording(RuntimeError):
    """There is nothing to replay; the message says why."""


def recorded_files(recordings: Path, name: str) -> list[Path]:
    """Files of one of the robot's recordings; of the flight recorder's ring for an empty name.

    Raises
    ------
    BadName
        When there is no such recording among the robot's own.
    """
    if name:
        return [known_recording(recordings, name)]
    return rotation_files(rotation_folder(recordings))


def backtest_files(
    table: Table,
    paths: Sequence[Path],
    seconds: float = 0.0,
    progress: Callable[[float], None] | None = None,
) -> Backtested:
    """Tell what a table would have done.

    Parameters
    ----------
    table
        Proposed.
    paths
        Any MCAP files with messages of ROS 2, ours or not, in the order of their making.
    seconds
        How much of the end to replay; 0 for all.
    progress
        Told now and then which share is done; may raise to cancel.

    Raises
    ------
    NotMcap
        When a file cannot be read.
    NoRecording
        When there is nothing in them.
    """
    with Recording(paths) as recording:
        replay = Replay(recording, compile_table(table), seconds)
        if not recording.files:
            raise NoRecording("nothing is recorded yet; is the flight recorder running?")
        did = list(replay.recorded())
        report = backtest(
            table,
            replay.events(),
            did,
            before=replay.before(),
            total=replay.total,
            progress=_seldom(progress),
            clock=time.monotonic,
        )
        return Backtested(report, _remark(replay.has_engine, did))


def _remark(has_engine: bool, did: Sequence[LoggedEvent]) -> str:
    if not has_engine:
        return "the recording has no rule engine in it: there are no firings to compare with"
    lost = [event for event in did if isinstance(event, Lost)]
    if not lost:
        return ""
    return (
        f"the recorder lost {sum(event.number for event in lost)} inputs in {len(lost)} places "
        f"({lost[0].reason}): from there on the comparison is not exact"
    )


def _seldom(progress: Callable[[float], None] | None) -> Callable[[float], None] | None:
    if progress is None:
        return None
    last = float("-inf")

    def tell(share: float) -> None:
        nonlocal last
        if time.monotonic() - last >= REPORT_PERIOD or share >= 1.0:
            last = time.monotonic()
            progress(share)

    return tell
