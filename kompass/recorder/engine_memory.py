"""What a replay must know that begins in the middle: the table in force, and what was used up."""

from __future__ import annotations

from kompass.rulebook.tape import Began, Fired, Resumed, Swapped, TapeEvent
from kompass.rules.compiled import compile_table


class EngineMemory:
    """Follows the events of the engine; tells at any time how a file may begin."""

    def __init__(self) -> None:
        self._last: Resumed | None = None
        self._once: frozenset[str] = frozenset()
        self._topics: frozenset[str] = frozenset()

    @property
    def topics(self) -> frozenset[str]:
        """Topics that the table in force listens to, without leading slash."""
        return self._topics

    def take(self, event: TapeEvent) -> None:
        """Take note of an event."""
        if isinstance(event, Began | Resumed):
            self._last = Resumed(*event)
            self._follow()
        elif self._last is None:
            return
        elif isinstance(event, Swapped):
            self._last = self._last._replace(
                table=event.table,
                revision=event.revision,
                used=tuple(sorted(set(self._last.used) - set(event.reset))),
            )
            self._follow()
        elif isinstance(event, Fired) and event.rule_id in self._once and not event.shadow:
            self._last = self._last._replace(used=tuple(sorted({*self._last.used, event.rule_id})))

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
        return last and last._replace(now=now, wall=last.wall + now - last.now)
