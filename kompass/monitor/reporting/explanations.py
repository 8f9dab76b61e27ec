"""Why a rule fires, or does not: now, or at a firing of the past."""

from __future__ import annotations

from collections.abc import Callable

from kompass.monitor.engine_loop import EngineLoop
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rulebook.schema.explanation import ExplanationView
from kompass.rulebook.schema.journal import FiringRecord, Journal
from kompass.rulebook.views.views import Extras, explanation_view, firing_view
from kompass.rules.schema.table import Rule, Table
from kompass.store.errors import StoreError
from kompass.store.store import RuleStore

NEAR_MISSES = 10


class Explanations:
    """Explains rules; to be called on a worker, which may wait for the disk.

    Parameters
    ----------
    main
        The executor's thread.
    loop
        The engine.
    extras
        Returns what is known of a rule outside the engine.
    store
        None when nothing is stored: then only the present can be explained.
    """

    def __init__(
        self,
        main: MainThread,
        loop: EngineLoop,
        extras: Callable[[str], Extras],
        store: RuleStore | None,
    ) -> None:
        self._main, self._loop, self._extras, self._store = main, loop, extras, store

    def explain(self, rule_id: str, run_id: int, epoch: str) -> ExplanationView:
        """Explain a rule now, or one of its runs.

        Parameters
        ----------
        run_id
            0 for now.
        epoch
            Session of the monitor in which the run was; empty for this one.

        Raises
        ------
        KeyError
            When there is no such rule.
        StoreError
            When the journal does not hold the run.
        """
        return self._then(rule_id, run_id, epoch) if run_id else self._now(rule_id)

    def firings(self, before: int, count: int, rule_id: str) -> Journal:
        """A stretch of the journal, newest first.

        Parameters
        ----------
        before
            Number of the entry that follows; 0 for the newest.
        count
            How many, at most.
        rule_id
            Of this rule only; empty for all.

        Raises
        ------
        StoreError
            When nothing is stored on this robot.
        """
        return self._stored().journal(before, count, rule_id)

    def _now(self, rule_id: str) -> ExplanationView:
        near = self._near_misses(rule_id)

        def look() -> ExplanationView:
            loop = self._loop
            if rule_id not in loop.table.by_id:
                raise KeyError(f"there is no rule {rule_id[:100]!r} in the table in force")
            return explanation_view(
                loop.table,
                loop.state,
                rule_id,
                loop.now,
                loop.wall_offset,
                revision=loop.revision,
                extras=self._extras(rule_id),
                near_misses=near,
            )

        return self._main.call(look)

    def _then(self, rule_id: str, run_id: int, epoch: str) -> ExplanationView:
        store = self._stored()
        entry = store.firing(epoch or self._loop.epoch, run_id, rule_id)
        if entry is None:
            raise StoreError(
                f"the journal holds no run {run_id} of the rule {rule_id[:100]!r}; "
                "it may be too old to be kept"
            )
        current = self._main.call(lambda: _rule(self._loop.table.table, entry.rule_id))
        rule = _rule(store.table(entry.revision), entry.rule_id) or current
        if rule is None:
            raise StoreError(f"the rule {entry.rule_id!r} of revision {entry.revision} is not kept")
        return firing_view(
            entry, rule, current=current, near_misses=self._near_misses(entry.rule_id)
        )

    def _near_misses(self, rule_id: str) -> tuple[FiringRecord, ...]:
        return () if self._store is None else self._store.near_misses(rule_id, NEAR_MISSES)

    def _stored(self) -> RuleStore:
        if self._store is None:
            raise StoreError("nothing is stored on this robot; its log says why")
        return self._store


def _rule(table: Table, rule_id: str) -> Rule | None:
    return next((rule for rule in table.rules if rule.id == rule_id), None)
