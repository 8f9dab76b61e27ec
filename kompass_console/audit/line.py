"""One line of the audit log: what is in it, and how it is chained to the line before."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

BEGINNING = "0" * 64  # what the first line of all names as the digest of the line before

_LONGEST_TEXT = 500  # characters
_LONGEST_LIST = 100
_LARGEST = 6_000  # bytes of a line
_DEEPEST = 4


@dataclass(frozen=True, slots=True)
class AuditEntry:
    """Who did what, from where, and how it ended.

    Attributes
    ----------
    time
        Of the deed, seconds since the epoch.
    session
        The beginning of the log-in's id; empty for who was not logged in.
    address
        From where; empty for the console itself.
    details
        JSON; what was before and after, and what else tells the deed from others.
    """

    time: float
    who: str
    role: str
    session: str
    address: str
    what: str
    outcome: str
    details: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class ChainLink:
    """What a line says of its place: its number, and the digests of the line before and its own."""

    seq: int
    before: str
    digest: str


def encode(entry: AuditEntry, seq: int, before: str) -> bytes:
    """A line without its end. Texts are cut to a bounded length; it holds no control characters."""
    body = {
        "seq": seq,
        "time": _timestamp(entry.time),
        "who": _bounded(entry.who),
        "role": entry.role,
        "session": entry.session,
        "from": _bounded(entry.address),
        "what": _bounded(entry.what),
        "outcome": _bounded(entry.outcome),
    }
    details = {key: value for key, value in entry.details.items() if key not in body}
    line = _dump({**body, **_bounded(details), "prev": before})
    if len(line) > _LARGEST:
        line = _dump({**body, "details": "too large to be kept", "prev": before})
    return line


def digest(line: bytes) -> str:
    """SHA-256 of a line without its end."""
    return hashlib.sha256(line).hexdigest()


def decode(line: bytes) -> dict[str, Any] | None:
    """What a line says; None when it is no whole line of an audit log."""
    try:
        said = json.loads(line)
    except (ValueError, RecursionError):
        return None
    if not isinstance(said, dict):
        return None
    seq, before = said.get("seq"), said.get("prev")
    if not isinstance(seq, int) or isinstance(seq, bool) or not isinstance(before, str):
        return None
    return said


def link_of(line: bytes) -> ChainLink | None:
    """The place of a line in the chain; None when it is no whole line."""
    said = decode(line)
    return None if said is None else ChainLink(said["seq"], said["prev"], digest(line))


def _dump(body: Mapping[str, Any]) -> bytes:
    # ASCII: neither a terminal nor an editor can be made to do anything by what stands here.
    return json.dumps(body, separators=(",", ":"), default=str).encode("ascii")


def _timestamp(moment: float) -> str:
    whole, thousandths = divmod(round(moment * 1000), 1000)
    return f"{time.strftime('%Y-%m-%dT%H:%M:%S', time.gmtime(whole))}.{thousandths:03d}Z"


def _bounded(value: Any, depth: int = 0) -> Any:
    if isinstance(value, str):
        return value if len(value) <= _LONGEST_TEXT else value[: _LONGEST_TEXT - 1] + "…"
    if depth >= _DEEPEST:
        return _bounded(str(value))
    if isinstance(value, Mapping):
        some = list(value.items())[:_LONGEST_LIST]
        return {str(key)[:100]: _bounded(each, depth + 1) for key, each in some}
    if isinstance(value, list | tuple | set | frozenset):
        return [_bounded(each, depth + 1) for each in list(value)[:_LONGEST_LIST]]
    return value
