"""Tell of firings: on ``~/firings``, in the log and in the journal."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from builtin_interfaces.msg import Time
from kompass_interfaces.msg import RuleFiring

from kompass.bus.node import Node
from kompass.monitor.engine_loop import EngineLoop
from kompass.monitor.reporting.alarms import level_of
from kompass.monitor.reporting.brief import brief
from kompass.monitor.reporting.entries import ActionOutcome, RunEntry
from kompass.rclpy_ext.topic import QoSConfig
from kompass.rulebook.schema.journal import ActionRecord, FiringRecord
from kompass.rules.engine.firing import NO_RUN
from kompass.rules.schema.table import Rule
from kompass.store.store import RuleStore
from kompass.timeline.entry import FiringLink, Level
from kompass.timeline.happening import Happened, Happening

REPEATED = 60.0  # s within which the same failure is the same
_LONGEST_KEY = 200  # characters


class Firings:
    """Publishes, logs and keeps every step of a run.

    Parameters
    ----------
    node
        Publishes, and logs.
    loop
        Says which table is in force, and what time it is.
    store
        Keeps the journal; nothing but ``once`` rules wait for that. None when nothing can be
        stored.
    stamp
        The time of now, for messages.
    kept
        Takes every entry of the journal, when it is made; None for nobody.
    happened
        Told what belongs on the timeline: firings that did something, and what went wrong.
    """

    def __init__(
        self,
        node: Node,
        loop: EngineLoop,
        store: RuleStore | None,
        stamp: Callable[[], Time],
        kept: Callable[[FiringRecord], None] | None,
        happened: Callable[[Happening], None],
    ) -> None:
        self._node, self._log, self._clock = node, node.get_logger(), node.clock
        self._loop, self._store, self._stamp, self._kept = loop, store, stamp, kept
        self._happened = happened
        self._publisher = node.create_publisher(
            RuleFiring, f"{node.get_name()}/firings", QoSConfig(queue_size=100).to_ros()
        )
        self._actions: dict[int, list[ActionRecord]] = {}
        self._failing: dict[tuple[str, str], tuple[str, float]] = {}
        self._numbers = 0

    def begins(self, rule: Rule, rule_hash: str) -> None:
        """Take note that a run is about to begin: a ``once`` rule must not begin another."""
        if rule.event.once and self._store is not None:
            self._store.use_once(rule.id, rule_hash)

    def fired(self, entry: RunEntry, message: Any) -> int:
        """Tell that a rule fired, or would have; return the entry's number in the journal."""
        if entry.kind == "firing":
            self._say(entry, "fired", True, entry.rule_id, self._details(entry))
        else:
            if entry.kind == "note":
                self._log.error(f"{entry.rule_id}: {entry.text}")
            elif entry.kind == "outranked":
                self._log.warning(f"{entry.rule_id} fired and was not carried out: {entry.text}")
            self._say(entry, "note", entry.kind == "shadow", entry.text, self._details(entry))
        return self._keep(entry, message)

    def acted(self, entry: RunEntry, number: int, outcome: ActionOutcome) -> None:
        """Tell that one action of a run has ended."""
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

    def _log_outcome(self, entry: RunEntry, outcome: ActionOutcome) -> None:
        """A line of the log; one that fails as it did a moment ago is not told of again."""
        key = (entry.rule_id, outcome.action)
        if outcome.ok:
            self._failing.pop(key, None)
            self._node.write_log("info", f"{entry.rule_id}: {outcome.action} done: {outcome.text}")
            return
        text, at = self._failing.get(key, ("", float("-inf")))
        self._failing[key] = (outcome.text, entry.at)
        if outcome.text != text or entry.at - at > REPEATED:
            failed = f"{entry.rule_id}: {outcome.action} failed: {outcome.text}"
            self._node.write_log("error", failed)

    def ended(self, entry: RunEntry, number: int, ok: bool, error: str) -> None:
        """Tell that a run has ended."""
        actions = tuple(self._actions.pop(number, ()))
        if self._store is not None:
            self._store.finish_firing(
                number, actions=actions, ended=self._clock.wall(), ok=ok, error=error
            )
        self._say(entry, "done", ok, error, {})
        if not ok:
            self._on_timeline(entry, f"{_called(entry)}: failed", error, "error", "failed rule")

    def announce(self, text: str) -> None:
        """Tell what concerns the table and no single rule, as a note."""
        self._log.warning(text)
        loop = self._loop
        entry = RunEntry(
            kind="note",
            rule_id="",
            name="",
            once=False,
            revision=loop.revision,
            run_id=NO_RUN,
            at=loop.now,
            rule_hash="",
            severity="warning",
            topic=None,
            text=text,
            leaves=(),
        )
        self._say(entry, "note", True, text, self._details(entry))
        self._keep(entry, None)

    def _keep(self, entry: RunEntry, message: Any) -> int:
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
        if self._store is not None:
            record = self._store.record_firing(record)
        if self._kept is not None:
            self._kept(record)
        level = level_of(entry.severity)
        if entry.kind == "firing":
            self._on_timeline(entry, _called(entry), entry.text, level, "rule")
        elif entry.kind == "outranked":
            title = f"{_called(entry)}: not carried out"
            self._on_timeline(entry, title, entry.text, level, "outranked rule")
        elif entry.kind == "note" and not entry.rule_id:
            self._happened(Happened(time_, "robot", entry.text, level=level))
        elif entry.kind == "note":
            self._on_timeline(entry, _called(entry), entry.text, "error", "note of rule")
        return record.number

    def _on_timeline(
        self, entry: RunEntry, title: str, text: str, level: Level, about: str
    ) -> None:
        link = FiringLink(rule=entry.rule_id, run=entry.run_id, epoch=self._loop.epoch)
        key = f"{about} {entry.rule_id}"[:_LONGEST_KEY]
        time_ = self._clock.wall()
        self._happened(
            Happened(time_, "rule", title, text, level, entry.rule_id, key=key, link=link)
        )

    def _details(self, entry: RunEntry) -> dict[str, Any]:
        return {
            "kind": entry.kind,
            "epoch": self._loop.epoch,
            "leaves": [leaf.model_dump(mode="json") for leaf in entry.leaves],
        }

    def _say(self, entry: RunEntry, phase: str, ok: bool, text: str, details: Any) -> None:
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


def _called(entry: RunEntry) -> str:
    return entry.name or entry.rule_id
