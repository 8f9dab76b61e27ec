"""Rules that do not fit the messages are refused when they are made, with the remedy."""

from collections.abc import Iterable
from typing import Any

import pytest

from kompass.rules.checks.catalog import FieldType
from kompass.rules.checks.check import check_rule, check_table
from kompass.rules.schema.actions import CallService, Publish, Python, SendGoal
from kompass.rules.schema.conditions import Compare, Rate
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Table
from tests.rules.building import both, received, rule

FLOAT, INT, BOOL, TEXT = (FieldType(k) for k in ("float", "int", "bool", "text"))


def of(element: FieldType) -> FieldType:
    return FieldType("list", element=element)


def message(name: str) -> FieldType:
    return FieldType("message", name)


TYPES: dict[str, dict[str, FieldType]] = {
    "p/msg/Scan": {"ranges": of(FLOAT), "range_max": FLOAT, "frame": TEXT},
    "p/msg/Exact": {
        "byte": FieldType("int", primitive="octet"),
        "whole": FieldType("int", primitive="int32"),
        "bytes": of(FieldType("int", primitive="uint8")),
        "three": FieldType("list", element=FieldType("int", primitive="uint8"), size=3),
        "real": FieldType("float", primitive="float"),
    },
    "p/msg/Status": {"status": INT, "ok": BOOL, "sources": of(TEXT)},
    "p/msg/Pose": {"x": FLOAT, "y": FLOAT},
    "p/msg/Path": {"poses": of(message("p/msg/Pose")), "start": message("p/msg/Pose")},
    "p/srv/Load_Request": {"url": TEXT},
    "p/action/Go_Goal": {"pose": message("p/msg/Pose")},
}


class Definitions:
    """A catalog over a few types."""

    def fields(self, type_name: str) -> Iterable[str]:
        return TYPES.get(type_name, {})

    def field_type(self, type_name: str, path: tuple[str | int, ...]) -> FieldType | None:
        found = message(type_name) if type_name in TYPES else None
        for step in path:
            if found is None:
                return None
            if isinstance(step, int):
                found = found.element
            else:
                found = TYPES.get(found.name, {}).get(step) if found.kind == "message" else None
        return found


def problems(type_name: str, path: tuple[Any, ...], operator: Any, value: Any, **more: Any) -> str:
    signal = Signal(topic="t", type=type_name, path=path, **more)
    condition = Compare(signal=signal, operator=operator, value=value)
    return "\n".join(map(str, check_rule(rule(condition), Definitions())))


@pytest.mark.parametrize(
    ("type_name", "path", "operator", "value"),
    [
        ("p/msg/Scan", ("range_max",), "<", 1),
        ("p/msg/Scan", ("ranges", 0), "<", 0.5),
        ("p/msg/Status", ("status",), "==", 1.0),
        ("p/msg/Status", ("status",), "between", (0.5, 2)),
        ("p/msg/Status", ("status",), "in", (1, 2)),
        ("p/msg/Status", ("ok",), "==", True),
        ("p/msg/Status", ("sources",), "contains_any", ("scan",)),
        ("p/msg/Status", ("sources",), "==", ("scan",)),
        ("p/msg/Scan", ("frame",), "contains", "LDS"),
        ("p/msg/Path", ("poses", 0, "x"), ">", 1),
        ("p/msg/Exact", ("byte",), "==", 255),
        ("p/msg/Exact", ("byte",), "<", 300),
        ("p/msg/Exact", ("byte",), "!=", 300),
        ("p/msg/Exact", ("whole",), "==", 10.0),
        ("p/msg/Exact", ("whole",), ">", 10.5),
        ("p/msg/Exact", ("whole",), "between", (-0.5, 2**40)),
        ("p/msg/Exact", ("bytes",), "not_contains", 300),
        ("p/msg/Exact", ("three",), "==", (1, 2, 3)),
        ("p/msg/Exact", ("real",), "==", 10.5),
    ],
)
def test_what_fits_is_accepted_and_whole_numbers_are_numbers(
    type_name: str, path: tuple[Any, ...], operator: str, value: Any
) -> None:
    assert problems(type_name, path, operator, value) == ""


@pytest.mark.parametrize(
    ("type_name", "path", "operator", "value", "complaint"),
    [
        ("p/msg/Skan", (), "==", 1, "no such message type"),
        ("p/msg/Scan", ("range_mx",), "<", 1, "no field 'range_mx'; did you mean 'range_max'?"),
        ("p/msg/Scan", ("zzz",), "<", 1, "known are: frame, range_max, ranges"),
        ("p/msg/Path", ("poses", "x"), "<", 1, "'poses' is a list; choose an item"),
        ("p/msg/Path", ("start", "z"), "<", 1, "'start' has no field 'z'"),
        ("p/msg/Path", ("start", 0), "<", 1, "which has no items; leave the index out"),
        ("p/msg/Scan", ("frame", "x"), "==", 1, "which has no fields; end the path at 'frame'"),
        ("p/msg/Status", ("ok",), "==", 1, "'ok' is a bool; give a bool"),
        ("p/msg/Status", ("status",), "==", True, "'status' is an integer; give an integer"),
        ("p/msg/Status", ("status",), "==", "1", "give an integer"),
        ("p/msg/Status", ("ok",), ">", 0, "use '== true'"),
        ("p/msg/Scan", ("ranges",), "<", 0.3, "use an index or an aggregate"),
        ("p/msg/Path", ("start",), "==", 1, "compare one of its fields"),
        ("p/msg/Status", ("status",), "contains", 1, "use '==' or 'in'"),
        ("p/msg/Status", ("sources",), "contains", 1, "holds a text; give a text"),
        ("p/msg/Status", ("sources",), "==", "scan", "give a list"),
        ("p/msg/Status", ("status",), "in", (1, "2"), "= '2'"),
        ("p/msg/Status", ("ok",), "between", (0, 1), "use '== true'"),
        ("p/msg/Scan", ("ranges",), "between", (0, 1), "use an index or an aggregate"),
        ("p/msg/Scan", ("frame",), "between", (0, 1), "'frame' is a text; use '==' or 'in'"),
    ],
)
def test_what_does_not_fit_is_named_with_its_remedy(
    type_name: str, path: tuple[Any, ...], operator: str, value: Any, complaint: str
) -> None:
    text = problems(type_name, path, operator, value)
    assert text.startswith("rule 'r': event.condition")
    assert complaint in text


