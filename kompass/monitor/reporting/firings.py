"""Tell of firings: on ``~/firings``, in the log and in the journal."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from typing import Any, Protocol

from builtin_interfaces.msg import Time
from kompass_interfaces.msg import RuleFiring
from rclpy.node import Node

from kompass.monitor.engine_loop import EngineLoop
from kompass.monitor.execution.outcome import Outcome
from kompass.monitor.execution.runs import Entry
from kompass.monitor.reporting.brief import brief
from kompass.rclpy_ext.log import write_log
from kompass.rclpy_ext.topic import QoSConfig
from kompass.rulebook.schema.journal import ActionRecord, FiringRecord

REPEATED = 60.0  # s within which the same failure is the same


class Journal(Protocol):
    """Where firings are kept; nothing but :meth:`use_once` waits for that."""

    def record_firing(self, entry: FiringRecord) -> FiringRecord:
        """Keep an entry; the same with its number."""

    def finish_firing(
        self,
        number: int,
        *,
        ended: float,
        ok: bool,
        error: str = "",
        actions: Sequence[ActionRecord] = (),
    ) -> None:
        """Add what came of it."""

    def use_once(self, rule_id: str, rule_hash: str) -> None:
        """A rule that fires once only has fired; kept when this returns."""


class Firings:
    """Hears of every step of a run, and tells everybody.

    Parameters
    ----------
    journal
        None when nothing can be stored.
    kept
        Told of every entry of the journal, when it is made.
    """

    def __init__(
        self,
        node: Node,
        loop: EngineLoop,
        journal: Journal | None,
        stamp: Callable[[], Time],
        kept: Callable[[FiringRecord], None],
    ) -> None:
        self._log = node.get_logger()
        self._loop, self._journal, self._stamp, self._kept = loop, journal, stamp, kept
        self._publisher = node.create_publisher(
            RuleFiring, f"{node.get_name()}/firings", QoSConfig(queue_size=100).to_ros()
        )
        self._actions: dict[int, list[ActionRecord]] = {}
        self._failing: dict[tuple[str, str], tuple[str, float]] = {}
        self._numbers = 0

    def begins(self, entry: Entry) -> None:
        """A run is about to begin; that of a rule that fires once must not begin again."""
        if entry.once and self._journal is not None:
            self._journal.use_once(entry.rule_id, entry.rule_hash)

    def fired(self, entry: Entry, message: Any) -> int:
        """A rule fired, or would have; the number of its entry in the journal."""
        if entry.kind == "firing":
            self._say(entry, "fired", True, entry.rule_id, self._details(entry))
        else:
            if entry.kind == "note":
                self._log.error(f"{entry.rule_id}: {entry.text}")
            elif entry.kind == "outranked":
                self._log.warning(f"{entry.rule_id} fired and was not carried out: {entry.text}")
            self._say(entry, "note", entry.kind == "shadow", entry.text, self._details(entry))
        return self._keep(entry, message)

    def acted(self, entry: Entry, number: int, outcome: Outcome) -> None:
        """One action of a run has ended."""
        self._log_outcome(entry, outcome)
        seconds = round(outcome.seconds, 3)
        self._actions.setdefault(number, []).append(
            ActionRecord(
                action=outcome.action,
                ok=outcome.ok,
                text=outcome.text,
                seconds=seconds,
                problem=outcome.problem,
            )
        )
        details = {"action": outcome.action, "seconds": seconds}
        self._say(entry, "action", outcome.ok, outcome.text, details)

    def _log_outcome(self, entry: Entry, outcome: Outcome) -> None:
        """A line of the log; one that fails as it did a moment ago is not told of again."""
        key = (entry.rule_id, outcome.action)
        if outcome.ok:
            self._failing.pop(key, None)
            write_log(self._log, "info", f"{entry.rule_id}: {outcome.action} done: {outcome.text}")
            return
        text, at = self._failing.get(key, ("", float("-inf")))
        self._failing[key] = (outcome.text, entry.at)
        if outcome.text != text or entry.at - at > REPEATED:
            failed = f"{entry.rule_id}: {outcome.action} failed: {outcome.text}"
            write_log(self._log, "error", failed)

    def ended(self, entry: Entry, number: int, ok: bool, error: str) -> None:
        """A run has ended."""
        actions = tuple(self._actions.pop(number, ()))
        if self._journal is not None:
            self._journal.finish_firing(
                number, actions=actions, ended=time.time(), ok=ok, error=error
            )
        self._say(entry, "done", ok, error, {})

    def announce(self, text: str) -> None:
        """Say what concerns the table and no single rule."""
        self._log.warning(text)
        loop = self._loop
        entry = Entry(
            kind="note",
            rule_id="",
            name="",
            once=False,
            revision=loop.revision,
            run_id=0,
            at=loop.now,
            rule_hash="",
            severity="warning",
            topic=None,
            text=text,
            leaves=(),
        )
        self._say(entry, "note", True, text, self._details(entry))
        self._keep(entry, None)

    def _keep(self, entry: Entry, message: Any) -> int:
        time_ = entry.at + self._loop.wall_offset
        self._numbers += 1
        record = FiringRecord(
            number=self._numbers,
            epoch=self._loop.epoch,
            run_id=entry.run_id,
            rule_id=entry.rule_id,
            name=entry.name,
            kind=entry.kind,
            time=time_,
            revision=entry.revision,
            rule_hash=entry.rule_hash,
            severity=entry.severity,
            topic=entry.topic,
            text=entry.text,
            leaves=entry.leaves,
            ended=None if entry.kind == "firing" else time_,
            message=brief(message),
        )
        if self._journal is not None:
            record = self._journal.record_firing(record)
        self._kept(record)
        return record.number

    def _details(self, entry: Entry) -> dict[str, Any]:
        return {
            "kind": entry.kind,
            "epoch": self._loop.epoch,
            "leaves": [leaf.model_dump(mode="json") for leaf in entry.leaves],
        }

    def _say(self, entry: Entry, phase: str, ok: bool, text: str, details: Any) -> None:
        self._publisher.publish(
            RuleFiring(
                stamp=self._stamp(),
                rule_id=entry.rule_id,
                revision=entry.rule_hash,
                table_revision=entry.revision,
                run_id=entry.run_id,
                phase=phase,
                ok=ok,
                text=text,
                details=json.dumps(details),
            )
        )
