"""The desk at which tables are handed in: checked, stored, put in force, kept or taken back."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence

from kompass.monitor.desk_terms import Answer, Engine, InForce, Store, Who
from kompass.monitor.names import name_findings
from kompass.monitor.reading import Unreadable, read_table
from kompass.rulebook.diff import TableDiff
from kompass.rulebook.diffing import conflict, diff_tables
from kompass.rulebook.guard import gates_of, guard
from kompass.rulebook.lint import findings_of
from kompass.rulebook.report import ApplyReport, CheckReport, Conflict, Effect, Finding
from kompass.rulebook.revision import History, Origin
from kompass.rulebook.table_view import Merge, TableView
from kompass.rulebook.views import effect_of, table_view
from kompass.rules.catalog import Catalog
from kompass.rules.check import check_table
from kompass.rules.compiled import CompiledTable, compile_table
from kompass.rules.table import Table, rule_hash
from kompass.store import NoSuchRevision, StoreError

LONGEST_PROBATION = 86_400.0  # s
MAX_TEXT = 1_000  # characters of a name or a reason


class Desk:
    """Takes one request after another, from whatever thread.

    Parameters
    ----------
    store
        None when nothing can be stored: then the table stays as it is, and ``in_force.notice``
        says why.
    catalog
        What the robot knows, for checking.
    lints
        What there is to think about in a table.
    changed
        Told after every change of what is in force.
    announce
        Takes a sentence that every operator must hear.
    probation
        Default in seconds; 0 for none.
    """

    def __init__(
        self,
        store: Store | None,
        engine: Engine,
        catalog: Catalog,
        in_force: InForce,
        *,
        recipe: Table,
        robot: str,
        lints: Callable[[CompiledTable], Sequence[Finding]],
        changed: Callable[[], None],
        announce: Callable[[str], None],
        merge: Merge | None = None,
        safe_mode: bool = False,
        probation: float = 60.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._store, self._engine, self._catalog = store, engine, catalog
        self._recipe, self._robot = recipe, robot
        self._lints, self._changed, self._announce = lints, changed, announce
        self._merge, self._safe_mode, self._probation = merge, safe_mode, probation
        self._clock = clock
        self._lock = threading.RLock()
        self._in_force = in_force

    @property
    def in_force(self) -> InForce:
        """What is in force now."""
        return self._in_force

    @property
    def probation_left(self) -> float:
        """Seconds until the table in force is taken back; 0 when it stays."""
        ends = self._in_force.probation_ends
        return 0.0 if ends is None else max(ends - self._clock(), 0.0)

    # -- looking --------------------------------------------------------------------------------

    def view(self, revision: int = 0) -> TableView:
        """A revision of the table; 0 for the one in force.

        Raises
        ------
        StoreError
            When there is no such revision.
        """
        now = self._in_force
        number = revision or now.revision
        table = now.table if number == now.revision else self._stored().table(number)
        current = number == now.revision
        return table_view(
            table,
            revision=number,
            active=now.revision,
            confirmed=now.confirmed,
            robot=self._robot,
            probation_left=self.probation_left,
            notice=now.notice,
            findings=tuple(self._lints(compile_table(table))) if current else (),
            merge=self._merge if current else None,
            safe_mode=self._safe_mode,
        )

    def history(self, before: int, count: int) -> History:
        """The revisions, newest first."""
        return self._stored().history(before, count)

    def diff(self, before: int, after: int) -> TableDiff:
        """What differs between two revisions."""
        store = self._stored()
        return diff_tables(
            store.table(before), store.table(after), before_revision=before, after_revision=after
        )

    def check(self, text: str, role: str) -> CheckReport:
        """What is wrong with a table, and what applying it would do."""
        try:
            table = read_table(text)
        except Unreadable as error:
            return self._unreadable(error)
        return self._report(compile_table(table), role)

    # -- changing -------------------------------------------------------------------------------

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
    ) -> Answer:
        """Put a table in force, or change nothing.

        Parameters
        ----------
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
            table = read_table(text)
        except Unreadable as error:
            return self._refuse(str(error), self._unreadable(error))
        if not probation <= LONGEST_PROBATION:  # not a number is refused too
            return self._refuse(
                f"probation = {probation}: give seconds up to {LONGEST_PROBATION:g}, 0 for none, "
                "or a negative number for the default"
            )
        if problem := _too_long(who.author, "author") or _too_long(reason, "reason"):
            return self._refuse(problem)
        unknown = set(reset) - {rule.id for rule in table.rules}
        if unknown:
            return self._refuse(f"reset names rules that the table has not: {sorted(unknown)}")
        compiled = compile_table(table)
        wait = self._probation if probation < 0 else probation
        with self._lock:
            if expected != self._in_force.revision:
                return self._conflict(table, expected)
            return self._put(
                compiled, who, "edit", reason, wait, reset=reset, cancel=cancel_running
            )

    def rollback(
        self,
        revision: int,
        who: Who,
        *,
        expected: int = 0,
        reason: str = "",
        cancel_running: bool = False,
    ) -> Answer:
        """Put the table of an earlier revision in force again.

        Parameters
        ----------
        revision
            0 for the one before: the confirmed one while on probation, else the newest
            confirmed one with another table.
        expected
            What must be in force; 0 for whatever is.
        """
        if problem := _too_long(who.author, "author") or _too_long(reason, "reason"):
            return self._refuse(problem)
        with self._lock:
            now = self._in_force
            try:
                wanted = self._stored().revision(revision or self._before())
                table = self._stored().table(wanted.number)
            except StoreError as error:
                return self._refuse(str(error))
            if expected not in (0, now.revision):
                return self._conflict(table, expected)
            # What was kept once need not be watched again; going back must not end by itself.
            kept = wanted.outcome == "confirmed"
            return self._put(
                compile_table(table),
                who,
                "rollback",
                reason or f"back to revision {wanted.number}",
                0.0 if kept else self._probation,
                restores=wanted.number,
                cancel=cancel_running,
            )

    def confirm(self, revision: int, who: Who) -> Answer:
        """Keep the revision on probation."""
        if problem := _may_change(who) or _too_long(who.author, "author"):
            return self._refuse(problem)
        with self._lock:
            now = self._in_force
            if revision != now.revision:
                return self._refuse(
                    f"revision {revision} is not in force, {now.revision} is; look at it first"
                )
            if now.revision == now.confirmed:
                return Answer("applied", f"revision {revision} is confirmed already", revision)
            try:
                self._stored().set_confirmed(revision, author=who.author, role=who.role)
            except StoreError as error:
                return self._fail(error)
            self._merge = None
            self._set(InForce(now.table, revision, revision))
            return Answer("applied", f"revision {revision} is confirmed", revision)

    def reset(self, rule_id: str, who: Who) -> Answer:
        """Let a rule start afresh; makes no revision."""
        if problem := _may_change(who):
            return self._refuse(problem)
        with self._lock:
            now = self._in_force
            if all(rule.id != rule_id for rule in now.table.rules):
                return self._refuse(f"there is no rule {rule_id[:100]!r} in the table in force")
            if self._store is not None:
                self._store.reset_once(rule_id)
            self._engine.swap(compile_table(now.table), now.revision, [rule_id], "")
            self._announce(f"{who.author or who.role} has reset the rule '{rule_id}'")
            return Answer("applied", f"'{rule_id}' starts afresh", now.revision)

    def tick(self) -> None:
        """Take the table back if its probation has ended; to be called at its end."""
        with self._lock:
            now = self._in_force
            if now.probation_ends is None or self._clock() < now.probation_ends:
                return
            try:
                table = self._stored().table(now.confirmed)
            except StoreError as error:
                self._set(
                    now._replace(probation_ends=None, notice=f"cannot be taken back: {error}")
                )
                self._announce(self._in_force.notice)
                return
            notice = (
                f"revision {now.revision} was taken back because nobody confirmed it; "
                f"the rules of revision {now.confirmed} are in force again"
            )
            compiled = compile_table(table)
            number = now.confirmed
            try:
                number = (
                    self._stored().take_back(f"nobody confirmed revision {now.revision}").number
                )
            except StoreError as error:
                # Safety first: it is taken back all the same, and a restart comes to the same.
                notice += f" (this could not be stored: {error})"
            self._engine.prepare(compiled)
            self._engine.swap(compiled, number, (), "the table was taken back")
            self._set(InForce(table, number, number, notice=notice))
            self._announce(notice)

    # -- inside ---------------------------------------------------------------------------------

    def _put(
        self,
        compiled: CompiledTable,
        who: Who,
        origin: Origin,
        reason: str,
        probation: float,
        *,
        restores: int | None = None,
        reset: Sequence[str] = (),
        cancel: bool,
    ) -> Answer:
        """Check, store, swap, tell; in this order."""
        now, table = self._in_force, compiled.table
        report = self._report(compiled, who.role)
        if problem := _may_change(who):
            return self._forbid(who, origin, problem, report)
        if not report.ok:
            errors = [finding for finding in report.findings if finding.level == "error"]
            return self._forbid(who, origin, _first(errors), report)
        try:
            store = self._stored()
            # What can fail comes before it is stored: listening to what it needs, too.
            self._engine.prepare(compiled)
            # Durable before it is in force: what was acknowledged is never lost, and what is in
            # force is never unknown.
            made = store.append(
                table,
                author=who.author,
                role=who.role,
                reason=reason,
                origin=origin,
                restores=restores,
                confirmed=probation == 0.0,
            )
        except StoreError as error:
            return self._fail(error)
        by = f"{who.author or who.role} put revision {made.number} in force"
        swap = self._engine.swap(compiled, made.number, tuple(reset), by if cancel else "")
        ends = self._clock() + probation if probation else None
        confirmed = now.confirmed if probation else made.number
        if not probation and origin == "edit":
            self._merge = None  # taken, or decided against; until then the offer stands
        self._set(InForce(table, made.number, confirmed, ends))
        body = ApplyReport(
            revision=made.number,
            previous=now.revision,
            probation=probation,
            pause=swap.pause,
            effect=effect_of(swap.carried),
            diff=report.diff.model_copy(update={"after": made.number}),
            findings=report.findings,
        )
        wait = f"; confirm it within {probation:g} s, or it is taken back" if probation else ""
        return Answer("applied", f"revision {made.number} is in force{wait}", made.number, body)

    def _report(self, compiled: CompiledTable, role: str) -> CheckReport:
        now, table = self._in_force, compiled.table
        findings = [
            *guard(
                now.table,
                table,
                role=role,
                recipe_table=self._recipe,
                drive_managers=gates_of(self._catalog),
            ),
            *name_findings(table),
            *findings_of(check_table(table, self._catalog)),
        ]
        ok = not findings
        if ok:
            findings += self._lints(compiled)
        return CheckReport(
            ok=ok,
            revision=now.revision,
            findings=tuple(findings),
            diff=diff_tables(now.table, table, before_revision=now.revision),
            effect=self._effect(now.table, table),
        )

    def _effect(self, before: Table, after: Table) -> Effect:
        old = {rule.id: rule_hash(rule) for rule in before.rules}
        new = {rule.id: rule_hash(rule) for rule in after.rules}
        running = self._engine.running()
        return Effect(
            carried=tuple(key for key in new if old.get(key) == new[key]),
            reset=tuple(key for key in new if key in old and old[key] != new[key]),
            removed=tuple(key for key in old if key not in new),
            added=tuple(key for key in new if key not in old),
            running=tuple(key for key in old if key in running and new.get(key) != old[key]),
        )

    def _conflict(self, table: Table, expected: int) -> Answer:
        now = self._in_force
        try:
            store = self._stored()
            base, newest = store.table(expected), store.revision(now.revision)
        except NoSuchRevision:
            return self._refuse(
                f"expected_revision = {expected}: there is no such revision, {now.revision} is in "
                "force; read the table again"
            )
        except StoreError as error:
            return self._fail(error)
        body: Conflict = conflict(
            base,
            now.table,
            table,
            expected=expected,
            revision=now.revision,
            author=newest.author,
            time=newest.time,
            reason=newest.reason,
        )
        text = (
            f"{newest.author or newest.role} was faster: revision {now.revision} is in "
            f"force, your edit began from {expected}; nothing was changed"
        )
        return Answer("conflict", text, now.revision, body)

    def _before(self) -> int:
        now, store = self._in_force, self._stored()
        if now.revision != now.confirmed:
            return now.confirmed
        here = store.revision(now.revision)
        at = here
        while at.parent is not None:
            at = store.revision(at.parent)
            if at.table_hash != here.table_hash and at.outcome == "confirmed":
                return at.number
        raise NoSuchRevision(f"there is no table before revision {now.revision}")

    def _stored(self) -> Store:
        if self._store is None:
            raise StoreError(self._in_force.notice or "rules cannot be stored on this robot")
        return self._store

    def _set(self, in_force: InForce) -> None:
        self._in_force = in_force
        self._changed()

    def _refuse(self, message: str, body: CheckReport | None = None) -> Answer:
        return Answer("refused", message, self._in_force.revision, body)

    def _forbid(self, who: Who, what: str, problem: str, report: CheckReport) -> Answer:
        if self._store is not None:
            self._store.refuse(author=who.author, role=who.role, what=what, text=problem)
        return self._refuse(problem, report)

    def _fail(self, error: StoreError) -> Answer:
        text = f"{error}; the rules of revision {self._in_force.revision} stay in force"
        return Answer("failed", text, self._in_force.revision)

    def _unreadable(self, error: Unreadable) -> CheckReport:
        return CheckReport(
            ok=False, revision=self._in_force.revision, findings=tuple(error.findings)
        )


def _may_change(who: Who) -> str:
    if who.role in ("operator", "engineer"):
        return ""
    return f"role {who.role[:50]!r} may look at rules and change nothing; ask an operator"


def _too_long(text: str, name: str) -> str:
    return f"{name} has {len(text)} characters, at most {MAX_TEXT}" * (len(text) > MAX_TEXT)


def _first(errors: Sequence[Finding]) -> str:
    first = errors[0]
    where = f"rule '{first.rule_id}': " if first.rule_id else ""
    more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
    return f"{where}{first.field}: {first.text}; {first.remedy}{more}"
