"""What is known of a rule holds for that rule, for as long as it lives, and for no other."""

import gc
from typing import Any

from kompass.rules.schema.identity_cache import IdentityCache
from kompass.rules.schema.interned import interned, interned_table, read_rule, table_text, text_of
from kompass.rules.schema.table import Rule, Table, rule_hash
from tests.rules.building import compare, received, rule


def test_an_answer_is_worked_out_once_and_forgotten_with_its_object() -> None:
    asked: list[str] = []

    def work(item: Rule) -> str:
        asked.append(item.id)
        return item.id.upper()

    cache = IdentityCache[Rule, str](work)
    one, twin = rule(received("a"), "one"), rule(received("a"), "one")
    assert [cache(one), cache(one), cache(twin)] == ["ONE"] * 3
    assert asked == ["one", "one"]
    assert len(cache) == 2
    del one, twin
    gc.collect()
    assert len(cache) == 0


def test_a_copy_with_another_field_has_a_hash_and_a_text_of_its_own() -> None:
    old = rule(received("a"))
    known = rule_hash(old), text_of(old)
    new = old.model_copy(update={"enabled": False})
    assert rule_hash(new) != known[0]
    assert text_of(new) != known[1]
    assert (rule_hash(old), text_of(old)) == known


def test_rules_of_the_same_content_are_one_and_others_are_not() -> None:
    def of(value: Any, **more: Any) -> Rule:
        return rule(compare("a", "==", value), **more)

    first = interned(of(1))
    assert interned(of(1)) is first
    assert read_rule(first.model_dump_json()) is first
    # Python takes these for equal; and a name changes no hash.
    for other in (of(True), of(1.0), of(1, name="One"), of(1, source="recipe")):
        assert interned(other) is not first


def test_a_table_of_living_rules_is_the_same_table() -> None:
    table = Table(rules=(rule(received("a"), "a"), rule(compare("b", "<", 0.1 + 0.2), "b")))
    again = interned_table(Table.model_validate_json(interned_table(table).model_dump_json()))
    assert again == table
    assert all(a is b for a, b in zip(again.rules, table.rules, strict=True))
    assert table_text(table) == table.model_dump_json()
    assert table_text(Table()) == Table().model_dump_json()
