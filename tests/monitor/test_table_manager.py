"""A change of the table is whole or none, on a virtual clock: nothing half applied or lost."""

import json
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kompass.monitor.engine_loop import Swap
from kompass.monitor.introspection.message_types import MessageTypes
from kompass.monitor.live_engine import LiveEngine
from kompass.monitor.tables.active_table import ActiveTable
from kompass.monitor.tables.live_lints import Foreseen, LiveLints
from kompass.monitor.tables.table_manager import TableManager
from kompass.monitor.tables.types import ChangeAnswer, InForce, Who
from kompass.rulebook.outlook import Outlook
from kompass.rulebook.permissions import Permissions
from kompass.rulebook.schema.report import ApplyReport, CheckReport, Conflict, Finding
from kompass.rules.checks.catalog import Catalog, FieldType
from kompass.rules.engine.compiled_table import CompiledTable, compile_table
from kompass.rules.engine.migration import plan_migration, swap
from kompass.rules.engine.step import initial_state
from kompass.rules.schema.table import Table, table_hash
from kompass.rules.schema.values import Verdict
from kompass.store.errors import StoreUnwritable
from kompass.store.store import RuleStore
from tests.support.disk import Databases
from tests.support.rules import compare, rule

BASE = [
    rule("first", compare("a", ">", 1)),
    rule("guarded", compare("b", ">", 1), protected=True),
]
OPERATOR = Who("ann", "operator")
VIEWER = Who("eve", "viewer")


class LoneEngine(LiveEngine):
    """The real swap of states, and nothing around it."""

    def __init__(self, table: Table) -> None:
        self.table = compile_table(table)
        self.state = initial_state(self.table, 0.0)
        self.revision = 1
        self.busy: set[str] = set()
        self.cancelled: list[str] = []
        self.prepared = 0
        self.problem: Exception | None = None

    def swap(
        self, table: CompiledTable, revision: int, reset: Collection[str], cancel: str
    ) -> Swap:
        plan = plan_migration(self.table, table, reset)
        self.state, carried, _ = swap(plan, self.state, 0.0)
        self.table, self.revision = table, revision
        self.cancelled.append(cancel)
        return Swap(carried, 0.0)

    def prepare(self, table: CompiledTable) -> None:
        self.prepared += 1
        if self.problem is not None:
            raise self.problem

    def running(self) -> frozenset[str]:
        return frozenset(self.busy)


def at_once(work: Callable[[], None]) -> None:
    work()


class NoLints(LiveLints):
    """Finds nothing to think about, unless it is told to fail."""

    def __init__(self) -> None:
        self.problem: Exception | None = None

    def foreseen(self, table: CompiledTable) -> Foreseen:
        return Foreseen([], Outlook({}, (), ""))

    def found(self, table: Table, verdicts: Mapping[str, Verdict]) -> list[Finding]:
        if self.problem is not None:
            raise self.problem
        return []


class Changes:
    """A table manager with a real store, and a clock that stands still until it is moved."""

    def __init__(
        self,
        folder: Path,
        recipe: list[dict[str, Any]] | None = None,
        catalog: Catalog | None = None,
        opened: Callable[[], None] = lambda: None,
    ) -> None:
        self.now = 1000.0
        self.recipe = Table.model_validate({"rules": BASE if recipe is None else recipe})
        self.store = RuleStore.open(folder, clock=lambda: self.now)
        opened()
        boot = self.store.begin_session(self.recipe, epoch=f"session-{id(self)}", stack="s")
        assert boot.revision is not None
        self.engine, self.lints = LoneEngine(boot.table), NoLints()
        self.said: list[str] = []
        self.edited: list[tuple[str, int, str, str]] = []
        self.count = 0
        self.active = ActiveTable(
            InForce(boot.table, boot.revision, boot.revision, notice=boot.notice),
            boot.merge,
            self._count,
            clock=lambda: self.now,
        )
        self.manager = TableManager(
            self.store,
            self.engine,
            catalog or MessageTypes(),
            self.active,
            recipe=self.recipe,
            permissions=Permissions({}, self.recipe),
            robot="test",
            lints=self.lints,
            announce=self.said.append,
            later=at_once,
            edited=lambda *what: self.edited.append(what),
        )

    def _count(self, _: frozenset[str]) -> None:
        self.count += 1

    def apply(self, rules: list[dict[str, Any]], who: Who = OPERATOR, **more: Any) -> ChangeAnswer:
        expected = more.pop("expected", self.manager.in_force.revision)
        text = json.dumps({"rules": rules})
        return self.manager.apply(text, who, expected=expected, **more)

    @property
    def agree(self) -> bool:
        """Whether manager, engine and store are of one mind."""
        now = self.manager.in_force
        stored = self.store.table(self.store.active)
        return (
            now.table == self.engine.table.table == stored
            and now.revision == self.engine.revision == self.store.active
            and now.confirmed == self.store.confirmed
        )


