"""Whose rights a rule has is worked out, and never taken from who hands it in."""

from typing import Any

import pytest

from kompass.rulebook.sources import with_sources
from kompass.rules.schema.actions import Log
from kompass.rules.schema.table import Rule, Table
from tests.rules.building import compare, rule


def made(text: str = "!", **fields: Any) -> Rule:
    return rule(compare("a", "<", 1), "r", actions=(Log(text=text),), **fields)


def source(after: Rule, role: str, *before: Rule, recipe: tuple[Rule, ...] = ()) -> str:
    known = [Table(rules=(one,)) for one in before]
    (found,) = with_sources(Table(rules=(after,)), Table(rules=recipe), role, known).rules
    return found.source


@pytest.mark.parametrize("claimed", ["recipe", "engineer", "edited"])
def test_what_a_rule_says_of_itself_is_not_believed(claimed: str) -> None:
    assert source(made(source=claimed), "operator") == "edited"
    assert source(made(source=claimed), "engineer") == "engineer"
    assert source(made(source=claimed), "operator", recipe=(made(),)) == "recipe"


def test_the_weakest_who_had_a_hand_in_it_counts() -> None:
    by_engineer, by_operator = made(source="engineer"), made(source="edited")
    assert source(made("other"), "operator", by_engineer) == "edited"
    assert source(made("other"), "engineer", by_operator) == "edited"
    assert source(made("other"), "engineer", by_engineer) == "engineer"


@pytest.mark.parametrize("role", ["operator", "engineer"])
@pytest.mark.parametrize("had", ["engineer", "edited"])
@pytest.mark.parametrize(
    "change",
    [{}, {"enabled": False}, {"shadow": True}, {"protected": True}, {"name": "n", "note": "?"}],
)
def test_who_only_switches_or_names_a_rule_has_no_hand_in_it(
    role: str, had: str, change: dict[str, Any]
) -> None:
    assert source(made(**change), role, made(source=had)) == had


def test_a_rule_that_an_older_recipe_had_is_of_who_brings_it_back() -> None:
    assert source(made(), "operator", made(source="recipe")) == "edited"
    assert source(made(), "engineer", made(source="recipe")) == "engineer"


def test_the_first_table_that_knows_a_rule_counts() -> None:
    assert source(made(), "operator", made(source="engineer"), made(source="edited")) == "engineer"
