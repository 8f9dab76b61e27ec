"""What is remembered of sessions beside their cookies: who has logged out, and who was seen when.

A cookie carries its own proof, so a console that was started again would take one that had been
logged out. This is kept in a small file, which only its owner may read.
"""

from __future__ import annotations

import logging
import os
import threading
from collections import OrderedDict
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from kompass.invalid import first_invalid
from kompass_console.private_file import alone_in, replace_file
from kompass_console.schema.roles import Role

MOST_REVOKED = 5000  # of each role
MOST_SEEN = 2000  # of each role

_logger = logging.getLogger(__name__)

_Time = Annotated[float, Field(allow_inf_nan=False)]


class _Kept(BaseModel):
    """The file. Times are epoch s; sessions go by their id, the oldest first."""

    model_config = ConfigDict(extra="forbid")

    revoked: dict[Role, dict[str, _Time]] = {}
    not_before: dict[Role, _Time] = {}
    seen: dict[Role, dict[str, _Time]] = {}


class SessionRecords:
    """Who has logged out, and when who was last seen. Any thread.

    There is room for so many of each role, so that nobody can push out those of another one. When
    too many have logged out, the oldest are refused by their age: with them go all sessions of
    that role that are older. When too many were seen, the one seen least recently counts as
    unseen since its log-in.

    Parameters
    ----------
    file
        None to remember in memory only.
    now
        Epoch s; a file that is there and cannot be read ends all sessions from before it.
    """

    def __init__(self, file: Path | None, now: float) -> None:
        self._file = file
        self._lock = threading.Lock()
        self._writing = threading.Lock()
        self._revoked: dict[Role, OrderedDict[str, float]] = {r: OrderedDict() for r in Role}
        self._seen: dict[Role, OrderedDict[str, float]] = {r: OrderedDict() for r in Role}
        self._not_before = dict.fromkeys(Role, float("-inf"))
        self._changed = False
        self._left_out = False  # somebody logged out, and the file does not say so
        if file is not None:
            self._load(file, now)

    def revoke(self, role: Role, session_id: str, issued: float) -> None:
        """Refuse a session from now on; on disk when this returns.

        Where the disk takes nothing the file is emptied: then a console that is started again
        knows of nobody, and all have to log in.
        """
        with self._lock:
            self._add_revoked(role, session_id, issued)
            self._seen[role].pop(session_id, None)
            self._changed = self._left_out = True
        self.save()

    def is_revoked(self, role: Role, session_id: str, issued: float) -> bool:
        with self._lock:
            return session_id in self._revoked[role] or issued <= self._not_before[role]

    def last_seen(self, role: Role, session_id: str) -> float | None:
        """Epoch s; None when it is not known."""
        with self._lock:
            return self._seen[role].get(session_id)

    def saw(self, role: Role, session_id: str, now: float) -> None:
        """A session is in use; written with the next `save`."""
        with self._lock:
            seen = self._seen[role]
            seen[session_id] = now
            seen.move_to_end(session_id)
            while len(seen) > MOST_SEEN:
                seen.popitem(last=False)
            self._changed = True

    def save(self) -> None:
        """Write what has changed. A disk that is full is told, and keeps nobody from anything.

        Nobody else waits for the disk: whoever asks meanwhile is answered from memory.
        """
        if self._file is None:
            return
        with self._writing:
            with self._lock:
                if not self._changed:
                    return
                left_out, self._left_out = self._left_out, False
                self._changed = False
            try:
                with alone_in(self._file.parent):
                    written = _of_others(self._file)
                    with self._lock:
                        self._take(written)
                        text = self._kept().model_dump_json()
                    replace_file(self._file, text)
            except OSError as error:
                with self._lock:
                    self._changed = True
                    self._left_out |= left_out
                _logger.error(
                    "sessions not written to %s: %s; %s",
                    self._file,
                    error,
                    "everybody has to log in again when the console is started again"
                    if left_out and _emptied(self._file)
                    else "who logs out now stays out only until the console is started again",
                )

    def _load(self, file: Path, now: float) -> None:
        try:
            self._take(_read(file))
        except FileNotFoundError:
            return
        except (OSError, ValidationError) as error:
            why = error.strerror if isinstance(error, OSError) else first_invalid(error).text
            # Nobody knows who had logged out: all have to log in again.
            self._not_before = dict.fromkeys(Role, now)
            self._changed = True
            _logger.error("%s cannot be read (%s); everybody has to log in again", file, why)

    def _take(self, kept: _Kept) -> None:
        for role, before in kept.not_before.items():
            self._not_before[role] = max(self._not_before[role], before)
        for role, revoked in kept.revoked.items():
            for session_id, issued in revoked.items():
                self._add_revoked(role, session_id, issued)
        for role, seen in kept.seen.items():
            mine = self._seen[role]
            for session_id, when in seen.items():
                if session_id not in self._revoked[role]:
                    mine[session_id] = max(when, mine.get(session_id, when))
            newest = sorted(mine.items(), key=lambda item: item[1])[-MOST_SEEN:]
            self._seen[role] = OrderedDict(newest)

    def _add_revoked(self, role: Role, session_id: str, issued: float) -> None:
        revoked = self._revoked[role]
        revoked[session_id] = issued
        while len(revoked) > MOST_REVOKED:
            _, oldest = revoked.popitem(last=False)
            self._not_before[role] = max(self._not_before[role], oldest)

    def _kept(self) -> _Kept:
        return _Kept(
            revoked={role: dict(ids) for role, ids in self._revoked.items()},
            not_before={r: t for r, t in self._not_before.items() if t != float("-inf")},
            seen={role: dict(ids) for role, ids in self._seen.items()},
        )


def _read(file: Path) -> _Kept:
    return _Kept.model_validate_json(file.read_bytes())


def _emptied(file: Path) -> bool:
    """Leave nothing in a file, which a full disk allows, too."""
    try:
        os.close(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_NOFOLLOW, 0o600))
    except OSError:
        return False
    return True


def _of_others(file: Path) -> _Kept:
    """What another console of this robot may have written meanwhile."""
    try:
        return _read(file)
    except (FileNotFoundError, ValueError):
        return _Kept()
