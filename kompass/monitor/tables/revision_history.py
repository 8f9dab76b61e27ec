"""The revisions of before: where they are kept, compared and found."""

from __future__ import annotations

from collections.abc import Callable

from kompass.monitor.tables.types import InForce
from kompass.rulebook.diff import conflict, diff_tables
from kompass.rulebook.schema.diff_models import TableDiff
from kompass.rulebook.schema.report import Conflict
from kompass.rulebook.schema.revision import Revision
from kompass.rules.schema.table import Table
from kompass.store.errors import NoSuchRevision, StoreError
from kompass.store.store import RuleStore


class RevisionHistory:
    """The stored revisions; without a store, all that needs one raises :class:`StoreError`.

    Parameters
    ----------
    store
        None when nothing can be stored on this robot.
    reason
        Why not, in words for an operator.
    """

    def __init__(self, store: RuleStore | None, reason: Callable[[], str]) -> None:
        self._store, self._reason = store, reason

    @property
    def store(self) -> RuleStore:
        """Where revisions are kept.

        Raises
        ------
        StoreError
            When nothing can be stored.
        """
        if self._store is None:
            raise StoreError(self._reason() or "rules cannot be stored on this robot")
        return self._store

    def has_recovered(self) -> bool:
        """Whether the store takes changes; True, too, where there is none to wait for."""
        return self._store is None or self._store.has_recovered()

    def forget_use(self, rule_id: str) -> None:
        """Let a rule that fires once only fire again; without a store nothing was kept."""
        if self._store is not None:
            self._store.reset_once(rule_id)

    def note_refusal(self, author: str, role: str, what: str, text: str) -> None:
        """Keep that somebody was refused something; without a store it is only said."""
        if self._store is not None:
            self._store.refuse(author=author, role=role, what=what, text=text)

    def diff(self, before: int, after: int) -> TableDiff:
        """What differs between two revisions.

        Raises
        ------
        StoreError
            When there is no such revision.
        """
        store = self.store
        return diff_tables(
            store.table(before), store.table(after), before_revision=before, after_revision=after
        )

    def conflict(self, now: InForce, table: Table, expected: int) -> Conflict:
        """What is told to who began from a revision that is no longer in force.

        Parameters
        ----------
        now
            What is in force.
        table
            What was to be.
        expected
            The revision that it began from.

        Raises
        ------
        NoSuchRevision
            When there never was such a revision.
        """
        base, newest = self.store.table(expected), self.store.revision(now.revision)
        return conflict(
            base,
            now.table,
            table,
            expected=expected,
            revision=now.revision,
            author=newest.author,
            time=newest.time,
            reason=newest.reason,
        )

    def before(self, now: InForce) -> Revision:
        """The revision to go back to when none is named.

        The confirmed one while on probation, else the newest confirmed one with another table.

        Raises
        ------
        NoSuchRevision
            When there is none.
        """
        store = self.store
        if now.revision != now.confirmed:
            return store.revision(now.confirmed)
        at = here = store.revision(now.revision)
        while at.parent is not None:
            at = store.revision(at.parent)
            if at.table_hash != here.table_hash and at.outcome == "confirmed":
                return at
        raise NoSuchRevision(f"there is no table before revision {now.revision}")
