"""One line of a recipe adds what is tried before a goal is given up, as rules like all others."""

import pytest
from kompass_interfaces.msg import GoalHindrance

from kompass.components import Component, DriveManager, Planner, PlannerConfig
from kompass.launch.stack import Stack, stacks_go_to
from kompass.launcher import Launcher
from kompass.recipe.ladder import ladder
from kompass.recipe.table import recipe_rules
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.firing import Firing, RunEnded, Sample
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.table import Table

STEPS = ["forget", "back-off", "turn", "wider", "narrower", "wait"]


def table_of(*, recovery: bool) -> Table:
    launcher, given = Launcher(), list[Stack]()
    launcher.kompass([Planner(), DriveManager()])
    if recovery:
        launcher.recovery()
    with stacks_go_to(given.append):
        launcher.bringup()
    monitored = given[0].monitored
    assert monitored is not None
    return monitored.rules.table


def fired(said: list[GoalHindrance]) -> list[list[str]]:
    """Which rules fire on each message."""
    planner, driver = Planner(), DriveManager()
    table = compile_table(recipe_rules(ladder(planner, driver), [planner, driver]).table)
    state, out = initial_state(table, 0.0), []
    for number, message in enumerate(said):
        state, outputs = step(table, state, Sample("goal_hindrance", message), 0.5 * number)
        firings = [each for each in outputs if isinstance(each, Firing)]
        for each in firings:
            state, _ = step(table, state, RunEnded(each.rule_id, each.run_id), 0.5 * number)
        out.append([each.rule_id.removeprefix("recovery-") for each in firings])
    return out


def test_a_recipe_that_says_nothing_has_no_rule_of_it() -> None:
    assert table_of(recovery=False).rules == ()
    ids = [rule.id.removeprefix("recovery-") for rule in table_of(recovery=True).rules]
    assert ids == [*STEPS, "tell", "told"]


def test_its_rules_are_open_to_people_and_say_what_they_do() -> None:
    for rule in table_of(recovery=True).rules:
        assert not rule.protected
        assert "→" in rule.name


def test_each_step_comes_once_in_its_order_and_anew_after_the_robot_got_on() -> None:
    said = [GoalHindrance(patience_used=0.1 * n + 0.05) for n in range(10)] + [GoalHindrance()]
    said += [GoalHindrance(patience_used=0.25)]
    steps = [[name for name in names if name in STEPS] for names in fired(said)]
    assert [name for names in steps for name in names] == [*STEPS, "forget"]
    assert all(len(names) <= 1 for names in steps)


def test_people_are_told_of_a_goal_that_was_given_up_until_there_is_another() -> None:
    given_up = GoalHindrance(kind="seen", given_up=True, patience_used=1.0, text="In the way: …")
    rounds = fired([GoalHindrance(), GoalHindrance(), given_up, GoalHindrance(), given_up])
    told = [[name for name in names if name not in STEPS] for names in rounds]
    assert told == [[], [], ["tell"], ["told"], ["tell"]]


def test_the_clearance_of_the_steps_is_a_multiple_of_the_planners() -> None:
    planner, driver = Planner(config=PlannerConfig(clearance=0.3)), DriveManager()
    made = recipe_rules(ladder(planner, driver), [planner, driver]).table
    given = {rule.id: getattr(rule.actions[0], "kwargs", {}) for rule in made.rules}
    assert given["recovery-wider"] == {"clearance": 0.6}
    assert given["recovery-narrower"] == {"clearance": 0.15}


@pytest.mark.parametrize("added", [[], [Planner()], [DriveManager()]])
def test_without_planner_and_drive_manager_it_is_refused(added: list[Component]) -> None:
    launcher = Launcher()
    if added:
        launcher.kompass(added)
    with pytest.raises(ValueError, match=r"launcher\.kompass"):
        launcher.recovery()
