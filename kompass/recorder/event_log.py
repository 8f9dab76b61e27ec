"""The monitor's end of the recorder: what the engine took, onto the queue."""

from __future__ import annotations

import json
from typing import Any

from kompass.recorder.shm_queue import ShmQueue


class RecorderEventLog:
    """A :class:`kompass.monitor.recording.EventLog` that hands all to the recorder's process.

    It costs some microseconds for each message, waits for nothing, and never raises for a
    recorder that is slow or dead: what does not fit is counted, and the recording says so.
    """

    def __init__(self, queue: ShmQueue) -> None:
        self._queue = queue

    def message(self, topic: str, type_name: str, raw: bytes, now_ns: int) -> None:
        """A message, serialised as it came (CDR)."""
        self._queue.write(now_ns, False, topic, type_name, raw)

    def event(self, kind: str, data: dict[str, Any], now_ns: int) -> None:
        """An event of :mod:`kompass.backtest.event_log` as JSON data."""
        self.text(kind, json.dumps(data, separators=(",", ":"), allow_nan=True), now_ns)

    def text(self, kind: str, text: str, now_ns: int) -> None:
        """The same, for one that is JSON text already."""
        self._queue.write(now_ns, True, kind, "", text.encode())
