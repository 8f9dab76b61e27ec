"""What a shell learns from a compiled table."""

from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.schema.actions import Method
from kompass.rules.schema.conditions import CallableCondition
from kompass.rules.schema.table import Table, table_hash
from tests.rules.building import FLOAT, Robot, absent, both, received, rule, slower


def test_the_topics_to_subscribe_to_are_told_with_their_types() -> None:
    action = Method(component="c", method="m", kwargs={"pose": "$topic[/odom].pose"})
    condition = both(
        received("/a"), absent("b", 1.0), slower("c", 5.0), CallableCondition(name="f")
    )
    table = compile_table(Table(rules=(rule(condition, actions=(action,), clear=received("d")),)))
    assert table.topic_types() == {
        "a": {FLOAT},
        "b": {FLOAT},
        "c": set(),  # a rate needs no type, and an argument tells none: look at the graph
        "d": {FLOAT},
        "odom": set(),
    }


def test_a_compiled_table_knows_its_revision() -> None:
    table = Table(rules=(rule(received("a")),))
    assert compile_table(table).hash == table_hash(table)


def test_a_firing_knows_the_revision_of_its_rule() -> None:
    robot = Robot(rule(received("a")))
    robot.say("a")
    robot.swap(rule(received("a"), cooldown=1.0))
    robot.say("a")
    first, second = (f.revision_hash for f in robot.firings)
    assert first != second == robot.table.by_id["r"].hash


def test_the_topics_of_disabled_rules_are_listened_to_so_that_they_can_be_explained() -> None:
    table = compile_table(Table(rules=(rule(received("a"), enabled=False),)))
    assert set(table.topic_types()) == {"a"}
