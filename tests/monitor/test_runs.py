"""Of what the engine lets fire, each run is begun, told of and ended exactly once."""

from collections.abc import Sequence
from typing import Any

import pytest
from rclpy.task import Future

from kompass.monitor.execution.runs import Runs, Tell
from kompass.monitor.reporting.entries import ActionOutcome, RunEntry
from kompass.monitor.reporting.firings import Firings
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.firing import Firing, Note, Output
from kompass.rules.schema.actions import Log, Method
from kompass.rules.schema.table import Rule, Severity, Table
from tests.support.rules import compare, rule


class Told(Firings):
    """Keeps in lists what it is to tell, and tells nobody."""

    def __init__(self) -> None:
        self.heard: list[tuple[Any, ...]] = []
        self.entries: list[RunEntry] = []
        self._number = 0

    def begins(self, rule: Rule, rule_hash: str) -> None:
        """Nothing to keep."""

    def fired(self, entry: RunEntry, message: Any) -> int:
        self._number += 1
        self.heard.append((entry.kind, entry.rule_id, entry.text))
        self.entries.append(entry)
        return self._number

    def acted(self, entry: RunEntry, number: int, outcome: ActionOutcome) -> None:
        self.heard.append(("acted", entry.rule_id, outcome.action))

    def ended(self, entry: RunEntry, number: int, ok: bool, error: str) -> None:
        self.entries.append(entry)
        self.heard.append(("ended", entry.rule_id, ok, error))


class World:
    """Runs whose actions last until they are told to end."""

    def __init__(self) -> None:
        self.told = Told()
        self.done: list[tuple[str, int, bool, str]] = []
        self.futures: dict[tuple[str, int], Future] = {}
        self.follows: dict[str, Firing] = {}
        self.runs = Runs(self._perform, self._done, self.told)

    async def _perform(self, firing: Firing, tell: Tell) -> tuple[bool, str]:
        future = self.futures[(firing.rule_id, firing.run_id)] = Future()
        ok = bool(await future)
        tell(ActionOutcome("action", ok, "", 0.0))
        return ok, "" if ok else "it failed"

    def _done(self, rule_id: str, run_id: int, ok: bool, error: str) -> None:
        self.done.append((rule_id, run_id, ok, error))
        if rule_id in self.follows:
            self.take([self.follows.pop(rule_id)])

    def take(self, outputs: Sequence[Output], revision: int = 1) -> None:
        """Have outputs carried out that rules of one table let come."""
        rules = [rule(each.rule_id, compare("a", ">", 1), name="named") for each in outputs]
        table = compile_table(Table.model_validate({"rules": rules}))
        self.runs.take(outputs, table, revision)

    def end(self, rule_id: str, run_id: int, ok: bool = True) -> None:
        self.futures[(rule_id, run_id)].set_result(ok)


@pytest.fixture
def world() -> World:
    return World()


def firing(rule_id: str, run_id: int, component: str = "", **more: Any) -> Firing:
    action = Method(component=component, method="go") if component else Log(text="hello")
    given: dict[str, Any] = {
        "lane": "normal",
        "severity": Severity.WARNING,
        "actions": (action,),
    } | more
    return Firing(rule_id, run_id, 1.0, 1.0, "hash", None, None, {}, (), **given)


def test_a_run_is_told_from_its_beginning_to_its_end(world: World) -> None:
    world.take([firing("a", 1)])
    assert world.runs.running() == {"a"}
    world.end("a", 1)
    assert world.told.heard == [
        ("firing", "a", ""),
        ("acted", "a", "action"),
        ("ended", "a", True, ""),
    ]
    assert world.done == [("a", 1, True, "")]
    assert world.runs.running() == frozenset()
    assert world.runs.extras("a").last_ok is True


def test_a_run_is_told_of_with_the_table_that_let_it_fire_to_its_end(world: World) -> None:
    world.take([firing("a", 1)], revision=7)
    world.take([firing("b", 2)], revision=8)  # a swap lies between the two
    world.end("a", 1)
    assert [(each.rule_id, each.revision, each.name) for each in world.told.entries] == [
        ("a", 7, "named"),
        ("b", 8, "named"),
        ("a", 7, "named"),
    ]


def test_a_run_that_takes_over_ends_the_one_before_for_good(world: World) -> None:
    world.take([firing("a", 1)])
    world.take([firing("a", 2, cancels=(1,))])
    assert world.done == [("a", 1, False, "cancelled: run 2 of the same rule took over")]
    world.end("a", 1)
    world.end("a", 2)
    assert world.done[1:] == [("a", 2, True, "")]


def test_the_more_severe_rule_takes_the_component_and_the_loser_is_recorded(world: World) -> None:
    world.take([firing("mild", 1, "wheels")])
    world.take([firing("stern", 2, "wheels", severity=Severity.ERROR)])
    assert world.done == [
        ("mild", 1, False, "cancelled: the more severe rule 'stern' took over"),
    ]
    world.take([firing("mild", 3, "wheels"), firing("other", 4, "lamp")])
    assert world.runs.running() == {"stern", "other"}
    assert world.done[-1] == (
        *("mild", 3, False),
        "outranked: the more severe rule 'stern' has wheels",
    )
    assert ("outranked", "mild", "the more severe rule 'stern' has wheels") in world.told.heard
    assert world.runs.extras("mild").outranked == 1


def test_what_keeps_people_safe_begins_first(world: World) -> None:
    world.take([firing("slow", 1), firing("safe", 2, lane="safety")])
    assert [each[1] for each in world.told.heard] == ["safe", "slow"]


def test_what_follows_from_an_end_is_carried_out_too(world: World) -> None:
    world.follows["a"] = firing("b", 2)
    world.take([firing("a", 1)])
    world.end("a", 1, ok=False)
    assert world.done == [("a", 1, False, "it failed")]
    assert world.runs.running() == {"b"}


def test_a_shadow_and_a_note_are_told_and_not_run(world: World) -> None:
    note = Note("near_miss", "b", 1.0, "hash", Severity.INFO, "it nearly fired")
    world.take([firing("a", 1, shadow=True), note])
    assert world.told.heard == [("shadow", "a", ""), ("near miss", "b", "it nearly fired")]
    assert world.runs.running() == frozenset()
    assert world.done == []


def test_at_the_end_of_the_monitor_all_runs_end(world: World) -> None:
    world.take([firing("a", 1), firing("b", 2)])
    world.runs.close()
    assert [each[0] for each in world.done] == ["a", "b"]
    assert all("the monitor ends" in each[3] for each in world.done)