@pytest.fixture
def changes(tmp_path: Path) -> Iterator[Changes]:
    made = Changes(tmp_path)
    yield made
    made.store.close()


def ids(table: Table) -> list[str]:
    return [each.id for each in table.rules]


NEW = rule("new", compare("c", ">", 1))


def test_an_applied_table_is_stored_before_it_is_in_force(changes: Changes) -> None:
    answer = changes.apply([*BASE, NEW], reason="to see", probation=0.0)
    assert answer.ok
    report = answer.body
    assert isinstance(report, ApplyReport)
    assert (report.revision, report.previous, report.probation) == (2, 1, 0.0)
    assert (report.effect.carried, report.effect.added) == (("first", "guarded"), ("new",))
    assert changes.agree
    made = changes.store.revision(2)
    assert (made.author, made.role, made.reason, made.outcome) == (
        *("ann", "operator", "to see"),
        "confirmed",
    )


def test_a_table_that_cannot_be_stored_changes_nothing(
    changes: Changes, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: Any, **__: Any) -> None:
        raise StoreUnwritable("cannot write rules.db: disk full; free some space on the disk")

    monkeypatch.setattr(changes.store, "append", full)
    answer = changes.apply([*BASE, NEW])
    assert (answer.outcome, answer.revision) == ("failed", 1)
    assert "free some space" in answer.message
    assert "revision 1 stay in force" in answer.message
    assert changes.engine.revision == 1
    assert changes.count == 0


def test_what_the_engine_cannot_listen_to_is_not_stored(changes: Changes) -> None:
    changes.engine.problem = RuntimeError("no")
    with pytest.raises(RuntimeError):
        changes.apply([*BASE, NEW])
    assert changes.agree
    assert changes.store.active == 1


def test_a_change_costs_what_changed(tmp_path: Path) -> None:
    class Counting(MessageTypes):
        looked = 0

        def field_type(self, type_name: str, path: tuple[str | int, ...]) -> FieldType | None:
            self.looked += 1
            return super().field_type(type_name, path)

    catalog = Counting()
    many = [
        rule(f"rule-{number}", compare("c", ">", number)) | {"source": "recipe"}
        for number in range(42)
    ]
    changes = Changes(tmp_path, many, catalog=catalog)
    all_of_them = catalog.looked
    for bound in (98, 99):  # the first change after a start, and another
        before, catalog.looked = changes.manager.in_force.table.rules, 0
        many[20] = rule("rule-20", compare("c", ">", bound))
        assert changes.apply(many).ok
        assert 0 < catalog.looked <= all_of_them / 20
        now = changes.manager.in_force.table.rules
        # The same objects: what was worked out of them (hash, text, …) still holds.
        assert [place for place in range(42) if now[place] is not before[place]] == [20]
        stored = changes.store.table(changes.store.active).rules
        assert all(a is b for a, b in zip(now, stored, strict=True))
    changes.store.close()


def test_who_is_too_late_gets_both_diffs_and_changes_nothing(changes: Changes) -> None:
    assert changes.apply([*BASE, NEW], expected=1).ok
    answer = changes.apply([rule("first", compare("a", ">", 7)), BASE[1]], expected=1)
    assert (answer.outcome, answer.revision) == ("conflict", 2)
    body = answer.body
    assert isinstance(body, Conflict)
    assert [each.rule_id for each in body.theirs.changes] == ["new"]
    assert [each.rule_id for each in body.yours.changes] == ["first"]
    assert (body.author, body.both) == ("ann", ())
    assert changes.agree


def test_a_revision_that_never_was_is_no_conflict(changes: Changes) -> None:
    answer = changes.apply([*BASE, NEW], expected=99)
    assert answer.outcome == "refused"
    assert "no such revision" in answer.message


