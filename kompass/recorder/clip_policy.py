"""Keep what surrounds a firing: decided by the monitor, carried out by the recorder."""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import NamedTuple

from kompass.recorder.clip_writer import ClipNotSaved, drop_partials, save_clip
from kompass.recorder.places import SUFFIX, saved_folder
from kompass.rules.schema.table import Severity

log = logging.getLogger("kompass.recorder")

SETTING = "KOMPASS_KEEP_FIRINGS"
NEVER = "never"
KEEP = "keep"  # kind of the order on the queue
PREFIX = "firing-"

BEFORE = 25.0  # s
AFTER = 5.0  # s
LONGEST = 120.0  # s, when one firing follows another
PAUSE = 300.0  # s before the same rule has another clip kept
KEPT = 20  # clips, beyond which the oldest goes
SETTLE = 1.5  # s for the rotating recording to be on disk


class ClipRequest(NamedTuple):
    """The order to keep a clip; nanoseconds since the epoch."""

    path: str
    start: int
    end: int


def least_severity(environment: Mapping[str, str] = os.environ) -> Severity | None:
    """From which severity on firings are kept: KOMPASS_KEEP_FIRINGS, ``error`` by default.

    Raises
    ------
    ValueError
        When it names no severity, nor ``never``.
    """
    text = environment.get(SETTING, "error").strip().lower()
    if text in (NEVER, "off", "0", ""):
        return None
    try:
        return Severity[text.upper()]
    except KeyError:
        names = ", ".join(severity.name.lower() for severity in Severity)
        raise ValueError(
            f"{SETTING} = {text!r} is not a severity; choose one of {names}, or {NEVER}"
        ) from None


class ClipPolicy:
    """The monitor's end: which firing is kept, and where.

    Parameters
    ----------
    recordings
        Folder of all recordings.
    least
        From which severity on; None for none.
    """

    def __init__(self, recordings: Path, least: Severity | None) -> None:
        self._folder, self._least = saved_folder(recordings), least
        self._last: ClipRequest | None = None
        self._rules: dict[str, int] = {}  # when a clip was last begun for a rule

    def fired(self, rule_id: str, severity: str, at: int) -> ClipRequest | None:
        """What to keep of a firing at ``at`` nanoseconds; None for nothing.

        A firing that follows closely lengthens the clip that is kept already.
        """
        if self._least is None or Severity[severity.upper()] < self._least:
            return None
        end = at + int(AFTER * 1e9)
        last = self._last
        if last is not None and at <= last.end and end - last.start <= LONGEST * 1e9:
            self._last = last._replace(end=max(end, last.end))
            return self._last
        begun = self._rules.get(rule_id)
        if begun is not None and 0 <= at - begun < PAUSE * 1e9:
            return None
        self._rules[rule_id] = at
        stamp = time.strftime("%Y%m%dT%H%M%SZ", time.gmtime(at * 1e-9))
        name = f"{PREFIX}{stamp}-{rule_id[:60]}{SUFFIX}"
        self._last = ClipRequest(str(self._folder / name), at - int(BEFORE * 1e9), end)
        return self._last


class ClipKeeper:
    """The recorder's end: carries orders out when their time has come.

    Parameters
    ----------
    recordings
        Folder of all recordings.
    run
        Calls a function at once or in a thread; copying a clip takes seconds on a busy machine.
    """

    def __init__(
        self, recordings: Path, run: Callable[[Callable[[], None]], object] = lambda job: job()
    ) -> None:
        self._recordings, self._run = recordings, run
        self._orders: dict[str, ClipRequest] = {}
        drop_partials(saved_folder(recordings))

    def order(self, keep: ClipRequest) -> None:
        """Keep a clip once it is over; a second order for a file replaces the first."""
        self._orders[keep.path] = keep

    def carry_out(self, now: int) -> None:
        """Keep what is over at ``now`` nanoseconds. What cannot be kept is logged."""
        due = [k for k in self._orders.values() if now >= k.end + SETTLE * 1e9]
        for keep in due:
            del self._orders[keep.path]
        if due:
            self._run(partial(self._keep, due))

    def _keep(self, due: list[ClipRequest]) -> None:
        for keep in due:
            try:
                save_clip(self._recordings, Path(keep.path), keep.start, keep.end)
            except (ClipNotSaved, ValueError, OSError) as error:
                log.error("a firing is not kept: %s", error)
        self._prune()

    def _prune(self) -> None:
        folder = saved_folder(self._recordings)
        kept = sorted(folder.glob(f"{PREFIX}*{SUFFIX}"), key=lambda path: path.stat().st_mtime)
        for path in kept[:-KEPT]:
            path.unlink()
