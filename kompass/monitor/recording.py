"""What the monitor needs of the flight recorder."""

from __future__ import annotations

from typing import Any, Protocol

from rclpy.executors import Executor
from rclpy.node import Node

from kompass.monitor.event_log import EventLog, NoEventLog
from kompass.rulebook.schema.journal import FiringRecord


class Recording(Protocol):
    """The flight recorder, as the monitor's process sees it.

    Attributes
    ----------
    tape
        Takes what the engine takes.
    """

    @property
    def tape(self) -> EventLog: ...

    def start(self, node: Node, executor: Executor, store: Any) -> None:
        """Offer what else there is (``~/backtest_rules``); called once, on the executor's thread.

        ``store`` is the robot's :class:`kompass.store.RuleStore`, or None.
        """

    def fired(self, entry: FiringRecord) -> None:
        """An entry of the journal was made; must not wait."""

    def save(self, seconds: float, name: str) -> str:
        """Keep the last seconds (0: all there is) under a name (empty: one of the time); the path.

        Called on a worker, which may wait. Raises what it cannot, with a sentence for a person.
        """

    def close(self) -> None:
        """The monitor ends."""


class NoRecording:
    """The flight recorder is off."""

    tape: EventLog = NoEventLog()

    def start(self, node: Node, executor: Executor, store: Any) -> None:
        """Offer nothing."""

    def fired(self, entry: FiringRecord) -> None:
        """Let it go."""

    def save(self, seconds: float, name: str) -> str:
        """Refuse.

        Raises
        ------
        RuntimeError
            Always.
        """
        raise RuntimeError("the flight recorder is off; start the stack without --no-record")

    def close(self) -> None:
        """Nothing to end."""
