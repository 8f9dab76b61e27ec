"""Which table is in force after a start."""

import pytest

from kompass.rules.schema.table import Table
from kompass.store.session import this_machine
from tests.rules.building import received, rule
from tests.store.tables import BY, RECIPE, Robot, edited

NEW_RECIPE = Table(rules=(*RECIPE.rules, rule(received("map"), "map", source="recipe")))


def test_the_first_start_takes_the_recipes_table(robot: Robot) -> None:
    boot = robot.start()
    assert (boot.table, boot.revision, boot.notice) == (RECIPE, 1, "")
    assert (robot.store.active, robot.store.confirmed) == (1, 1)
    assert robot.store.revision(1).origin == "recipe"


def test_a_start_comes_back_to_the_confirmed_revision(robot: Robot) -> None:
    robot.start()
    number = robot.store.append(edited("x"), **BY).number
    robot.store.set_confirmed(number, **BY)
    robot.stop()
    boot = robot.start()
    assert (boot.table, boot.revision, boot.notice) == (edited("x"), 2, "")


def test_a_revision_without_probation_survives_a_crash(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("x"), confirmed=True, **BY)
    robot.crash()
    assert robot.start().revision == 2


@pytest.mark.parametrize("clean", [True, False])
def test_a_revision_on_probation_does_not_survive_a_restart(robot: Robot, clean: bool) -> None:
    robot.start()
    robot.store.append(edited("x"), **BY)
    robot.clock.now += 200.0
    robot.stop() if clean else robot.crash()
    boot = robot.start()
    assert boot.table == RECIPE
    assert "revision 2 (ava" in boot.notice
    assert "3 minutes ago" in boot.notice
    assert "revision 1 is in force again" in boot.notice
    assert robot.store.revision(3).restores == 1
    assert robot.outcomes() == {3: "confirmed", 2: "taken back", 1: "confirmed"}
    robot.stop()
    assert robot.start().notice == ""  # said once


def test_two_crashes_soon_after_an_apply_take_it_back(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("good"), confirmed=True, **BY)
    robot.clock.now += 1000.0
    robot.store.append(edited("bad"), confirmed=True, **BY)
    robot.clock.now += 5.0
    robot.crash()
    assert robot.start().table == edited("bad")  # one crash may be anything's
    robot.clock.now += 5.0
    robot.crash()
    boot = robot.start()
    assert boot.table == edited("good")
    assert "revision 3 (ava" in boot.notice
    assert "brought the monitor down 2 times within 60 s of being applied" in boot.notice
    assert robot.outcomes() == {4: "confirmed", 3: "taken back", 2: "confirmed", 1: "confirmed"}


def test_crashes_go_back_to_the_recipe_if_there_is_nothing_else(robot: Robot) -> None:
    robot.recipe = edited("the recipe's")
    robot.start()
    robot.store.append(edited("bad"), confirmed=True, **BY)
    robot.crash()
    robot.start()
    robot.crash()
    boot = robot.start()
    assert boot.table == robot.recipe


def test_a_recipe_that_crashes_is_said_to(robot: Robot) -> None:
    robot.start()
    for _ in range(2):
        robot.crash()
        boot = robot.start()
    assert boot.table == RECIPE
    assert "there is no other table to go back to: read the log, and mend the recipe" in boot.notice


def test_crashes_long_after_an_apply_are_not_put_down_to_it(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("x"), confirmed=True, **BY)
    for _ in range(4):
        robot.clock.now += 100.0
        robot.crash()
        boot = robot.start()
    assert (boot.table, boot.notice) == (edited("x"), "")


def test_a_table_with_which_the_monitor_does_not_even_start_is_taken_back(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("x"), confirmed=True, **BY)
    robot.clock.now += 1000.0
    robot.stop()
    for _ in range(3):
        assert robot.start().table == edited("x")
        robot.clock.now += 1.0
        robot.crash()
    boot = robot.start()
    assert boot.table == RECIPE
    assert "3 times in a row within 10 s" in boot.notice


