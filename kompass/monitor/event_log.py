"""Where the monitor puts down all that its engine took, in order, as it was taken."""

from __future__ import annotations

from typing import Any, Protocol


class EventLog(Protocol):
    """Takes what the engine took; must neither wait nor raise.

    ``now_ns`` is the reading of the monotonic clock that the engine was given (as
    ``now_ns * 1e-9`` seconds).
    """

    def message(self, topic: str, type_name: str, raw: bytes, now_ns: int) -> None:
        """A message, serialised as it came (CDR)."""

    def event(self, kind: str, data: dict[str, Any], now_ns: int) -> None:
        """Anything else: an event of :mod:`kompass.backtest.event_log` as JSON data."""

    def text(self, kind: str, text: str, now_ns: int) -> None:
        """The same as :meth:`event`, for one that is JSON text already."""

    def close(self) -> None:
        """Nothing follows."""


class NoEventLog:
    """Keeps nothing."""

    def message(self, topic: str, type_name: str, raw: bytes, now_ns: int) -> None:
        """Let it go."""

    def event(self, kind: str, data: dict[str, Any], now_ns: int) -> None:
        """Let it go."""

    def text(self, kind: str, text: str, now_ns: int) -> None:
        """Let it go."""

    def close(self) -> None:
        """Nothing to close."""
