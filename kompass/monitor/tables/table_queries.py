"""The window through which tables are looked at; nothing is changed here."""

from __future__ import annotations

from collections.abc import Callable, Collection

from kompass.monitor.tables.active_table import ActiveTable
from kompass.monitor.tables.revision_history import RevisionHistory
from kompass.monitor.tables.table_reader import TableReader, Unreadable
from kompass.monitor.tables.table_validator import TableValidator
from kompass.rulebook.schema.diff_models import TableDiff
from kompass.rulebook.schema.report import CheckReport
from kompass.rulebook.schema.revision import History
from kompass.rulebook.schema.table_view import TableView
from kompass.rulebook.views.views import table_view
from kompass.rules.engine.compiled_table import compile_table


class TableQueries:
    """Answers from whatever thread.

    Parameters
    ----------
    running
        Ids of rules whose actions are running.
    """

    def __init__(
        self,
        standing: ActiveTable,
        shelf: RevisionHistory,
        reader: TableReader,
        examiner: TableValidator,
        running: Callable[[], Collection[str]],
        *,
        robot: str,
        safe_mode: bool,
    ) -> None:
        self._standing, self._shelf, self._reader = standing, shelf, reader
        self._examiner, self._running = examiner, running
        self._robot, self._safe_mode = robot, safe_mode

    def view(self, revision: int = 0) -> TableView:
        """A revision of the table; 0 for the one in force.

        Raises
        ------
        StoreError
            When there is no such revision.
        """
        now = self._standing.in_force
        number = revision or now.revision
        current = number == now.revision
        table = now.table if current else self._shelf.store.table(number)
        return table_view(
            table,
            revision=number,
            active=now.revision,
            confirmed=now.confirmed,
            robot=self._robot,
            probation_left=self._standing.probation_left,
            notice=now.notice,
            findings=tuple(self._examiner.foreseen(compile_table(table))) if current else (),
            merge=self._standing.merge if current else None,
            safe_mode=self._safe_mode,
        )

    def history(self, before: int, count: int) -> History:
        """The revisions, newest first."""
        return self._shelf.store.history(before, count)

    def diff(self, before: int, after: int) -> TableDiff:
        """What differs between two revisions."""
        return self._shelf.diff(before, after)

    def check(self, text: str, role: str) -> CheckReport:
        """What is wrong with a table, and what applying it would do."""
        now = self._standing.in_force
        try:
            table = self._reader.read(text)
        except Unreadable as error:
            return self._examiner.unreadable(now, error)
        table = self._examiner.named(table)
        findings = self._examiner.errors(now, table, role)
        if not findings:
            findings = self._examiner.foreseen(compile_table(table))
        return self._examiner.report(now, table, findings, self._running())
