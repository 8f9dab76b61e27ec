"""What is asked of tables; nothing is changed here."""

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
    """Answers questions from any thread.

    Parameters
    ----------
    active
        The table in force.
    history
        The revisions of before.
    reader, validator
        Read and check what is sent.
    running
        Returns the ids of rules whose actions are running.
    robot
        Its name.
    safe_mode
        Whether the recipe's table is in force, whatever is stored.
    """

    def __init__(
        self,
        active: ActiveTable,
        history: RevisionHistory,
        reader: TableReader,
        validator: TableValidator,
        running: Callable[[], Collection[str]],
        *,
        robot: str,
        safe_mode: bool,
    ) -> None:
        self._active, self._history, self._reader = active, history, reader
        self._validator, self._running = validator, running
        self._robot, self._safe_mode = robot, safe_mode

    def view(self, revision: int = 0) -> TableView:
        """A revision of the table; 0 for the one in force.

        Raises
        ------
        StoreError
            When there is no such revision.
        """
        now = self._active.in_force
        number = revision or now.revision
        current = number == now.revision
        table = now.table if current else self._history.store.table(number)
        return table_view(
            table,
            revision=number,
            active=now.revision,
            confirmed=now.confirmed,
            robot=self._robot,
            probation_left=self._active.probation_left,
            notice=now.notice,
            # Nothing in it is new: no condition of it is asked once more.
            findings=self._validator.found(table, {}) if current else (),
            merge=self._active.merge if current else None,
            safe_mode=self._safe_mode,
        )

    def history(self, before: int, count: int, largest: int | None = None) -> History:
        """The revisions, newest first.

        Parameters
        ----------
        before
            Number of the one that follows; 0 for the newest.
        count
            How many, at most.
        largest
            Fewer where what they changed has more characters than this.

        Raises
        ------
        StoreError
            When nothing can be stored on this robot.
        """
        return self._history.store.history(before, count, largest)

    def diff(self, before: int, after: int) -> TableDiff:
        """What differs between two revisions.

        Raises
        ------
        StoreError
            When there is no such revision.
        """
        return self._history.diff(before, after)

    def unheard(self, text: str, role: str) -> dict[str, str]:
        """The topics with their types that are to be heard before a table is checked.

        None when it has faults: then there is nothing to foresee.
        """
        try:
            table = self._reader.read(text)
        except Unreadable:
            return {}
        table = self._validator.with_true_sources(table, role, self._active.known)
        if self._validator.errors(self._active.in_force, table, role):
            return {}
        return self._validator.unheard(compile_table(table))

    def check(self, text: str, role: str) -> CheckReport:
        """What is wrong with a table, and what applying it would do."""
        now = self._active.in_force
        try:
            table = self._reader.read(text)
        except Unreadable as error:
            return self._validator.unreadable(now, error)
        table = self._validator.with_true_sources(table, role, self._active.known)
        findings = self._validator.errors(now, table, role)
        if findings:
            return self._validator.report(now, table, findings, self._running())
        lints, outlook = self._validator.foreseen(compile_table(table))
        return self._validator.report(now, table, lints, self._running(), outlook)