@pytest.mark.parametrize(
    ("path", "operator", "value", "complaint"),
    [
        (("byte",), "==", 300, "value = 300: 'byte' is an integer (byte: 0 to 255): this is never"),
        (("byte",), "==", -1, "give a whole number from 0 to 255"),
        (("byte",), "in", (1, 300), "value = 300: 'byte' is an integer (byte: 0 to 255)"),
        (("whole",), "==", 2**40, "(int32: -2147483648 to 2147483647): this is never true"),
        (("whole",), "==", 10.5, "value = 10.5: 'whole' is an integer (int32: "),
        (("whole",), "in", (1, 2.5), "value = 2.5"),
        (("bytes",), "contains", 256, "value = 256: 'bytes' is an integer (uint8: 0 to 255)"),
        (("bytes", 0), "==", 256, "give a whole number from 0 to 255"),
        (("three",), "==", (1, 2), "value = 2: 'three' is a list of exactly 3 uint8: this is nev"),
        (("real",), "==", 1e39, "this is never true; give a number from -3.4028235e38 to"),
    ],
)
def test_what_a_field_never_holds_is_not_looked_for(
    path: tuple[Any, ...], operator: str, value: Any, complaint: str
) -> None:
    assert complaint in problems("p/msg/Exact", path, operator, value)


def test_a_tolerance_makes_a_fraction_reachable() -> None:
    signal = Signal(topic="t", type="p/msg/Exact", path=("whole",))
    near = Compare(signal=signal, operator="==", value=10.5, tolerance=0.6)
    assert check_rule(rule(near), Definitions()) == []


def test_aggregates_are_of_lists_of_numbers() -> None:
    assert problems("p/msg/Scan", ("ranges",), "<", 0.3, aggregate="min") == ""
    assert problems("p/msg/Path", ("poses",), ">", 5, aggregate="len") == ""
    assert problems("p/msg/Scan", ("ranges",), "==", True, aggregate="any") == ""
    assert "leave it out" in problems("p/msg/Scan", ("range_max",), "<", 1, aggregate="min")
    assert "leave it out" in problems("p/msg/Path", ("poses",), "<", 1, aggregate="min")


def test_a_problem_names_the_place_in_the_tree() -> None:
    good = Signal(topic="t", type="p/msg/Scan", path=("range_max",))
    bad = Signal(topic="t", type="p/msg/Scan", path=("nope",))
    tree = both(
        Compare(signal=good, operator="<", value=1), Compare(signal=bad, operator="<", value=1)
    )
    (problem,) = check_rule(rule(tree), Definitions())
    assert problem.field == "event.condition.conditions[1].signal.path"
    assert problem.value == "nope"


def test_all_rules_are_checked_disabled_ones_and_clear_conditions_too() -> None:
    bad = Compare(
        signal=Signal(topic="t", type="p/msg/Scan", path=("nope",)), operator="<", value=1
    )
    good = Compare(
        signal=Signal(topic="t", type="p/msg/Scan", path=("range_max",)), operator="<", value=1
    )
    table = Table(rules=(rule(bad, "off", enabled=False), rule(good, "clears", clear=bad)))
    found = check_table(table, Definitions())
    assert [(p.rule_id, p.field.split(".")[1]) for p in found] == [
        ("off", "condition"),
        ("clears", "clear"),
    ]


def test_the_type_of_a_rate_is_checked_if_it_is_given() -> None:
    assert check_rule(rule(Rate(topic="t", below=1.0)), Definitions()) == []
    (problem,) = check_rule(rule(Rate(topic="t", type="p/msg/X", below=1.0)), Definitions())
    assert problem.field == "event.condition.type"


@pytest.mark.parametrize(
    ("action", "complaint"),
    [
        (Python(name="f", kwargs={"x": "$msg.rnages[0]"}), "did you mean 'ranges'?"),
        (Python(name="f", kwargs={"x": "$topic[/t].nope"}), "in a message of /t"),
        (Publish(topic="o", type="p/msg/Pose", message={"z": 1}), "has no field 'z'"),
        (Publish(topic="o", type="p/msg/Path", message={"start.q": 1}), "'start' has no field"),
        (Publish(topic="o", type="p/msg/Path", message={"start": {"q": 1}}), "has no field 'q'"),
        (CallService(service="s", type="p/srv/Load", request={"uri": "x"}), "mean 'url'?"),
        (CallService(service="s", type="p/srv/Save", request={}), "no such message type"),
        (SendGoal(action="a", type="p/action/Go", goal={"pose.x": 1, "pos": 1}), "mean 'pose'?"),
    ],
)
def test_arguments_are_checked_against_the_messages_they_come_from_and_go_to(
    action: Any, complaint: str
) -> None:
    scan = received("t").model_copy(update={"signal": Signal(topic="t", type="p/msg/Scan")})
    (problem,) = check_rule(rule(scan, actions=(action,)), Definitions())
    assert problem.field.startswith("actions[0]")
    assert complaint in str(problem)
