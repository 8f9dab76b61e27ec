"""The flight recorder, as the monitor sees it."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path
from typing import Any

from rclpy.executors import Executor
from rclpy.node import Node

from kompass.access.gatekeeper import Gatekeeper
from kompass.recorder.clip_policy import KEEP, ClipPolicy
from kompass.recorder.event_log import RecorderEventLog
from kompass.recorder.places import saved_path
from kompass.recorder.replay.backtest_server import BacktestServer
from kompass.recorder.replay.worker import Worker
from kompass.recorder.shm_queue import ShmQueue
from kompass.rulebook.schema.journal import FiringRecord
from kompass.rules.schema.table import Severity

SETTLE = 3.0  # s within which what was just heard must be on disk


class NotRecording(RuntimeError):
    """The flight recorder is off."""


class FlightRecorder:
    """A :class:`kompass.monitor.recording.FlightRecording`.

    Parameters
    ----------
    recordings
        Folder of all recordings.
    queue
        To the recorder's process; None when nothing is recorded.
    least
        Severity from which on firings are kept; None for none.
    """

    def __init__(self, recordings: Path, queue: ShmQueue | None, least: Severity | None) -> None:
        self._recordings, self._queue = recordings, queue
        self.event_log = None if queue is None else RecorderEventLog(queue)
        self._clip_policy = ClipPolicy(recordings, least)
        self._store: Any = None
        self._server: BacktestServer | None = None

    def start(self, node: Node, executor: Executor, store: Any, gatekeeper: Gatekeeper) -> None:
        """Offer ``~/backtest_rules``."""
        self._store = store
        self._server = BacktestServer(node, executor, self._recordings, gatekeeper)

    def fired(self, entry: FiringRecord) -> None:
        """Have what surrounds a firing kept, if it is severe enough."""
        if entry.kind != "firing" or self._queue is None:
            return
        now_ns = time.monotonic_ns()
        keep = self._clip_policy.fired(
            entry.rule_id, entry.severity, now_ns + self._queue.offset_ns
        )
        if keep is not None:
            self._queue.write(now_ns, True, KEEP, "", json.dumps(keep._asdict()).encode())
            if self._store is not None:
                self._store.keep_recording(entry.number, keep.path)

    def save(self, seconds: float, name: str, until_ns: int) -> str:
        """Keep the last seconds (0: all there is) up to a moment under a name; the file's path.

        Raises
        ------
        NotRecording
            When nothing is recorded.
        BadName
            When the name could leave the folder of kept recordings.
        ValueError
            When ``seconds`` is no length of time.
        WorkerFailed
            When there is such a file already, nothing to keep, or the disk is full.
        """
        if self._queue is None:
            raise NotRecording(
                "the flight recorder is off; start the stack without --no-record (KOMPASS_RECORD=0)"
            )
        if not (math.isfinite(seconds) and seconds >= 0):
            raise ValueError(f"seconds = {seconds!r} is no length of time; give 0 for all there is")
        name = name or time.strftime("%Y%m%dT%H%M%SZ", time.gmtime())
        path = saved_path(self._recordings, name)
        self._queue.wait_for_disk(SETTLE)
        end = until_ns + self._queue.offset_ns
        start = end - int(seconds * 1e9) if seconds else 0
        job = {"kind": "save", "recordings": str(self._recordings), "path": str(path)}
        with Worker(**job, start=start, end=end) as worker:
            return str(worker.answer())

    def close(self) -> None:
        """End back-tests under way."""
        if self._server is not None:
            self._server.close()