def test_probation_ends_by_itself_and_goes_back_to_what_was_confirmed(changes: Changes) -> None:
    assert changes.apply([*BASE, NEW], probation=30.0).ok
    changes.now += 10.0
    assert changes.active.probation_left == pytest.approx(20.0)
    # A second edit on top of an unconfirmed one does not make the first one good.
    assert changes.apply([*BASE, NEW, rule("more", compare("d", ">", 1))], probation=30.0).ok
    changes.now += 29.9
    changes.manager.end_probation()
    assert changes.manager.in_force.revision == 3
    changes.now += 0.2
    changes.manager.end_probation()
    now = changes.manager.in_force
    assert (ids(now.table), now.revision, now.confirmed) == (["first", "guarded"], 4, 4)
    assert "revision 3 was taken back because nobody confirmed it" in now.notice
    assert changes.said == [now.notice]
    assert changes.engine.cancelled[-1]
    assert [changes.store.revision(n).outcome for n in (2, 3, 4)] == [
        "superseded",
        "taken back",
        "confirmed",
    ]
    assert changes.agree


def test_a_full_disk_does_not_keep_a_table_in_force(
    changes: Changes, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert changes.apply([*BASE, NEW], probation=30.0).ok

    def full(*_: Any, **__: Any) -> None:
        raise StoreUnwritable("disk full")

    monkeypatch.setattr(changes.store, "take_back", full)
    changes.now += 31.0
    changes.manager.end_probation()
    assert ids(changes.engine.table.table) == ["first", "guarded"]
    assert "could not be stored: disk full" in changes.manager.in_force.notice


@pytest.mark.parametrize(("asked", "given"), [(-1.0, 60.0), (0.0, 0.0), (5.0, 5.0)])
def test_probation_is_as_asked(changes: Changes, asked: float, given: float) -> None:
    body = changes.apply([*BASE, NEW], probation=asked).body
    assert isinstance(body, ApplyReport)
    assert body.probation == given == changes.active.probation_left


@pytest.mark.parametrize("wrong", [float("nan"), float("inf"), 1e9])
def test_a_probation_that_is_no_time_is_refused(changes: Changes, wrong: float) -> None:
    answer = changes.apply([*BASE, NEW], probation=wrong)
    assert answer.outcome == "refused"
    assert "probation" in answer.message
    assert changes.manager.in_force.revision == 1


def test_only_what_is_in_force_can_be_confirmed(changes: Changes) -> None:
    assert changes.apply([*BASE, NEW]).ok
    assert not changes.manager.confirm(1, OPERATOR).ok
    assert not changes.manager.confirm(2, VIEWER).ok
    assert changes.manager.confirm(2, OPERATOR).ok
    assert changes.manager.confirm(2, OPERATOR).ok
    assert changes.active.probation_left == 0.0
    changes.now += 1000.0
    changes.manager.end_probation()
    assert changes.manager.in_force.revision == 2
    assert changes.agree


def test_going_back_from_probation_is_for_good(changes: Changes) -> None:
    assert changes.apply([*BASE, NEW]).ok
    answer = changes.manager.rollback(0, OPERATOR)
    assert answer.ok
    assert (ids(changes.manager.in_force.table), changes.active.probation_left) == (
        ["first", "guarded"],
        0.0,
    )
    made = changes.store.revision(3)
    assert (made.origin, made.restores, made.outcome) == ("rollback", 1, "confirmed")
    assert changes.agree


def test_going_back_twice_goes_back_further(changes: Changes) -> None:
    second, third = rule("n2", compare("c", ">", 2)), rule("n3", compare("c", ">", 3))
    for added in ([NEW], [NEW, second], [NEW, second, third]):
        assert changes.apply([*BASE, *added], probation=0.0).ok
    assert changes.manager.rollback(0, OPERATOR).ok
    assert ids(changes.manager.in_force.table)[2:] == ["new", "n2"]
    assert changes.manager.rollback(2, OPERATOR).ok
    assert ids(changes.manager.in_force.table)[2:] == ["new"]


def test_what_was_never_confirmed_is_on_probation_again(changes: Changes) -> None:
    assert changes.apply([*BASE, NEW]).ok
    assert changes.manager.rollback(0, OPERATOR).ok
    assert changes.manager.rollback(2, OPERATOR).ok
    assert changes.active.probation_left == 60.0
    assert changes.manager.in_force.confirmed == 3


def test_there_is_nothing_before_the_first_table(changes: Changes) -> None:
    answer = changes.manager.rollback(0, OPERATOR)
    assert (answer.outcome, changes.manager.in_force.revision) == ("refused", 1)
    assert not changes.manager.rollback(77, OPERATOR).ok
    assert not changes.manager.rollback(1, OPERATOR, expected=5).ok


def test_protected_rules_and_viewers_are_refused_and_it_is_noted(changes: Changes) -> None:
    for rules, who, word in (
        ([BASE[0]], OPERATOR, "protected"),
        ([*BASE, NEW], VIEWER, "look at rules and change nothing"),
    ):
        answer = changes.apply(rules, who)
        assert answer.outcome == "refused"
        assert word in answer.message
        assert isinstance(answer.body, CheckReport)
        assert answer.body.ok is False
    changes.store.flush()
    assert [each.author for each in changes.store.refusals()] == ["eve", "ann"]
    assert changes.agree


def test_a_check_changes_nothing_and_says_what_would_happen(changes: Changes) -> None:
    changes.engine.busy = {"first"}
    report = changes.manager.queries.check(
        json.dumps({"rules": [rule("first", compare("a", ">", 2)), BASE[1], NEW]}), "operator"
    )
    assert report.ok
    assert report.effect.reset == report.effect.running == ("first",)
    assert (report.effect.carried, report.effect.added) == (("guarded",), ("new",))
    assert changes.count == 0
    assert changes.agree


def test_a_disabled_rule_stays_disabled_over_a_restart(tmp_path: Path) -> None:
    first = Changes(tmp_path)
    assert first.apply([BASE[0] | {"enabled": False}, BASE[1]], probation=0.0).ok
    first.store.close()
    second = Changes(tmp_path)
    assert [each.enabled for each in second.manager.in_force.table.rules] == [False, True]
    second.store.close()


def test_a_table_that_cannot_be_looked_through_is_in_force_and_said_to_be(changes: Changes) -> None:
    changes.lints.problem = RuntimeError("the graph does not answer")
    answer = changes.apply([*BASE, NEW])
    assert answer.ok
    assert changes.agree
    assert isinstance(answer.body, ApplyReport)
    assert [each.code for each in answer.body.findings] == ["not-looked-at"]
    assert "the graph does not answer" in answer.body.findings[0].text


def test_where_a_rule_comes_from_is_for_the_robot_to_say(changes: Changes) -> None:
    def sources() -> dict[str, str]:
        return {each.id: each.source for each in changes.manager.in_force.table.rules}

    # A file may say what it likes: of another robot's recipe, or of rules changed since.
    mine = rule("mine", compare("c", ">", 1)) | {"source": "recipe"}
    dressed = BASE[0] | {"note": "mind the dock", "source": "recipe"}
    assert changes.apply([dressed, BASE[1] | {"source": "edited"}, mine]).ok
    assert sources() == {"first": "edited", "guarded": "recipe", "mine": "edited"}
    # What is as the recipe has it is the recipe's again, however it came back.
    assert changes.apply([BASE[0] | {"source": "edited"}, BASE[1]]).ok
    assert sources() == {"first": "recipe", "guarded": "recipe"}
    assert changes.agree


def test_a_reset_rule_starts_afresh_and_makes_no_revision(changes: Changes) -> None:
    changes.engine.state.rules[0].fired = 5
    assert not changes.manager.reset("first", VIEWER).ok
    assert not changes.manager.reset("nobody", OPERATOR).ok
    assert changes.manager.reset("first", OPERATOR).ok
    assert changes.engine.state.rules[0].fired == 0
    assert changes.manager.in_force.revision == 1
    assert changes.said == ["ann has reset the rule 'first'"]


def test_only_an_engineer_lets_a_protected_rule_start_afresh(tmp_path: Path) -> None:
    recipe = [{**BASE[0], "protected": True, "source": "recipe"}, *BASE[1:]]
    changes = Changes(tmp_path, recipe)
    refused = changes.manager.reset("first", OPERATOR)
    assert (refused.outcome, "protected" in refused.message) == ("refused", True)
    rules = [json.loads(rule.model_dump_json()) for rule in changes.manager.in_force.table.rules]
    again = changes.apply(rules, reset=["first"])
    assert (again.outcome, "protected" in again.message) == ("refused", True)
    assert changes.manager.reset("first", Who("eva", "engineer")).ok


def test_a_table_that_would_listen_to_a_thousand_topics_is_refused_at_once(
    changes: Changes,
) -> None:
    topics = [compare(f"t{number}", ">", 1) for number in range(1000)]
    crowd = rule("crowd", {"kind": "any", "conditions": topics})
    answer = changes.apply([*BASE, crowd])
    assert answer.outcome == "refused"
    assert "more than 500 topics" in answer.message
    assert changes.manager.in_force.revision == 1


def test_after_a_start_on_a_read_only_disk_the_rules_can_be_edited_again_once_it_is_writable(
    tmp_path: Path, databases: Databases
) -> None:
    first = Changes(tmp_path)
    assert first.apply([*BASE, NEW], probation=0.0).ok
    first.store.close()
    changes = Changes(tmp_path, opened=lambda: databases.write_protect("rules.db"))
    kept = changes.manager.in_force
    assert (kept.revision, kept.table) == (2, first.manager.in_force.table)
    assert "make the disk and the file writable" in kept.notice
    assert changes.apply(BASE).outcome == "failed"
    changes.manager.recover()
    assert not changes.manager.has_recovered()
    databases.allow_writing("rules.db")
    changes.manager.recover()
    assert changes.manager.has_recovered()
    assert changes.manager.in_force == kept._replace(notice="")
    assert changes.said == ["the disk takes changes of the rules again"]
    changes.manager.recover()
    assert len(changes.said) == 1
    assert changes.apply(BASE, probation=0.0).revision == 3


def test_without_a_store_rules_can_be_seen_and_not_changed() -> None:
    table = Table.model_validate({"rules": BASE})
    notice = "the disk is read-only; make it writable"
    manager = TableManager(
        None,
        LoneEngine(table),
        MessageTypes(),
        ActiveTable(InForce(table, 0, 0, notice=notice), None, lambda gone: None),
        recipe=table,
        permissions=Permissions({}, table),
        robot="test",
        lints=NoLints(),
        announce=lambda _: None,
        later=at_once,
        edited=lambda *_: None,
    )
    assert manager.queries.view().table == table
    answer = manager.apply(json.dumps({"rules": [*BASE, NEW]}), OPERATOR, expected=0)
    assert answer.outcome == "failed"
    assert notice in answer.message
    assert not manager.rollback(0, OPERATOR).ok
    assert manager.in_force.table == table


def test_edits_of_an_older_recipe_are_offered_until_somebody_decides(tmp_path: Path) -> None:
    first = Changes(tmp_path)
    assert first.apply([*BASE, NEW], probation=0.0).ok
    first.store.close()
    second = Changes(tmp_path, [rule("first", compare("a", ">", 5)), BASE[1]])
    offer = second.manager.queries.view().merge
    assert offer is not None
    assert ids(offer.table) == ["first", "guarded", "new"]
    assert offer.table.rules[0].event == second.recipe.rules[0].event
    merged = json.loads(offer.table.model_dump_json())["rules"]
    assert second.apply(merged, probation=5.0).ok
    second.now += 6.0
    second.manager.end_probation()
    assert second.manager.queries.view().merge == offer
    assert second.apply(merged, probation=0.0).ok
    assert second.manager.queries.view().merge is None
    second.store.close()


STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("apply"), st.integers(0, 5), st.sampled_from([-1.0, 0.0, 5.0])),
        st.tuples(st.just("late"), st.integers(0, 5), st.just(0.0)),
        st.tuples(st.just("confirm"), st.integers(0, 1), st.just(0.0)),
        st.tuples(st.just("back"), st.integers(0, 6), st.just(0.0)),
        st.tuples(st.just("wait"), st.integers(1, 70), st.just(0.0)),
    ),
    max_size=12,
)


