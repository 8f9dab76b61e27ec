"""Conditions that are being written, judged by the rules' own engine."""

from __future__ import annotations

import threading
import time
from typing import Any

from pydantic import ValidationError

from kompass.invalid import first_invalid
from kompass.monitor.introspection.message_types import MessageTypes
from kompass.rulebook.views.views import leaf_reading
from kompass.rules.checks.check import check_rule
from kompass.rules.engine.compiled_table import CompiledTable, compile_table
from kompass.rules.engine.explain import explain
from kompass.rules.engine.firing import Sample, Tick
from kompass.rules.engine.state import EngineState
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.actions import Log
from kompass.rules.schema.conditions import Condition, leaves
from kompass.rules.schema.events import Event
from kompass.rules.schema.table import Rule, Table
from kompass_console.link.rules.topic_watch import CannotOpen, TopicWatch
from kompass_console.schema.rule_models import ProbeReading

MOST_LEAVES = 100  # of a condition and its clear condition

_RULE = "probe"


class ConditionProbe:
    """One condition, hearing its topics from its making to `close`.

    The rule that carries it is switched off: its leaves are judged, and nothing ever fires.
    """

    def __init__(
        self, probe_id: str, condition: Condition, clear: Condition | None, topics: TopicWatch
    ) -> None:
        self._id = probe_id
        self._topics = topics
        self._lock = threading.Lock()
        self._error = ""
        self._running: tuple[CompiledTable, EngineState] | None = None
        try:
            self._begin(_compiled(condition, clear))
        except (CannotOpen, ValueError) as error:
            self._error = str(error)

    def hear(self, topic: str, message: Any, at: float) -> None:
        """A message has come. On the link's thread."""
        with self._lock:
            if self._running is not None:
                step(*self._running, Sample(topic, message), at)

    def close(self) -> None:
        """Hear nothing any more."""
        self._topics.close(self)

    def reading(self) -> ProbeReading:
        """How it is judged now; any thread."""
        with self._lock:
            if self._running is None:
                return ProbeReading.failed(self._id, self._error)
            now = time.monotonic()
            table, state = self._running
            step(table, state, Tick(), now)
            found = explain(table, state, _RULE, now)
        plan = table.by_id[_RULE]
        clear = None
        if plan.clear is not None:
            indexed = zip(plan.clear_leaves, found.clear_leaves, strict=True)
            clear = plan.clear({index: leaf.verdict for (_, index), leaf in indexed})
        return ProbeReading(
            id=self._id,
            leaves=[leaf_reading(leaf) for leaf in found.leaves],
            verdict=found.verdict,
            clear_leaves=[leaf_reading(leaf) for leaf in found.clear_leaves],
            clear_verdict=clear,
            error="",
        )

    def _begin(self, table: CompiledTable) -> None:
        topics = {}
        for name, kinds in table.topic_types().items():
            if len(kinds) > 1:
                raise CannotOpen(f"/{name} is given two types: {', '.join(sorted(kinds))}.")
            topics[name] = next(iter(kinds), None)
        with self._lock:
            heard = self._topics.open(self, topics)
            state = initial_state(
                table, min((e.at for e in heard.values()), default=time.monotonic())
            )
            for name, last in sorted(heard.items(), key=lambda item: item[1].at):
                step(table, state, Sample(name, last.message), last.at)
            self._running = table, state


def _compiled(condition: Condition, clear: Condition | None) -> CompiledTable:
    count = sum(1 for part in (condition, clear) if part is not None for _ in leaves(part))
    if count > MOST_LEAVES:
        raise ValueError(
            f"The condition has {count} parts; at most {MOST_LEAVES} can be looked at."
        )
    try:
        event = Event(condition=condition, clear=clear)
    except ValidationError as error:
        text = first_invalid(error).text
        raise ValueError(f"{text[0].upper()}{text[1:]}.") from None
    rule = Rule(id=_RULE, enabled=False, event=event, actions=(Log(text=""),))
    for problem in check_rule(rule, MessageTypes()):
        field = problem.field.removeprefix("event.")
        raise ValueError(f"{field} = {problem.value!r}: {problem.text}; {problem.remedy}.")
    return compile_table(Table(rules=(rule,)))
