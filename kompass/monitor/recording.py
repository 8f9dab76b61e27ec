"""What the monitor needs of the flight recorder, which the launcher hands to it."""

from __future__ import annotations

from typing import Any, Protocol

from kompass.access.gatekeeper import Gatekeeper
from kompass.bus.node import Executor, Node
from kompass.rulebook.schema.journal import FiringRecord
from kompass.store.store import RuleStore


class EventLog(Protocol):
    """Takes all that the engine took, in order; must neither wait nor raise.

    ``now_ns`` is the reading of the monotonic clock that the engine was given (as
    ``now_ns * 1e-9`` seconds).
    """

    def message(self, topic: str, type_name: str, raw: bytes, now_ns: int) -> None:
        """Take a message, serialised as it came (CDR)."""

    def event(self, kind: str, data: dict[str, Any], now_ns: int) -> None:
        """Take anything else: an event of :mod:`kompass.backtest.event_log` as JSON data."""

    def text(self, kind: str, text: str, now_ns: int) -> None:
        """Take the same as :meth:`event`, for one that is JSON text already."""


class FlightRecording(Protocol):
    """The flight recorder, as the monitor's process sees it."""

    @property
    def event_log(self) -> EventLog | None:
        """Takes what the engine takes; None when nothing is recorded."""

    def start(
        self, node: Node, executor: Executor, store: RuleStore | None, gatekeeper: Gatekeeper
    ) -> None:
        """Offer ``~/backtest_rules``; called once, on the executor's thread.

        Parameters
        ----------
        store
            Where the journal learns which recording belongs to a firing.
        gatekeeper
            Lets requests in.
        """

    def fired(self, entry: FiringRecord) -> None:
        """Take note of an entry of the journal; must not wait."""

    def save(self, seconds: float, name: str, until_ns: int) -> str:
        """Keep the last seconds under a name, and return the path of the file.

        Called on a worker, which may wait. What it raises has a sentence for a person.

        Parameters
        ----------
        seconds
            0 for all there is.
        name
            Empty for one that is made of the time.
        until_ns
            Where it ends: monotonic time between two steps of the engine [ns]. What came later may
            be there without what the engine made of it.
        """

    def close(self) -> None:
        """End what is under way, because the monitor ends."""
