"""What a replay must know that begins in the middle: the table in force, and what was used up."""

from __future__ import annotations

from kompass.backtest.event_log import Began, Ended, Fired, LoggedEvent, Resumed, Swapped
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.schema.table import rule_hash


class EngineMemory:
    """Follows the events of the engine; tells at any time how a file may begin."""

    def __init__(self) -> None:
        self._last: Resumed | None = None
        self._once: frozenset[str] = frozenset()
        self._topics: frozenset[str] = frozenset()
        self._ended: dict[str, float] = {}
        self._running: dict[str, dict[str, float]] = {}

    @property
    def topics(self) -> frozenset[str]:
        """Topics that the table in force listens to, without leading slash."""
        return self._topics

    def take(self, event: LoggedEvent) -> None:
        """Take note of an event."""
        if isinstance(event, Began | Resumed):
            self._last = Resumed(*event)
            self._ended = dict(self._last.ended)
            self._running = {rule: dict(runs) for rule, runs in self._last.running.items()}
            self._follow()
        elif self._last is None:
            return
        elif isinstance(event, Swapped):
            same = self._unchanged(event)
            self._ended = {rule_id: at for rule_id, at in self._ended.items() if rule_id in same}
            self._last = self._last._replace(
                table=event.table,
                revision=event.revision,
                used=tuple(rule_id for rule_id in self._last.used if rule_id in same),
            )
            self._follow()
        elif isinstance(event, Fired) and not event.shadow:
            self._running.setdefault(event.rule_id, {})[str(event.run_id)] = event.now
            if event.rule_id in self._once:
                used = tuple(sorted({*self._last.used, event.rule_id}))
                self._last = self._last._replace(used=used)
        elif isinstance(event, Ended):
            self._ended[event.rule_id] = event.now
            self._running.get(event.rule_id, {}).pop(str(event.run_id), None)

    def _unchanged(self, event: Swapped) -> set[str]:
        """Rules that go on: all others start afresh, neither cooling down nor used up."""
        assert self._last is not None
        before = {rule.id: rule_hash(rule) for rule in self._last.table.rules}
        same = {rule.id for rule in event.table.rules if before.get(rule.id) == rule_hash(rule)}
        return same - set(event.reset)

    def _follow(self) -> None:
        assert self._last is not None
        table = self._last.table
        self._once = frozenset(rule.id for rule in table.rules if rule.event.once)
        types = compile_table(table).topic_types()
        self._topics = frozenset(name for name, kinds in types.items() if kinds)

    def resumed(self, now: float) -> Resumed | None:
        """How a file that begins now is to begin; None if nothing is known.

        Parameters
        ----------
        now
            Monotonic seconds.
        """
        last = self._last
        return last and last._replace(
            now=now,
            wall=last.wall + now - last.now,
            ended=dict(self._ended),
            running={rule: dict(runs) for rule, runs in self._running.items() if runs},
        )
