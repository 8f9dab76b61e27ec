"""Who did what, when, and how it ended: one line of JSON per write."""

from __future__ import annotations

import json
import logging
import threading
import time
from pathlib import Path

_logger = logging.getLogger("kompass_console.web.audit")


class AuditTrail:
    """Appends every write to a file (when given one) and to the logger `kompass_console.web.audit`.

    A full disk must not keep anybody from pressing STOP: a line that cannot be written to the
    file is logged as an error and the action goes on.
    """

    def __init__(self, file: Path | None = None) -> None:
        self._file = file
        self._lock = threading.Lock()

    def record(self, who: str, role: str, what: str, outcome: str, **details: object) -> None:
        """Record one write; `details` must be JSON."""
        entry = {
            "time": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
            "who": who,
            "role": role,
            "what": what,
            "outcome": outcome,
            **details,
        }
        line = json.dumps(entry, ensure_ascii=False)
        _logger.info(line)
        if self._file is None:
            return
        try:
            with self._lock, self._file.open("a", encoding="utf-8") as file:
                file.write(line + "\n")
        except OSError as error:
            _logger.error("audit line not written to %s: %s", self._file, error)
