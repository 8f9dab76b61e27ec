"""What differs between two tables, in words and in fields; and what two people changed at once."""

from typing import Any

import pytest

from kompass.rulebook.diff import conflict, diff_tables, field_changes
from kompass.rulebook.schema.diff_models import FieldChange, RuleChange
from kompass.rules.schema.actions import Lifecycle, Log, Publish
from kompass.rules.schema.events import MaxRate, Queued
from kompass.rules.schema.table import Rule, Table, rule_hash
from tests.rules.building import FLOAT, both, compare, rule
from tests.rules.strategies import tables
from tests.support.properties import MANY, property_test


def own(rule_id: str = "r", **fields: Any) -> Rule:
    return rule(fields.pop("condition", compare("a", "<", 1)), rule_id, **fields)


def diff(before: list[Rule], after: list[Rule]) -> list[RuleChange]:
    return list(diff_tables(Table(rules=tuple(before)), Table(rules=tuple(after))).changes)


@pytest.mark.parametrize(
    ("before", "after", "summary", "fields"),
    [
        ({"cooldown": 60.0}, {"cooldown": 20.0}, "cooldown 60 s → 20 s", ["event.cooldown"]),
        ({}, {"enabled": False}, "switched off", ["enabled"]),
        ({"enabled": False}, {}, "switched on", ["enabled"]),
        ({}, {"shadow": True}, "in shadow: evaluated, does not act", ["shadow"]),
        ({"protected": True}, {}, "no longer protected", ["protected"]),
        ({}, {"name": "stuck"}, 'name "" → "stuck"', ["name"]),
        ({}, {"note": "why"}, "note changed", ["note"]),
        ({}, {"severity": "error"}, "severity warning → error", ["severity"]),
        ({}, {"lane": "safety"}, "lane normal → safety", ["lane"]),
        (
            {},
            {"condition": compare("a", "<", 2)},
            "when a.x < 1 → a.x < 2",
            ["event.condition.value"],
        ),
        (
            {},
            {"condition": compare("a", "<", 1, timeout=3.0)},
            "details of the condition",
            ["event.condition.signal.timeout"],
        ),
        (
            {},
            {"condition": both(compare("a", "<", 1), compare("b", "<", 1))},
            "when a.x < 1 → a.x < 1 and b.x < 1",
            ["event.condition"],
        ),
        ({}, {"trigger": "edge", "hold": 2.0}, "trigger level → edge; hold 0 s → 2 s", None),
        ({}, {"clear": compare("a", ">", 2)}, "clears when none → a.x > 2", ["event.clear"]),
        ({}, {"once": True}, "once only", ["event.once"]),
        (
            {},
            {"mode": Queued(size=3)},
            "while running: drop what comes → let wait (up to 3)",
            ["event.mode"],
        ),
        (
            {"max_rate": MaxRate(count=3, window=60.0)},
            {},
            "limit 3 in 60 s → none",
            ["event.max_rate"],
        ),
        (
            {},
            {"first_true_is_edge": False},
            "true from the start does not count as becoming true",
            ["event.first_true_is_edge"],
        ),
        (
            {},
            {"actions": (Log(text="!"), Lifecycle(component="c", action="stop"))},
            "then also stop c",
            ["actions[1]"],
        ),
        ({}, {"actions": (Log(text="?"),)}, 'then log "!" → log "?"', ["actions[0].text"]),
        (
            {},
            {"actions": (Log(text="!", timeout=1.0),)},
            "details of the actions",
            ["actions[0].timeout"],
        ),
        (
            {"actions": (Log(text="!"), Lifecycle(component="c", action="stop"))},
            {},
            "no longer stop c",
            ["actions[1]"],
        ),
    ],
)
def test_a_change_is_said_in_words_and_in_fields(
    before: dict[str, Any], after: dict[str, Any], summary: str, fields: list[str] | None
) -> None:
    (change,) = diff([own(**before)], [own(**after)])
    assert (change.kind, change.summary) == ("changed", summary)
    assert fields is None or [field.field for field in change.fields] == fields
    assert change.semantic is (summary.split()[0] not in ("name", "note"))


