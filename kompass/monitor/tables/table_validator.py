"""What is wrong with a table, what there is to think about in it, and what applying it would do."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import partial

from kompass.monitor.tables.live_lints import Foreseen, LiveLints
from kompass.monitor.tables.recipe_check import faults_of
from kompass.monitor.tables.table_reader import Unreadable
from kompass.monitor.tables.types import InForce
from kompass.rulebook.diff import diff_tables
from kompass.rulebook.guard import guard
from kompass.rulebook.outlook import Outlook
from kompass.rulebook.permissions import Permissions
from kompass.rulebook.schema.report import CheckReport, Effect, Finding
from kompass.rulebook.sources import with_sources
from kompass.rules.checks.catalog import Catalog
from kompass.rules.engine.compiled_table import CompiledTable
from kompass.rules.schema.actions import topics_in
from kompass.rules.schema.conditions import CallableCondition, leaves, topic_of
from kompass.rules.schema.identity_cache import IdentityCache
from kompass.rules.schema.table import Rule, Table, rule_hash
from kompass.rules.schema.values import Verdict

MOST_TOPICS = 500  # of a table; each is a subscription


class TableValidator:
    """Checks tables; a rule that was checked before is not checked again.

    Parameters
    ----------
    catalog
        What the robot knows; must not change.
    recipe
        The table that the recipe declares.
    permissions
        What rules may touch.
    lints
        Finds what there is to think about in a table.
    """

    def __init__(
        self, catalog: Catalog, recipe: Table, permissions: Permissions, lints: LiveLints
    ) -> None:
        self._recipe, self._permissions, self._lints = recipe, permissions, lints
        self._faults = IdentityCache[Rule, tuple[Finding, ...]](partial(faults_of, catalog=catalog))

    def learn(self, table: Table) -> None:
        """Check the rules of a table already, before somebody waits for it."""
        for rule in table.rules:
            self._faults(rule)

    def with_true_sources(self, table: Table, role: str, known: Sequence[Table]) -> Table:
        """A table whose rules name their true source, whatever it says itself.

        Parameters
        ----------
        role
            Of who hands it in.
        known
            Tables whose sources are true.
        """
        return with_sources(table, self._recipe, role, known)

    def errors(self, now: InForce, table: Table, role: str) -> list[Finding]:
        """What forbids a table to follow on the one in force; empty if nothing does."""
        if crowd := _too_many_topics(table):
            return [crowd]  # looking at each would take minutes
        found = guard(
            now.table, table, role=role, recipe_table=self._recipe, permissions=self._permissions
        )
        for rule in table.rules:
            found += self._faults(rule)
        return found

    def unheard(self, table: CompiledTable) -> dict[str, str]:
        """The topics with their types that only a coming table looks at."""
        return self._lints.unheard(table)

    def foreseen(self, table: CompiledTable) -> Foreseen:
        """What there would be to think about, were a table applied now, and what it would do."""
        return self._lints.foreseen(table)

    def found(self, table: Table, verdicts: Mapping[str, Verdict]) -> tuple[Finding, ...]:
        """What there is to think about in a table that is in force; never raises.

        Parameters
        ----------
        verdicts
            What the conditions that were new to it said then, by rule id.
        """
        try:
            return tuple(self._lints.found(table, verdicts))
        except Exception as error:  # noqa: BLE001 - told in its place: it is in force all the same
            return (
                Finding(
                    level="lint",
                    code="not-looked-at",
                    rule_id="",
                    field="",
                    text=f"the table could not be looked through: {error}",
                    remedy="check it once more",
                ),
            )

    def unreadable(self, now: InForce, error: Unreadable) -> CheckReport:
        """What is answered to a text that is no table."""
        return CheckReport(ok=False, revision=now.revision, findings=tuple(error.findings))

    def report(
        self,
        now: InForce,
        table: Table,
        findings: Collection[Finding],
        running: Collection[str],
        outlook: Outlook | None = None,
    ) -> CheckReport:
        """What is answered to whoever asks about a table.

        Parameters
        ----------
        now
            What is in force.
        table
            The table that is asked about.
        findings
            Errors and lints.
        running
            Ids of rules whose actions are running.
        outlook
            What the table would do at once; None where that was not looked at.
        """
        return CheckReport(
            ok=all(finding.level != "error" for finding in findings),
            revision=now.revision,
            findings=tuple(findings),
            diff=diff_tables(now.table, table, before_revision=now.revision),
            effect=_effect(now.table, table, running),
            prospects=() if outlook is None else outlook.prospects,
            now="" if outlook is None else outlook.text,
        )


def _too_many_topics(table: Table) -> Finding | None:
    """The rule with which a table comes to listen to more topics than the monitor can."""
    topics: set[str] = set()
    for rule in table.rules:
        topics |= set(_topics_of(rule))
        if len(topics) > MOST_TOPICS:
            return Finding(
                level="error",
                code="too-many-topics",
                rule_id=rule.id,
                field="event.condition",
                value=len(topics),
                text=f"with it the rules listen to more than {MOST_TOPICS} topics",
                remedy="look at fewer topics",
            )
    return None


def _topics_of(rule: Rule) -> Iterator[str]:
    for condition in (rule.event.condition, rule.event.clear):
        for _, leaf in leaves(condition) if condition is not None else ():
            if not isinstance(leaf, CallableCondition):
                yield topic_of(leaf)
    for action in rule.actions:
        yield from topics_in(action)


def sentence(errors: Sequence[Finding]) -> str:
    """The first of some findings, and how many more there are; empty if there is none."""
    if not errors:
        return ""
    first = errors[0]
    where = f"rule '{first.rule_id}': " if first.rule_id else ""
    more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
    return f"{where}{first.field}: {first.text}; {first.remedy}{more}"


def _effect(before: Table, after: Table, running: Collection[str]) -> Effect:
    old = {rule.id: rule_hash(rule) for rule in before.rules}
    new = {rule.id: rule_hash(rule) for rule in after.rules}
    return Effect(
        carried=tuple(key for key in new if old.get(key) == new[key]),
        reset=tuple(key for key in new if key in old and old[key] != new[key]),
        removed=tuple(key for key in old if key not in new),
        added=tuple(key for key in new if key not in old),
        running=tuple(key for key in old if key in running and new.get(key) != old[key]),
    )
