"""A text that is no table is refused with where, what and what to do; never with a traceback."""

import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kompass.monitor.tables.table_reader import (
    MAX_BYTES,
    MAX_RULES,
    TableReader,
    Unreadable,
    read_table,
)
from kompass.rulebook.schema.report import Finding
from kompass.rules.schema.conditions import Compare
from kompass.rules.schema.table import Table
from tests.support.rules import compare, rule

GOOD = rule("good", compare("a", ">", 1))


def refused(text: str) -> Unreadable:
    with pytest.raises(Unreadable) as caught:
        read_table(text)
    return caught.value


def test_a_table_is_read() -> None:
    assert [each.id for each in read_table(json.dumps({"rules": [GOOD]})).rules] == ["good"]


@pytest.mark.parametrize(
    ("change", "field", "remedy"),
    [
        ({"actions": [{"kind": "log", "text": 3}]}, "actions[0].text", "correct"),
        ({"evnt": {}}, "evnt", "leave it out"),
        ({"event": {}}, "event.condition", "add it"),
        ({"actions": [{"kind": "lag"}]}, "actions[0]", "one of the kinds"),
        ({"event": {"condition": compare("a", "~", 1)}}, "event.condition.operator", "correct"),
    ],
)
def test_the_rule_and_the_field_are_named(change: dict[str, Any], field: str, remedy: str) -> None:
    found = refused(json.dumps({"rules": [GOOD | {"id": "first"}, GOOD | change]})).findings
    assert ("good", field) in [(each.rule_id, each.field) for each in found]
    assert any(remedy in each.remedy for each in found if each.field == field)


@pytest.mark.parametrize("value", [float("nan"), {"a": 1}, [[1]]])
def test_a_value_that_may_be_of_several_types_is_complained_of_once(value: Any) -> None:
    condition = compare("a", ">", 1) | {"value": value}
    (found,) = refused(json.dumps({"rules": [GOOD | {"event": {"condition": condition}}]})).findings
    assert found.field.startswith("event.condition.value")
    assert ("finite" in found.text) == isinstance(value, float)


def test_two_rules_of_one_id_are_told_where_the_second_is() -> None:
    (found,) = refused(json.dumps({"rules": [GOOD, GOOD]})).findings
    assert (found.field, found.value) == ("rules[1].id", None)
    assert "have the same id 'good'" in found.text
    assert found.remedy == "rename one"


def test_a_rule_that_was_read_before_is_the_same_object_and_others_are_not() -> None:
    reader = TableReader()
    both = [GOOD, rule("other", compare("a", "==", 1))]
    first = reader.read(json.dumps({"rules": both}))
    again = reader.read(json.dumps({"rules": [both[1], GOOD]}))
    assert [again.rules[1] is first.rules[0], again.rules[0] is first.rules[1]] == [True, True]
    # Python takes these for the same.
    for value in (True, 1.0):
        table = reader.read(json.dumps({"rules": [rule("other", compare("a", "==", value))]}))
        made = table.rules[0].event.condition
        assert isinstance(made, Compare)
        assert type(made.value) is type(value)


def test_what_is_wrong_beside_a_rule_that_was_read_before_is_told_as_ever() -> None:
    reader = TableReader()
    reader.read(json.dumps({"rules": [GOOD]}))
    for rules in ([GOOD, GOOD | {"id": "second", "evnt": {}}], [GOOD, GOOD]):
        text = json.dumps({"rules": rules})
        with pytest.raises(Unreadable) as caught:
            reader.read(text)
        assert caught.value.findings == refused(text).findings


def test_what_is_too_large_is_not_even_looked_at() -> None:
    assert refused("[" * (MAX_BYTES + 1)).findings[0].code == "too-large"
    assert refused("[" * MAX_BYTES).findings[0].code == "not-json"
    many = '{"rules": [' + ",".join(["1"] * (MAX_RULES + 1)) + "]}"
    assert refused(many).findings[0].code == "too-many"


def complaints(text: str) -> tuple[Finding, ...]:
    try:
        assert isinstance(read_table(text), Table)
    except Unreadable as error:
        return error.findings
    return ()


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=10),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from([*GOOD, *GOOD["event"], "kind", "rules"]), inner, max_size=4
        )
    ),
    max_leaves=15,
)


@settings(max_examples=40, deadline=None)
@given(data=JSON, key=st.sampled_from(["id", "event", "actions", "severity", "lane"]))
def test_whatever_comes_is_a_table_or_is_refused(data: Any, key: str) -> None:
    for text in (json.dumps(data), json.dumps({"rules": [GOOD | {key: data}]}), str(data)):
        for finding in complaints(text):
            finding.model_dump_json()
            assert finding.text
            assert finding.remedy


HALF = "a\ud800b"  # of a surrogate pair


@pytest.mark.parametrize(
    ("change", "rule_id", "field"),
    [
        ({"id": HALF}, "a?b", "id"),
        ({"name": HALF}, "good", "name"),
        ({"actions": [{"kind": "log", "text": HALF}]}, "good", "actions[0].text"),
        ({"event": {"condition": compare("a", "==", HALF)}}, "good", "event.condition.value"),
        ({HALF: 1}, "good", ""),
    ],
)
def test_half_of_a_character_is_refused_and_can_be_told(
    change: dict[str, Any], rule_id: str, field: str
) -> None:
    for text in (
        json.dumps({"rules": [GOOD | change]}),
        json.dumps({"rules": [GOOD | change]}, ensure_ascii=False),
    ):
        (found,) = refused(text).findings
        assert (found.rule_id, found.field) == (rule_id, field)
        assert found.value == "a?b"
        found.model_dump_json().encode()


def test_a_character_beyond_the_first_65536_is_a_character() -> None:
    for ascii_only in (True, False):
        text = json.dumps({"rules": [GOOD | {"name": "😀"}]}, ensure_ascii=ascii_only)
        assert read_table(text).rules[0].name == "😀"
