"""The table in force, until when, and what waits for an operator beside it."""

from __future__ import annotations

import time
from collections.abc import Callable

from kompass.monitor.tables.types import InForce
from kompass.rulebook.schema.table_view import Merge
from kompass.rules.schema.table import Table


class ActiveTable:
    """Says which table is in force; read from any thread, changed by the table manager alone.

    Parameters
    ----------
    in_force, merge
        At first.
    changed
        Called after every change of what is in force, with the ids of the rules that are no more.
    clock
        Monotonic seconds.

    Attributes
    ----------
    in_force
        The table in force.
    merge
        Edits of an older recipe that wait to be merged; None for none.
    """

    def __init__(
        self,
        in_force: InForce,
        merge: Merge | None,
        changed: Callable[[frozenset[str]], None],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.in_force, self.merge = in_force, merge
        self._changed, self._clock = changed, clock

    @property
    def known(self) -> tuple[Table, ...]:
        """The tables that rules are taken over from; their sources are true."""
        return (self.in_force.table, *([self.merge.table] if self.merge else ()))

    @property
    def probation_left(self) -> float:
        """Seconds until the table in force is taken back; 0 when it stays."""
        ends = self.in_force.probation_ends
        return 0.0 if ends is None else max(ends - self._clock(), 0.0)

    @property
    def overdue(self) -> bool:
        """Whether the probation of the table in force has ended."""
        ends = self.in_force.probation_ends
        return ends is not None and self._clock() >= ends

    def try_out(self, table: Table, revision: int, probation: float) -> None:
        """Take note that a table is in force, for so many seconds unless it is confirmed."""
        confirmed = self.in_force.confirmed
        self._set(InForce(table, revision, confirmed, self._clock() + probation))

    def keep(self, table: Table, revision: int, notice: str = "") -> None:
        """Take note that a table is in force, and stays."""
        self._set(InForce(table, revision, revision, notice=notice))

    def cannot_take_back(self, notice: str) -> None:
        """Take note that the table in force stays though nobody confirmed it."""
        self._set(self.in_force._replace(probation_ends=None, notice=notice))

    def _set(self, in_force: InForce) -> None:
        before = {rule.id for rule in self.in_force.table.rules}
        self.in_force = in_force
        self._changed(frozenset(before - {rule.id for rule in in_force.table.rules}))
