"""What a replay must know that begins in the middle: the table in force, and what was used up."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import JsonValue

from kompass.rulebook.tape import Began, Fired, Swapped, TapeEvent, from_data, to_data
from kompass.rules.compiled import compile_table

RESUMED = "resumed"


class EngineMemory:
    """Follows the events of the engine; tells at any time how a file may begin."""

    def __init__(self) -> None:
        self._began: Began | None = None
        self._once: frozenset[str] = frozenset()
        self._topics: frozenset[str] = frozenset()

    @property
    def topics(self) -> frozenset[str]:
        """Topics that the table in force listens to, without leading slash."""
        return self._topics

    def take(self, kind: str, data: Mapping[str, Any]) -> None:
        """Take note of an event, as :func:`kompass.rulebook.tape.to_data` gives it.

        Raises
        ------
        ValueError
            When it is malformed.
        """
        if kind in ("began", RESUMED):
            self._go_on(from_data("began", data))
        elif kind in ("swapped", "fired") and self._began is not None:
            self._go_on(from_data(kind, data))

    def _go_on(self, event: TapeEvent) -> None:
        if isinstance(event, Began):
            self._began = event
        assert self._began is not None
        used = set(self._began.used)
        if isinstance(event, Fired):
            if event.rule_id in self._once:
                self._began = self._began._replace(used=tuple(sorted(used | {event.rule_id})))
            return
        if isinstance(event, Swapped):
            self._began = self._began._replace(
                table=event.table,
                revision=event.revision,
                used=tuple(sorted(used - set(event.reset))),
            )
        table = self._began.table
        self._once = frozenset(rule.id for rule in table.rules if rule.event.once)
        types = compile_table(table).topic_types()
        self._topics = frozenset(name for name, kinds in types.items() if kinds)

    def resumed(self, now: float) -> dict[str, JsonValue] | None:
        """Data of an event ``resumed``: as ``began``, but in the middle; None if nothing is known.

        Parameters
        ----------
        now
            Monotonic seconds.
        """
        began = self._began
        if began is None:
            return None
        _, data = to_data(began._replace(now=now, wall=began.wall + now - began.now))
        return data