def test_a_clean_end_is_no_crash(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("x"), confirmed=True, **BY)
    for _ in range(5):
        robot.stop()
        boot = robot.start()
    assert (boot.table, boot.notice) == (edited("x"), "")


def test_a_power_cut_is_not_the_tables_crash(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    robot.start()
    robot.store.append(edited("x"), confirmed=True, **BY)
    for number in range(4):
        robot.crash()
        machine = f"boot {number} after {this_machine()}"
        monkeypatch.setattr("kompass.store.store.this_machine", lambda m=machine: m)
        boot = robot.start()
    assert (boot.table, boot.notice) == (edited("x"), "")


def test_a_changed_recipe_wins_and_offers_the_edits(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("x"), confirmed=True, **BY)
    robot.stop()
    robot.recipe = NEW_RECIPE
    boot = robot.start()
    assert boot.table == NEW_RECIPE
    assert boot.merge is not None
    assert boot.merge.revision == 2
    assert "more" in [rule.id for rule in boot.merge.table.rules]
    assert "map" in [rule.id for rule in boot.merge.table.rules]
    assert "the edits of revision 2 wait to be merged" in boot.notice
    robot.stop()
    assert robot.start().merge is not None  # until somebody has decided
    robot.store.append(boot.merge.table, origin="merge", confirmed=True, **BY)
    robot.stop()
    boot = robot.start()
    assert (boot.merge, boot.notice) == (None, "")
    assert "more" in [rule.id for rule in boot.table.rules]


def test_a_recipe_that_changed_without_edits_offers_nothing(robot: Robot) -> None:
    robot.start()
    robot.stop()
    robot.recipe = NEW_RECIPE
    boot = robot.start()
    assert (boot.table, boot.merge, boot.notice) == (NEW_RECIPE, None, "")


def test_the_recipe_of_before_finds_its_own_edits(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("x"), confirmed=True, **BY)
    robot.stop()
    robot.recipe = NEW_RECIPE
    robot.start()
    robot.stop()
    robot.recipe = RECIPE
    assert robot.start().table == edited("x")


def test_edits_wait_through_two_changes_of_the_recipe(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("x"), confirmed=True, **BY)
    for recipe in (NEW_RECIPE, Table(rules=(*NEW_RECIPE.rules, rule(received("x"), "third")))):
        robot.stop()
        robot.recipe = recipe
        boot = robot.start()
    assert boot.merge is not None
    assert boot.merge.revision == 2


def test_a_name_changed_in_the_recipe_is_taken_over(robot: Robot) -> None:
    robot.start()
    robot.stop()
    named = RECIPE.rules[0].model_copy(update={"name": "A click"})
    robot.recipe = Table(rules=(named,))
    assert robot.start().table.rules[0].name == "A click"


def test_safe_mode_takes_the_recipe_and_loses_nothing(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("x"), confirmed=True, **BY)
    robot.stop()
    boot = robot.start(safe_mode=True)
    assert (boot.table, boot.revision, boot.safe_mode) == (RECIPE, 1, True)
    assert "safe mode" in boot.notice
    assert "revision 2 (ava" in boot.notice
    robot.crash()
    boot = robot.start()
    assert (boot.table, boot.revision, boot.notice) == (edited("x"), 2, "")


def test_safe_mode_after_a_crashing_recipe_leaves_the_confirmed_one(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("x"), confirmed=True, **BY)
    robot.stop()
    named = RECIPE.rules[0].model_copy(update={"name": "A click"})
    robot.recipe = Table(rules=(named,))
    assert robot.start(safe_mode=True).table == robot.recipe
    robot.stop()
    assert robot.start().table == edited("x")


def test_an_edit_in_safe_mode_counts(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("bad"), confirmed=True, **BY)
    robot.stop()
    robot.start(safe_mode=True)
    robot.store.append(edited("good"), parent=1, confirmed=True, **BY)
    robot.stop()
    assert robot.start().table == edited("good")