@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(steps=STEPS)
def test_manager_engine_and_store_agree_whatever_is_done(
    steps: list[tuple[str, int, float]], tmp_path_factory: pytest.TempPathFactory
) -> None:
    changes = Changes(tmp_path_factory.mktemp("changes"))
    confirmed = [table_hash(changes.manager.in_force.table)]
    for what, number, probation in steps:
        now = changes.manager.in_force
        changed = [*BASE, *[rule(f"n{k}", compare("c", ">", k)) for k in range(number)]]
        if what == "apply":
            assert changes.apply(changed, probation=probation).ok
        elif what == "late":
            assert not changes.apply(changed, expected=now.revision + 1).ok
            assert changes.manager.in_force == now
        elif what == "confirm":
            assert changes.manager.confirm(now.revision - number, OPERATOR).ok is (number == 0)
        elif what == "back":
            changes.manager.rollback(number, OPERATOR)
        else:
            changes.now += number
            changes.manager.end_probation()
            if now.probation_ends is not None and changes.now >= now.probation_ends:
                assert table_hash(changes.manager.in_force.table) == confirmed[-1]
        assert changes.agree
        now = changes.manager.in_force
        if now.revision == now.confirmed:
            confirmed.append(table_hash(now.table))
        assert (now.probation_ends is None) is (now.revision == now.confirmed)
    changes.store.close()
