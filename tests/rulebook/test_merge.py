"""A changed recipe and the edits of people come together; what cannot is said, and nothing more."""

from typing import Any

from kompass.rulebook.merge import merge
from kompass.rulebook.views.recipe_code import functions_of
from kompass.rules.schema.actions import Log, Python
from kompass.rules.schema.table import Rule, Table
from tests.rules.building import compare, rule
from tests.rules.strategies import tables
from tests.support.properties import MANY, property_test


def recipe(rule_id: str = "stuck", **fields: Any) -> Rule:
    made = {"condition": compare("a", "<", 1), "source": "recipe", "cooldown": 60.0, **fields}
    condition: Any = made.pop("condition")
    return rule(condition, rule_id, **made)


def edited(rule_id: str = "stuck", **fields: Any) -> Rule:
    return recipe(rule_id, **{"source": "edited", **fields})


def merged(old: list[Rule], mine: list[Rule], new: list[Rule]) -> tuple[list[Rule], list[str]]:
    table, conflicts = merge(*(Table(rules=tuple(rules)) for rules in (old, mine, new)))
    return list(table.rules), conflicts


def test_edits_are_laid_over_what_the_recipe_left_alone_field_by_field() -> None:
    (made,), conflicts = merged(
        [recipe()], [edited(cooldown=20.0)], [recipe(condition=compare("a", "<", 2))]
    )
    assert conflicts == []
    assert (made.event.cooldown, made.event.condition) == (20.0, compare("a", "<", 2))
    assert made.source == "edited"


def test_where_both_changed_a_field_the_recipe_holds_and_says_so() -> None:
    (made,), (conflict,) = merged(
        [recipe()], [edited(cooldown=20.0)], [recipe(cooldown=5.0, name="stuck?")]
    )
    assert made.event.cooldown == 5.0
    assert conflict == (
        "'stuck?': both changed cooldown: the recipe says 5 s, you said 20 s; the recipe's holds"
    )


def test_both_making_the_same_change_is_no_conflict() -> None:
    assert merged([recipe()], [edited(cooldown=5.0)], [recipe(cooldown=5.0)]) == (
        [recipe(cooldown=5.0)],
        [],
    )


def test_what_was_switched_off_stays_off_whatever_the_recipe_does() -> None:
    (made,), conflicts = merged(
        [recipe()], [edited(enabled=False)], [recipe(condition=compare("a", "<", 2), note="new")]
    )
    assert (made.enabled, conflicts) == (False, [])


def test_what_was_removed_stays_away_unless_the_recipe_has_changed_it() -> None:
    assert merged([recipe()], [], [recipe()]) == ([], [])
    (made,), (conflict,) = merged([recipe()], [], [recipe(cooldown=5.0)])
    assert not made.enabled
    assert "it is back, switched off" in conflict


def test_what_the_recipe_protects_is_as_the_recipe_says() -> None:
    new = recipe(protected=True)
    assert merged([recipe()], [edited(cooldown=1.0)], [new])[0] == [new]
    made, (conflict,) = merged([recipe()], [], [new])
    assert made == [new]
    assert "it is back" in conflict


def test_rules_of_people_stay_where_they_stood() -> None:
    mine = [recipe("a"), edited("own"), recipe("b")]
    made, conflicts = merged(
        [recipe("a"), recipe("b")], mine, [recipe("new"), recipe("a"), recipe("b")]
    )
    assert [r.id for r in made] == ["new", "a", "own", "b"]
    assert conflicts == []


def test_a_new_order_of_people_stays_if_the_recipe_kept_its_own() -> None:
    made, _ = merged(
        [recipe("a"), recipe("b")],
        [recipe("b"), recipe("a")],
        [recipe("a"), recipe("b"), recipe("c")],
    )
    assert [r.id for r in made] == ["b", "c", "a"]


def test_a_rule_that_the_recipe_dropped_goes_and_edits_of_it_are_named() -> None:
    assert merged([recipe()], [recipe()], []) == ([], [])
    made, (conflict,) = merged([recipe()], [edited(cooldown=1.0)], [])
    assert made == []
    assert "no longer has it; your changes (event.cooldown) are left out" in conflict


def test_a_rule_of_a_person_is_kept_beside_a_new_one_of_the_recipe_with_its_id() -> None:
    made, (conflict,) = merged([], [edited(cooldown=1.0)], [recipe()])
    assert [(r.id, r.enabled) for r in made] == [("stuck", True), ("stuck-edited", False)]
    assert "yours is kept as 'stuck-edited'" in conflict


def test_a_rule_that_needs_a_function_that_is_gone_is_left_out() -> None:
    old = recipe("f", actions=(Python(name="shout"),))
    own = edited("own", actions=(Python(name="shout"),))
    made, conflicts = merged([old], [old, own], [recipe()])
    assert [r.id for r in made] == ["stuck"]
    assert conflicts == ["'own': it needs shout, which the recipe no longer has"]


def test_edits_that_no_longer_fit_are_left_out_and_the_rule_still_stands() -> None:
    pulse: dict[str, Any] = {
        "condition": {"kind": "received", "signal": {"topic": "a", "type": "p/msg/X"}}
    }
    (made,), (conflict,) = merged([recipe()], [edited(hold=2.0)], [recipe(**pulse)])
    assert made == recipe(**pulse)
    assert "no longer fit" in conflict


def test_different_actions_are_named_in_words() -> None:
    _, (conflict,) = merged(
        [recipe()],
        [edited(actions=(Log(text="mine"),))],
        [recipe(actions=(Log(text="theirs"),))],
    )
    assert 'the recipe says log "theirs", you said log "mine"' in conflict


@property_test(tables(), tables(), tables(), many=MANY // 4)
def test_a_merge_always_gives_a_table_and_loses_nothing_silently(
    old: Table, mine: Table, new: Table
) -> None:
    table, _ = merge(old, mine, new)
    ids = {rule.id for rule in table.rules}
    assert {r.id for r in new.rules} - ids <= {r.id for r in old.rules} - {r.id for r in mine.rules}
    assert merge(old, old, new) == (new, [])
    if functions_of(mine) <= functions_of(old):
        assert merge(old, mine, old) == (mine, [])
