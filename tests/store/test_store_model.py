"""The store against a plain list, over random histories with crashes; and malformed tables."""

import tempfile
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)

from kompass.rules.schema.table import Table
from kompass.store.errors import StaleRevision
from tests.rules.strategies import tables
from tests.store.tables import BY, RECIPE, Robot
from tests.support.properties import few_or_many


class Histories(RuleBasedStateMachine):
    """Applies, confirms, rolls back, crashes and starts again; a list says what must be stored."""

    def __init__(self) -> None:
        super().__init__()
        self.place = tempfile.TemporaryDirectory()
        self.robot = Robot(Path(self.place.name))
        self.tables: list[Table] = [RECIPE]
        self.outcomes = ["confirmed"]
        self.active = self.confirmed = 1

    @initialize()
    def begin(self) -> None:
        self.robot.start()

    def teardown(self) -> None:
        self.robot.store.close()
        self.place.cleanup()

    def settle(self, outcome: str) -> None:
        self.outcomes = [outcome if o == "active" else o for o in self.outcomes]

    def add(self, table: Table, outcome: str) -> None:
        self.tables.append(table)
        self.outcomes.append(outcome)
        self.active = len(self.tables)
        if outcome == "confirmed":
            self.confirmed = self.active

    @rule(table=tables(), confirmed=st.booleans())
    def apply(self, table: Table, confirmed: bool) -> None:
        # Far apart, so that the crash-loop guard has nothing to say here.
        self.robot.clock.now += 1000.0
        made = self.robot.store.append(table, parent=self.active, confirmed=confirmed, **BY)
        self.settle("superseded")
        self.add(table, "confirmed" if confirmed else "active")
        assert made.number == self.active

    @rule()
    def confirm(self) -> None:
        self.robot.store.set_confirmed(self.active, **BY)
        self.outcomes[self.active - 1] = "confirmed"
        self.confirmed = self.active

    @rule()
    def take_back(self) -> None:
        self.robot.store.take_back("enough")
        self.settle("taken back")
        self.add(self.tables[self.confirmed - 1], "confirmed")

    @rule(data=st.data())
    def roll_back(self, data: Any) -> None:
        number = data.draw(st.integers(1, len(self.tables)))
        table = self.robot.store.table(number)
        self.robot.store.append(table, origin="rollback", restores=number, **BY)
        self.settle("taken back")
        self.add(self.tables[number - 1], "active")

    @precondition(lambda self: self.active > 1)
    @rule()
    def from_an_old_revision(self) -> None:
        with pytest.raises(StaleRevision):
            self.robot.store.append(RECIPE, parent=self.active - 1, **BY)

    @rule(clean=st.booleans(), seconds=st.floats(100.0, 1e6))
    def restart(self, clean: bool, seconds: float) -> None:
        self.robot.clock.now += seconds
        self.robot.stop() if clean else self.robot.crash()
        boot = self.robot.start()
        if "active" in self.outcomes:
            self.settle("taken back")
            self.add(self.tables[self.confirmed - 1], "confirmed")
        else:
            self.active = self.confirmed
        assert boot.revision == self.active
        assert boot.table == self.tables[self.active - 1]

    @invariant()
    def it_holds_what_the_list_holds(self) -> None:
        history = self.robot.store.history(count=1000)
        assert (history.active, history.confirmed) == (self.active, self.confirmed)
        assert [r.outcome for r in reversed(history.revisions)] == self.outcomes
        assert self.robot.store.table(self.active) == self.tables[self.active - 1]


@few_or_many(8, few=2)
def test_the_store_holds_what_a_plain_list_holds_whatever_is_done_to_it(examples: int) -> None:
    run_state_machine_as_test(
        Histories, settings=settings(max_examples=examples, stateful_step_count=15, deadline=None)
    )


@few_or_many(40)
def test_every_table_comes_back_as_it_was(tmp_path: Path, examples: int) -> None:
    robot = Robot(tmp_path)
    robot.start()

    @settings(max_examples=examples, deadline=None)
    @given(table=tables())
    def check(table: Table) -> None:
        number = robot.store.append(table, **BY).number
        assert robot.store.table(number) == table

    check()
    robot.stop()


JUNK = st.one_of(
    st.none(),
    st.just(float("nan")),
    st.just(-1.0),
    st.just("$msg..x"),
    st.just("\ud800"),
    st.text(max_size=3),
    st.dictionaries(st.text(max_size=5), st.integers(), max_size=2),
    st.lists(st.integers(), max_size=2),
)
EVENT_FIELDS = ("condition", "hold", "trigger", "mode")
RULE_FIELDS = ("id", "event", "actions", "severity", "lane", "enabled", "note")
FIELDS = st.sampled_from([*RULE_FIELDS, *(f"event.{name}" for name in EVENT_FIELDS)])


@few_or_many(150)
@pytest.mark.filterwarnings("ignore::UserWarning")  # pydantic's, on what it serializes
def test_malformed_tables_are_never_written(tmp_path: Path, examples: int) -> None:
    robot = Robot(tmp_path)
    robot.start()
    (good,) = RECIPE.rules

    @settings(max_examples=examples, deadline=None)
    @given(field=FIELDS, junk=JUNK)
    def check(field: str, junk: Any) -> None:
        # As a careless caller might make it: copies are not validated.
        inner = field.removeprefix("event.")
        change = {field: junk}
        if inner != field:
            change = {"event": good.event.model_copy(update={inner: junk})}
        table = Table.model_construct(rules=(good.model_copy(update=change),))
        before = len(robot.store.history(count=1000).revisions)
        try:
            number = robot.store.append(table, **BY).number
        except Exception:  # noqa: BLE001 - whatever it is, nothing may be stored
            assert len(robot.store.history(count=1000).revisions) == before
        else:
            assert robot.store.table(number).model_dump() == table.model_dump()

    check()
    robot.stop()
    assert robot.start().table == RECIPE
