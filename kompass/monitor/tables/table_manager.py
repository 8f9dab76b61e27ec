"""What changes the table in force: it is checked, stored, put in force, kept or taken back."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from contextlib import suppress

from kompass.monitor.live_engine import LiveEngine
from kompass.monitor.tables.active_table import ActiveTable
from kompass.monitor.tables.live_lints import LiveLints
from kompass.monitor.tables.revision_history import RevisionHistory
from kompass.monitor.tables.table_queries import TableQueries
from kompass.monitor.tables.table_reader import TableReader, Unreadable
from kompass.monitor.tables.table_validator import TableValidator, sentence
from kompass.monitor.tables.types import ChangeAnswer, InForce, Who
from kompass.rulebook.diff import diff_tables
from kompass.rulebook.permissions import Permissions
from kompass.rulebook.schema.report import ApplyReport, CheckReport
from kompass.rulebook.schema.revision import Origin
from kompass.rulebook.views.views import effect_of
from kompass.rules.checks.catalog import Catalog
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.schema.table import Table
from kompass.store.errors import NoSuchRevision, StoreError
from kompass.store.store import RuleStore

LONGEST_PROBATION = 86_400.0  # s


class TableManager:
    """Takes one request for a change after another, from any thread.

    Parameters
    ----------
    store
        None when nothing can be stored: then the table stays as it is, and the notice of what is
        in force says why.
    engine
        Runs the table.
    catalog
        What the robot knows, for checking.
    active
        The table in force.
    recipe
        The table that the recipe declares.
    permissions
        What rules may touch.
    robot
        Its name.
    lints
        Finds what there is to think about in a table.
    announce
        Takes a sentence that every operator must hear.
    later
        Takes what is to be done once the request under way is answered.
    edited
        Told of a change that somebody made: what it is, the revision in force, who, and why.
    safe_mode
        Whether the recipe's table is in force, whatever is stored.
    probation
        Default in seconds; 0 for none.

    Attributes
    ----------
    queries
        Answers questions, and changes nothing.
    """

    def __init__(
        self,
        store: RuleStore | None,
        engine: LiveEngine,
        catalog: Catalog,
        active: ActiveTable,
        *,
        recipe: Table,
        permissions: Permissions,
        robot: str,
        lints: LiveLints,
        announce: Callable[[str], None],
        later: Callable[[Callable[[], None]], None],
        edited: Callable[[str, int, str, str], None],
        safe_mode: bool = False,
        probation: float = 60.0,
    ) -> None:
        self._engine, self._active, self._announce = engine, active, announce
        self._later, self._probation, self._edited = later, probation, edited
        self._lock = threading.RLock()
        self._history = RevisionHistory(store, lambda: active.in_force.notice)
        self._reader, self._validator = (
            TableReader(),
            TableValidator(catalog, recipe, permissions, lints),
        )
        # The first change is to cost no more than those that follow.
        self._reader.learn(active.in_force.table)
        self._validator.learn(active.in_force.table)
        self.queries = TableQueries(
            *(active, self._history, self._reader, self._validator, engine.running),
            robot=robot,
            safe_mode=safe_mode,
        )

    @property
    def in_force(self) -> InForce:
        """What is in force now."""
        return self._active.in_force

    def apply(
        self,
        text: str,
        who: Who,
        *,
        expected: int,
        reason: str = "",
        probation: float = -1.0,
        cancel_running: bool = False,
        reset: Sequence[str] = (),
    ) -> ChangeAnswer:
        """Put a table in force, or change nothing.

        Parameters
        ----------
        text
            The table as JSON.
        who
            Who asks.
        expected
            The revision that the edit began from.
        probation
            Seconds after which it is taken back unless confirmed; 0 for never, negative for the
            default.
        cancel_running
            Cancel running actions of rules that change, instead of letting them finish.
        reset
            Ids of rules that start afresh though they are unchanged.
        """
        try:
            table = self._reader.read(text)
        except Unreadable as error:
            return self._refuse(str(error), self._validator.unreadable(self.in_force, error))
        if not probation <= LONGEST_PROBATION:  # not a number is refused too
            return self._refuse(
                f"probation = {probation}: give seconds up to {LONGEST_PROBATION:g}, 0 for none, "
                "or a negative number for the default"
            )
        if problem := who.too_long(reason):
            return self._refuse(problem)
        unknown = set(reset) - {rule.id for rule in table.rules}
        if unknown:
            return self._refuse(f"reset names rules that the table has not: {sorted(unknown)}")
        if problem := self._barred_from_resetting(who, reset):
            return self._refuse(problem)
        wait = self._probation if probation < 0 else probation
        with self._lock:
            if expected != self.in_force.revision:
                return self._conflict(table, expected)
            return self._put(table, who, "edit", reason, wait, reset=reset, cancel=cancel_running)

    def rollback(
        self,
        revision: int,
        who: Who,
        *,
        expected: int = 0,
        reason: str = "",
        cancel_running: bool = False,
    ) -> ChangeAnswer:
        """Put the table of an earlier revision in force again.

        Parameters
        ----------
        revision
            0 for the one before: the confirmed one while on probation, else the newest
            confirmed one with another table.
        expected
            What must be in force; 0 for whatever is.
        """
        if problem := who.too_long(reason):
            return self._refuse(problem)
        with self._lock:
            now = self.in_force
            try:
                store = self._history.store
                wanted = store.revision(revision) if revision else self._history.before(now)
                table = store.table(wanted.number)
            except StoreError as error:
                return self._refuse(str(error))
            if expected not in (0, now.revision):
                return self._conflict(table, expected)
            # What was kept once need not be watched again; going back must not end by itself.
            kept = wanted.outcome == "confirmed"
            return self._put(
                table,
                who,
                "rollback",
                reason or f"back to revision {wanted.number}",
                0.0 if kept else self._probation,
                restores=wanted.number,
                cancel=cancel_running,
            )

    def confirm(self, revision: int, who: Who) -> ChangeAnswer:
        """Keep the revision on probation."""
        if problem := who.barred or who.too_long():
            return self._refuse(problem)
        with self._lock:
            now = self.in_force
            if revision != now.revision:
                return self._refuse(
                    f"revision {revision} is not in force, {now.revision} is; look at it first"
                )
            if now.revision == now.confirmed:
                return ChangeAnswer(
                    "applied", f"revision {revision} is confirmed already", revision
                )
            try:
                self._history.store.set_confirmed(revision, author=who.name, role=who.role)
            except StoreError as error:
                return self._fail(error)
            self._active.merge = None
            self._active.keep(now.table, revision)
            self._edited(f"Revision {revision} confirmed", revision, who.name, "")
            return ChangeAnswer("applied", f"revision {revision} is confirmed", revision)

    def reset(self, rule_id: str, who: Who) -> ChangeAnswer:
        """Let a rule start afresh; makes no revision."""
        if problem := who.barred:
            return self._refuse(problem)
        with self._lock:
            now = self.in_force
            if all(rule.id != rule_id for rule in now.table.rules):
                return self._refuse(f"there is no rule {rule_id[:100]!r} in the table in force")
            if problem := self._barred_from_resetting(who, [rule_id]):
                return self._refuse(problem)
            self._history.forget_use(rule_id)
            self._engine.swap(compile_table(now.table), now.revision, [rule_id], "")
            self._announce(f"{who.name or who.role} has reset the rule '{rule_id}'")
            return ChangeAnswer("applied", f"'{rule_id}' starts afresh", now.revision)

    def has_recovered(self) -> bool:
        """Whether changes can be stored, or never could be."""
        return self._history.has_recovered()

    def recover(self) -> None:
        """Go back to work once a disk that took nothing at the start takes something again."""
        with self._lock, suppress(StoreError):
            if self.has_recovered():
                return
            self._history.store.recover()
            now = self.in_force
            self._active.keep(now.table, self._history.store.active)
            self._announce("the disk takes changes of the rules again")

    def end_probation(self) -> None:
        """Take the table back if its probation has ended; to be called at its end."""
        with self._lock:
            now = self.in_force
            if not self._active.overdue:
                return
            try:
                table = self._history.store.table(now.confirmed)
            except StoreError as error:
                notice = f"revision {now.revision} cannot be taken back: {error}"
                self._active.cannot_take_back(notice)
                self._announce(notice)
                return
            notice = (
                f"revision {now.revision} was taken back because nobody confirmed it; "
                f"the rules of revision {now.confirmed} are in force again"
            )
            number, reason = now.confirmed, f"nobody confirmed revision {now.revision}"
            try:
                number = self._history.store.take_back(reason).number
            except StoreError as error:
                # Safety first: it is taken back all the same, and a restart comes to the same.
                notice += f" (this could not be stored: {error})"
            compiled = compile_table(table)
            self._engine.prepare(compiled)
            self._engine.swap(compiled, number, (), "the table was taken back")
            self._active.keep(table, number, notice)
            self._announce(notice)

    # -- inside ---------------------------------------------------------------------------------

    def _put(
        self,
        table: Table,
        who: Who,
        origin: Origin,
        reason: str,
        probation: float,
        *,
        restores: int | None = None,
        reset: Sequence[str] = (),
        cancel: bool,
    ) -> ChangeAnswer:
        """Check, store, swap and tell, in this order; what can fail comes before it is stored."""
        # A revision of the past says itself, and truly, who had a hand in its rules.
        known = self._active.known if restores is None else (table, *self._active.known)
        now, table = self.in_force, self._validator.with_true_sources(table, who.role, known)
        errors = self._validator.errors(now, table, who.role)
        if problem := who.barred or sentence(errors):
            self._history.note_refusal(who.name, who.role, origin, problem)
            report = self._validator.report(now, table, errors, self._engine.running())
            return self._refuse(problem, report)
        compiled = compile_table(table)
        diff = diff_tables(now.table, table, before_revision=now.revision)
        try:
            store = self._history.store
            self._engine.prepare(compiled)
            # Durable before it is in force: what was acknowledged is never lost, and what is in
            # force is never unknown. The copy beside it is for a damaged disk, and can wait.
            made = store.append(
                table,
                author=who.name,
                role=who.role,
                reason=reason,
                origin=origin,
                restores=restores,
                confirmed=probation == 0.0,
                copied=False,
            )
        except StoreError as error:
            return self._fail(error)
        by = f"{who.name or who.role} put revision {made.number} in force"
        swap = self._engine.swap(compiled, made.number, tuple(reset), by if cancel else "")
        if probation:
            self._active.try_out(table, made.number, probation)
        else:
            if origin == "edit":
                self._active.merge = None  # taken, or decided against
            self._active.keep(table, made.number)
            self._later(store.keep_copy)
        body = ApplyReport(
            revision=made.number,
            previous=now.revision,
            probation=probation,
            pause=swap.pause,
            effect=effect_of(swap.carried),
            diff=diff.model_copy(update={"after": made.number}),
            findings=self._validator.found(table, swap.verdicts),
        )
        title = f"Revision {made.number} in force"
        if restores is not None:
            title = f"Revision {made.number} in force, the rules of revision {restores}"
        self._edited(title, made.number, who.name, reason)
        wait = f"; confirm it within {probation:g} s, or it is taken back" if probation else ""
        return ChangeAnswer(
            "applied", f"revision {made.number} is in force{wait}", made.number, body
        )

    def _barred_from_resetting(self, who: Who, ids: Sequence[str]) -> str:
        """Why somebody may not let these rules start afresh; empty if they may."""
        protected = {rule.id for rule in self.in_force.table.rules if rule.protected}
        if who.role == "engineer" or not (kept := protected & set(ids)):
            return ""
        # A rule that begins its hold anew again and again never fires.
        return f"'{min(kept)}' is protected, and starts afresh for an engineer only; ask one"

    def _conflict(self, table: Table, expected: int) -> ChangeAnswer:
        now = self.in_force
        try:
            body = self._history.conflict(now, table, expected)
        except NoSuchRevision:
            return self._refuse(
                f"expected_revision = {expected}: there is no such revision, {now.revision} is in "
                "force; read the table again"
            )
        except StoreError as error:
            return self._fail(error)
        newest = self._history.store.revision(now.revision)
        text = (
            f"{newest.author or newest.role} was faster: revision {now.revision} is in "
            f"force, your edit began from {expected}; nothing was changed"
        )
        return ChangeAnswer("conflict", text, now.revision, body)

    def _refuse(self, message: str, body: CheckReport | None = None) -> ChangeAnswer:
        return ChangeAnswer("refused", message, self.in_force.revision, body)

    def _fail(self, error: StoreError) -> ChangeAnswer:
        text = f"{error}; the rules of revision {self.in_force.revision} stay in force"
        return ChangeAnswer("failed", text, self.in_force.revision)
