"""The journal of firings."""

import sqlite3
import time
from contextlib import closing

import pytest

from kompass.rulebook.schema.journal import ActionRecord
from kompass.store import store as rule_store
from kompass.store.journal import LARGEST, JournalBounds
from kompass.store.store import RuleStore
from tests.store.tables import Robot, entry
from tests.support.disk import Databases
from tests.support.patience import patient


def test_a_firing_is_found_with_how_it_ended(robot: Robot) -> None:
    robot.start()
    entered = robot.store.record_firing(entry(run_id=7, message={"x": [1, 2]}))
    assert robot.store.firing("life 1", 7) == entered
    actions = (ActionRecord(action="log", ok=False, text="no", seconds=0.5),)
    robot.store.finish_firing(entered.number, ended=5.0, ok=False, error="no", actions=actions)
    robot.store.keep_recording(entered.number, "/there.mcap")
    found = robot.store.firing("", 7)
    assert found is not None
    assert (found.ended, found.ok, found.error, found.actions) == (5.0, False, "no", actions)
    assert (found.recording, found.message) == ("/there.mcap", {"x": [1, 2]})
    assert robot.store.firing("life 1", 8) is None


def test_of_an_entry_of_before_the_problem_is_what_the_action_said() -> None:
    before = {"action": "a.b", "ok": False, "text": "a.b did not succeed: no way", "seconds": 1.0}
    assert ActionRecord.model_validate(before).problem == before["text"]
    assert ActionRecord.model_validate({**before, "ok": True}).problem == ""
    assert ActionRecord.model_validate({**before, "problem": "no way"}).problem == "no way"


def test_entries_come_in_pages_newest_first_and_by_rule(robot: Robot) -> None:
    robot.start()
    for number in range(10):
        robot.store.record_firing(entry("even" if number % 2 == 0 else "odd", run_id=number))
    page = robot.store.journal(count=3)
    assert ([f.run_id for f in page.firings], page.more) == ([9, 8, 7], True)
    page = robot.store.journal(before=page.firings[-1].number, count=100)
    assert ([f.run_id for f in page.firings], page.more) == ([6, 5, 4, 3, 2, 1, 0], False)
    page = robot.store.journal(rule_id="even", count=2)
    assert ([f.run_id for f in page.firings], page.more) == ([8, 6], True)


def test_near_misses_of_a_rule_are_found(robot: Robot) -> None:
    robot.start()
    for number in range(5):
        robot.store.record_firing(entry(kind="near miss", text=str(number)))
        robot.store.record_firing(entry())
    assert [f.text for f in robot.store.near_misses("click", 2)] == ["4", "3"]


def test_a_number_is_never_used_twice(databases: Databases, robot: Robot) -> None:
    robot.start()
    first = robot.store.record_firing(entry()).number
    robot.stop()
    robot.start()
    assert robot.store.record_firing(entry()).number == first + 1
    # One that never reached the disk, as in a crash, keeps its number too.
    robot.store.flush()
    databases.fill("journal.db")
    lost = [robot.store.record_firing(entry(text="x" * 10_000)).number for _ in range(50)][-1]
    robot.store.flush()
    assert robot.store.lost_entries > 0
    robot.crash()
    robot.start()
    assert robot.store.record_firing(entry()).number > lost


def test_runs_that_a_crash_cut_short_have_failed(robot: Robot) -> None:
    robot.start()
    robot.store.record_firing(entry(run_id=3))
    robot.store.record_firing(entry(run_id=4, kind="shadow"))
    robot.crash()
    robot.start()
    found = robot.store.firing("life 1", 3)
    assert found is not None
    assert (found.ok, found.error) == (False, "the monitor ended while it ran")
    shadow = robot.store.firing("life 1", 4)
    assert shadow is not None
    assert shadow.error == ""


def test_it_is_bounded_by_count_and_by_size(robot: Robot) -> None:
    bounds = JournalBounds(count=100, size=100_000)
    with RuleStore.open(robot.folder, bounds=bounds) as store:
        for number in range(1000):
            store.record_firing(entry(run_id=number))
        kept = store.journal(count=1000).firings
        assert 90 <= len(kept) <= 100
        assert kept[0].run_id == 999
        for number in range(100):
            store.record_firing(entry(run_id=number, text="x" * 10_000))
        assert 8 <= len(store.journal(count=1000).firings) <= 10
    with RuleStore.open(robot.folder, bounds=bounds) as store:
        assert 8 <= len(store.journal(count=1000).firings) <= 10


def test_near_misses_do_not_push_out_firings(robot: Robot) -> None:
    with RuleStore.open(robot.folder, bounds=JournalBounds(count=50)) as store:
        store.record_firing(entry(run_id=77))
        for _ in range(500):
            store.record_firing(entry(kind="near miss", run_id=0))
        assert store.firing("life 1", 77) is not None
        assert len(store.journal(count=1000).firings) <= 51


def test_an_entry_that_is_too_large_is_kept_without_its_message(robot: Robot) -> None:
    robot.start()
    robot.store.record_firing(entry(message={"data": "x" * LARGEST}))
    (found,) = robot.store.journal().firings
    assert found.message is None
    assert "too long to be kept" in found.text


def test_entering_does_not_wait_for_the_disk(databases: Databases, robot: Robot) -> None:
    robot.start()
    robot.store.flush()
    with databases.hanging("journal.db"):
        begin = time.perf_counter()
        for number in range(1000):
            robot.store.record_firing(entry(run_id=number))
        took = time.perf_counter() - begin
    assert took < patient(0.5)  # measured: 10 µs each
    assert len(robot.store.journal(count=2000).firings) == 1000


def test_more_than_may_wait_is_lost_and_counted(databases: Databases, robot: Robot) -> None:
    robot.start()
    robot.store.flush()
    with databases.hanging("journal.db"):
        for number in range(5000):
            robot.store.record_firing(entry(run_id=number))
    robot.store.flush()
    assert robot.store.lost_entries > 0
    assert robot.store.lost_entries + len(robot.store.journal(count=9999).firings) == 5000


def test_what_guard_rails_forbade_is_kept(robot: Robot) -> None:
    robot.start()
    robot.store.refuse(author="eve", role="operator", what="apply", text="'click' is protected")
    (found,) = robot.store.refusals()
    assert (found.author, found.what, found.text) == ("eve", "apply", "'click' is protected")


def test_once_means_once_in_the_life_of_the_stack(robot: Robot) -> None:
    robot.start(stack="monday")
    robot.store.use_once("click", "abc")
    robot.crash()
    robot.start(stack="monday")
    assert robot.store.used_once() == {("click", "abc")}
    robot.store.reset_once("click")
    assert robot.store.used_once() == set()
    robot.store.use_once("click", "abc")
    robot.stop()
    robot.start(stack="tuesday")
    assert robot.store.used_once() == set()


def test_who_is_killed_right_after_its_one_firing_has_had_it(
    robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rule_store, "HANGING", 60.0)  # of a slow machine's disk
    robot.start()
    for number in range(20):
        robot.store.record_firing(entry(run_id=number))
        robot.store.use_once(f"rule-{number}", "abc")
        # As another process finds the file, without this one having ended.
        with closing(sqlite3.connect(robot.folder / "journal.db")) as other:
            found = other.execute("SELECT COUNT(*) FROM used").fetchone()
        assert found == (number + 1,)
