"""What is noticed of the rules while a recording is replayed: silence, extremes, near misses."""

import math

from kompass.rules.engine.compiled_table import CompiledTable, RulePlan
from kompass.rules.engine.firing import Note
from kompass.rules.engine.state import EngineState
from kompass.rules.schema.conditions import Compare

# s between two looks at which rules are unknown: their time is exact to about this.
LOOK = 0.05


class ReplayNotes:
    """Follows a replay; cheap for each message."""

    def __init__(self, compiled: CompiledTable) -> None:
        self._compiled = compiled
        self._low = [math.inf] * len(compiled.probes)
        self._high = [-math.inf] * len(compiled.probes)
        self._heard: set[int] = set()
        self._unknown = [0.0] * len(compiled.rules)
        self._enabled = [p.index for p in compiled.rules if p.rule.enabled]
        self._looked = 0.0
        self._misses: dict[str, tuple[int, str]] = {}

    def begin(self, now: float) -> None:
        """Take note that a session of the engine begins."""
        self._looked = now

    def heard(self, state: EngineState, topic: str) -> None:
        """Take note of a message that the engine has taken."""
        plan = self._compiled.by_topic.get(topic)
        if plan is None:
            return
        self._heard.add(plan.index)
        for probe in plan.probes:
            value = state.values[probe.index]
            if type(value) is float or type(value) is int:
                if value < self._low[probe.index]:
                    self._low[probe.index] = value
                if value > self._high[probe.index]:
                    self._high[probe.index] = value

    def noted(self, note: Note) -> None:
        """Take note of a near miss."""
        if note.kind == "near_miss":
            count, _ = self._misses.get(note.rule_id, (0, ""))
            self._misses[note.rule_id] = (count + 1, note.text)

    def passed(self, state: EngineState, now: float) -> None:
        """Take note that time has passed."""
        if now - self._looked >= LOOK:
            self._count(state, now)

    def end(self, state: EngineState) -> None:
        """Take note that the session of the engine ends."""
        self._count(state, state.now)

    def _count(self, state: EngineState, now: float) -> None:
        passed, self._looked = now - self._looked, now
        for index in self._enabled:
            if state.rules[index].verdict is None:
                self._unknown[index] += passed

    def unknown_time(self, rule_id: str) -> float:
        """Seconds for which a rule was unknown."""
        plan = self._compiled.by_id.get(rule_id)
        return 0.0 if plan is None else self._unknown[plan.index]

    def missing(self) -> tuple[str, ...]:
        """Topics that rules ask for and of which nothing was heard."""
        wanted = {topic for plan in self._compiled.rules for topic in plan.topics}
        return tuple(
            plan.name
            for plan in self._compiled.topics
            if plan.index in wanted and plan.index not in self._heard
        )

    def why_never(self, rule_id: str, evaluated: int, true: int) -> str:
        """Say why a rule never fired."""
        plan = self._compiled.by_id.get(rule_id)
        if plan is None:
            return "the table has no such rule"
        if not plan.rule.enabled:
            return "it is switched off"
        silent = [
            self._compiled.topics[topic].name for topic in plan.topics if topic not in self._heard
        ]
        if silent and len(silent) == len(plan.topics):
            return f"the recording has nothing on {', '.join(silent)}"
        count, miss = self._misses.get(rule_id, (0, ""))
        came_close = f"; it came close {count} times, last: {miss}" if miss else ""
        if true:
            return f"its condition was true, but never so that it fires{came_close}"
        also = f"; nothing on {', '.join(silent)}" if silent else ""
        return f"its condition was never true{self._extremes(plan)}{also}{came_close}"

    def _extremes(self, plan: RulePlan) -> str:
        """Say how near the numbers came to what the rule asks for."""
        found = []
        for _, index in plan.leaves:
            leaf = self._compiled.leaves[index]
            condition = leaf.condition
            if not isinstance(condition, Compare):
                continue
            low, high = self._low[leaf.probe], self._high[leaf.probe]
            if low > high:
                continue
            if condition.operator in ("<", "<="):
                found.append(f"{leaf.text}: the lowest was {low:.4g}")
            elif condition.operator in (">", ">="):
                found.append(f"{leaf.text}: the highest was {high:.4g}")
            elif condition.operator in ("==", "between"):
                found.append(f"{leaf.text}: it was between {low:.4g} and {high:.4g}")
        return f" ({'; '.join(found)})" if found else ""
