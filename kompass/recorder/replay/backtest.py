"""Back-test a table on a recording on disk."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from kompass.backtest.engine import backtest
from kompass.backtest.event_log import Began, LoggedEvent, Lost, Resumed, Swapped
from kompass.backtest.report import BacktestReport
from kompass.recorder.mcap.reader import Recording
from kompass.recorder.places import known_recording, rotation_folder
from kompass.recorder.replay.beginning import beginning
from kompass.recorder.replay.replay import Replay
from kompass.recorder.rotating_recording import rotation_files
from kompass.rulebook.views.wording import seconds as seconds_text
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.schema.table import Table

_TOLD = 3  # changes of the rules that a remark names
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
        report = _since(report, beginning(recording) * 1e-9) if not seconds else report
        if not replay.has_engine:
            return Backtested(
                report,
                "the recording has no rule engine in it: there are no firings to compare with",
            )
        remarks = (_of_another_recipe(report.start, did), _of_changes(report.start, did))
        return Backtested(report, "; ".join(filter(None, (*remarks, _of_losses(did)))))


def _since(report: BacktestReport, begin: float) -> BacktestReport:
    """With times from the drive's start on, as all else that tells of a drive of a drill."""
    if begin <= report.start:
        return report
    before = begin - report.start
    firings = (one.model_copy(update={"at": one.at - before}) for one in report.firings)
    return report.model_copy(update={"start": begin, "firings": tuple(firings)})


def _of_another_recipe(start: float, did: Sequence[LoggedEvent]) -> str:
    begins = [event for event in did if isinstance(event, Began | Resumed) and event.recipe]
    others = [place for place, event in enumerate(begins) if event.recipe != begins[-1].recipe]
    if not others:
        return ""
    left = begins[others[-1] + 1].wall - start
    return (
        f"up to {seconds_text(left)} into it another recipe was running: what is said of that time "
        "is of a robot that was set up otherwise"
    )


def _of_changes(start: float, did: Sequence[LoggedEvent]) -> str:
    """Say that rules were applied meanwhile: firings differ for that alone."""
    offset, revision, found = 0.0, 0, []
    for event in did:
        if isinstance(event, Began | Resumed):
            offset, revision = event.wall - event.now, event.revision
        elif isinstance(event, Swapped) and event.revision != revision:
            revision = event.revision
            found.append(f"revision {revision} {seconds_text(event.now + offset - start)} into it")
    if not found:
        return ""
    more = f" and {len(found) - _TOLD} more" if len(found) > _TOLD else ""
    return (
        f"other rules were applied meanwhile ({', '.join(found[:_TOLD])}{more}): these are taken "
        "to be in force from its start to its end all the same"
    )


def _of_losses(did: Sequence[LoggedEvent]) -> str:
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