def test_values_before_and_after_are_in_the_fields() -> None:
    (change,) = diff([own(cooldown=60.0)], [own(cooldown=20.0)])
    assert change.fields == (FieldChange(field="event.cooldown", before=60.0, after=20.0),)


def test_an_action_put_in_front_does_not_change_those_behind_it() -> None:
    behind = (Log(text="one"), Publish(topic="t", type=FLOAT, message={"data": 1.0}))
    first = Log(text="first")
    (change,) = diff([own(actions=behind)], [own(actions=(first, *behind))])
    assert [f.field for f in change.fields] == ["actions[0]"]
    assert (change.fields[0].before, change.summary) == (None, 'then also log "first"')


def test_new_and_removed_rules_are_told_whole() -> None:
    (removed,), (added,) = diff([own(hold=2.0)], []), diff([], [own(hold=2.0)])
    assert (removed.kind, added.kind) == ("removed", "added")
    assert added.summary == 'new: when a.x < 1 for 2 s, then log "!"'
    assert removed.semantic
    assert added.semantic


def test_only_what_was_moved_is_said_to_have_moved() -> None:
    rules = [own(name) for name in "abcde"]
    a, b, c, d, e = rules
    (moved,) = diff(rules, [b, c, d, a, e])
    assert (moved.rule_id, moved.kind, moved.semantic) == ("a", "moved", False)
    assert moved.summary == "place 1 → 4"
    assert diff(rules, [own("new"), *rules])[0].kind == "added"
    assert len(diff(rules, [own("new"), *rules])) == 1
    (both_ways,) = diff([a, b], [own("b", cooldown=1.0), a])
    assert (both_ways.kind, both_ways.summary) == ("changed", "cooldown 0 s → 1 s; place 2 → 1")


def test_where_a_rule_comes_from_is_no_difference() -> None:
    assert diff([own(source="recipe")], [own(source="edited")]) == []


@property_test(tables(), tables(), many=MANY // 2)
def test_a_diff_is_empty_exactly_for_what_is_the_same(one: Table, other: Table) -> None:
    assert diff_tables(one, one).changes == ()
    changes = {c.rule_id: c for c in diff_tables(one, other).changes}
    before, after = ({r.id: r for r in t.rules} for t in (one, other))
    for rule_id in {*before, *after}:
        a, b = before.get(rule_id), after.get(rule_id)
        if a == b:
            assert rule_id not in changes
        elif a is not None and b is not None:
            change = changes[rule_id]
            assert change.summary
            assert change.semantic is (rule_hash(a) != rule_hash(b))
            assert change.fields == field_changes(a, b)
    back = {c.rule_id: c.kind for c in diff_tables(other, one).changes}
    swapped = {"added": "removed", "removed": "added"}
    assert back == {i: swapped.get(c.kind, c.kind) for i, c in changes.items()}


def test_a_conflict_tells_what_each_changed_and_what_both_did() -> None:
    base = [own("a"), own("b"), own("c")]
    theirs = [own("a", cooldown=1.0), own("b", cooldown=1.0), own("c")]
    yours = [own("c"), own("a"), own("b", cooldown=2.0)]
    found = conflict(
        *(Table(rules=tuple(rules)) for rules in (base, theirs, yours)),
        expected=4,
        revision=5,
        author="ava",
        time=1.0,
        reason="too often",
    )
    assert [c.rule_id for c in found.theirs.changes] == ["a", "b"]
    assert {c.rule_id for c in found.yours.changes} == {"b", "c"}
    assert found.both == ("b",)
    assert (found.theirs.before, found.theirs.after, found.yours.after) == (4, 5, None)
