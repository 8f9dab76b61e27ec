"""What is exported gives the same rules again: as JSON, as YAML, and as a part of a recipe."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import strategies as st

from kompass.components import Controller, DriveManager
from kompass.recipe.export import export, to_json, to_python
from kompass.recipe.table import RecipeRules, recipe_rules
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.firing import Firing, RunEnded, Sample
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.actions import (
    Action,
    CallService,
    CancelGoal,
    Lifecycle,
    Log,
    Method,
    Publish,
    Python,
    RaiseAlarm,
    Reconfigure,
    SendGoal,
    UpdateParameters,
)
from kompass.rules.schema.conditions import (
    Absent,
    AllOf,
    AnyOf,
    CallableCondition,
    Changed,
    Compare,
    Condition,
    Not,
    Rate,
    Received,
)
from kompass.rules.schema.events import Event, MaxRate, Parallel, Queued, Restart
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Severity, Table, rule_hash
from tests.ros.test_seeds import DOCUMENTS, SEEDS, recipe_of
from tests.support.properties import MANY, property_test

RECIPES = sorted((Path(__file__).parents[2] / "recipes").glob("0*.py"))


class Bringup(Exception):
    """The recipe is read; its stack is not started."""


def read_recipe(source: str, monkeypatch: pytest.MonkeyPatch) -> tuple[RecipeRules, dict[str, Any]]:
    """The rules of a recipe, and the names that it defines."""
    rules = RecipeRules()
    by_name: dict[str, Any] = {}

    def begin(events_actions: Any, components: Any) -> RecipeRules:
        nonlocal rules
        rules = recipe_rules(events_actions, components)
        by_name.update({component.node_name: component for component in components})
        raise Bringup

    monkeypatch.setattr("kompass.launch.launcher.recipe_rules", begin)
    scope: dict[str, Any] = {"__name__": "__main__", "__file__": "recipe.py"}
    with pytest.raises(Bringup):
        exec(compile(source, "recipe.py", "exec"), scope)
    return rules, {**by_name, **{k: v for k, v in scope.items() if callable(v)}}


def read_fragment(table: Table, scope: dict[str, Any], components: Any) -> Table:
    names = dict(scope)
    text = to_python(table, title="a test")
    exec(compile(text, "fragment.py", "exec"), names)
    return recipe_rules(names["events_actions"], components).table


def hashes(table: Table) -> list[tuple[str, str]]:
    return [(rule.id, rule_hash(rule)) for rule in table.rules]


def fires(table: Table, stream: list[tuple[float, str, Any]]) -> list[tuple[str, float]]:
    compiled = compile_table(table)
    state, now, found = initial_state(compiled, 0.0), 0.0, []
    for gap, topic, message in stream:
        now += gap
        _, out = step(compiled, state, Sample(topic, message), now)
        for firing in out:
            if isinstance(firing, Firing):
                found.append((firing.rule_id, firing.at))
                step(compiled, state, RunEnded(firing.rule_id, firing.run_id), now)
    return found


def sources() -> Iterator[Any]:
    yield from (pytest.param(path, id=path.stem) for path in RECIPES)
    yield from (pytest.param(DOCUMENTS / name, id=key) for key, name in SEEDS.items())


@pytest.mark.parametrize("path", list(sources()))
def test_a_recipe_goes_through_json_and_python_and_fires_as_before(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not path.is_file():
        pytest.skip(f"the document {path.name} is not beside the checkout")
    text = path.read_text()
    rules, scope = read_recipe(recipe_of(text) if path.suffix == ".txt" else text, monkeypatch)
    table = Table.model_validate_json(to_json(rules.table))
    components = [c for c in scope.values() if hasattr(c, "node_name")]
    again = read_fragment(table, scope, components)
    assert hashes(again) == hashes(rules.table)
    stream = _stream(rules.table)
    assert fires(again, stream) == fires(rules.table, stream)


def _stream(table: Table) -> list[tuple[float, str, Any]]:
    """Messages with every status in turn, on all that the table listens to."""
    from kompass.message_types import ros_class

    made: list[tuple[float, str, Any]] = []
    for turn in range(40):
        for topic, kinds in compile_table(table).topic_types().items():
            message = ros_class(min(kinds))()
            if hasattr(message, "status"):
                message.status = turn // 5 % 4
            made.append((0.21, topic, message))
    return made


# -- any table ------------------------------------------------------------------------------------

FLOAT, STATUS = "std_msgs/msg/Float64", "automatika_ros_sugar/msg/ComponentStatus"
SCAN = "sensor_msgs/msg/LaserScan"
topics = st.sampled_from(("level", "log", "controller", "ns/level"))
timeouts = st.sampled_from((1.0, None, 2.5))


def signal(kind: str, *path: str | int, **more: Any) -> st.SearchStrategy[Signal]:
    return st.builds(
        Signal, topic=topics, type=st.just(kind), path=st.just(path), timeout=timeouts, **more
    )


level = signal(FLOAT, "data")
leaf: st.SearchStrategy[Condition] = st.one_of(
    st.builds(
        Compare,
        signal=level,
        operator=st.sampled_from(("<", ">=", "==", "!=")),
        value=st.sampled_from((0.3, 1, -2)),
    ),
    st.builds(
        Compare,
        signal=signal(SCAN, "ranges", aggregate=st.just("min")),
        operator=st.just("<"),
        value=st.just(0.3),
    ),
    st.builds(
        Compare, signal=level, operator=st.just("=="), value=st.just(1), tolerance=st.just(0.5)
    ),
    st.builds(Compare, signal=level, operator=st.just("in"), value=st.just((1.0, 2.0))),
    st.builds(Compare, signal=level, operator=st.just("between"), value=st.just((1.0, 2.0))),
    st.builds(
        Compare,
        signal=signal(STATUS, "src_topics"),
        operator=st.sampled_from(("contains", "contains_any", "not_contains_all")),
        value=st.just(("scan", "o'clock")),
    ),
    st.builds(Absent, signal=level, seconds=st.just(2.0)),
    st.builds(Rate, topic=topics, below=st.just(5.0)),
    st.builds(CallableCondition, name=st.sampled_from(("is_low", "is low")), rate=st.just(5.0)),
)
pulse = st.one_of(
    st.builds(Received, signal=signal(FLOAT)),
    st.builds(Received, signal=level),
    st.builds(Changed, signal=level),
)
tree: st.SearchStrategy[Condition] = st.recursive(
    leaf,
    lambda inner: st.one_of(
        st.builds(Not, condition=inner),
        st.builds(AllOf, conditions=st.lists(inner, min_size=1, max_size=3).map(tuple)),
        st.builds(AnyOf, conditions=st.lists(inner, min_size=2, max_size=2).map(tuple)),
    ),
    max_leaves=4,
)
ACTIONS: tuple[Action, ...] = (
    Log(text='say "hello" o\'clock'),
    Log(text="loud", level="error"),
    Method(component="drive_manager", method="move_to_unblock", timeout=120.0),
    Method(component="drive_manager", method="move_to_unblock", timeout=5.0, on_error="continue"),
    Method(
        component="drive_manager",
        method="move_to_unblock",
        kwargs={"max_rotation": 1.0},
        timeout=120.0,
    ),
    Method(component="controller", method="restart", timeout=120.0),
    Lifecycle(component="controller", action="restart", timeout=30.0),
    Lifecycle(component="controller", action="stop"),
    UpdateParameters(component="controller", parameters={"loop_rate": 5.0}),
    UpdateParameters(
        component="controller", parameters={"loop_rate": 5.0, "use_direct_sensor": True}
    ),
    UpdateParameters(component="controller", parameters={"loop_rate": "$msg.data"}),
    Reconfigure(component="controller", config={"loop_rate": 5.0}),
    Publish(topic="level", type=FLOAT, message={"data": "$msg.data"}, rate=2.0, period=1.0),
    CallService(service="clear", type="std_srvs/srv/Empty"),
    SendGoal(action="go", type="p/action/Go", goal={"pose": {"x": 1.0}}, timeout=None),
    CancelGoal(action="go"),
    RaiseAlarm(alarm="stuck", text="look at it"),
    Python(name="shout", kwargs={"loud": True}),
    Python(name="send_goal go from goal_of"),
)


@st.composite
def rules(draw: st.DrawFn, rule_id: str) -> Rule:
    steady = draw(st.booleans())
    event: dict[str, Any] = {"condition": draw(tree if steady else st.one_of(pulse, tree))}
    if steady:
        event["hold"] = draw(st.sampled_from((0.0, 2.0)))
        event["trigger"] = draw(st.sampled_from(("level", "edge")))
    event["clear"] = draw(st.one_of(st.none(), tree))
    event["cooldown"] = draw(st.sampled_from((0.0, 30.0)))
    event["once"] = draw(st.booleans())
    event["mode"] = draw(
        st.sampled_from(({"kind": "single"}, Queued(size=3), Restart(), Parallel()))
    )
    event["max_rate"] = draw(st.sampled_from((None, MaxRate(count=3, window=10.0))))
    event["first_true_is_edge"] = draw(st.booleans())
    return Rule(
        id=rule_id,
        name=draw(st.sampled_from(("", "it's", 'a "name"', "line\nbreak"))),
        enabled=draw(st.booleans()),
        shadow=draw(st.booleans()),
        protected=draw(st.booleans()),
        severity=draw(st.sampled_from(Severity)),
        lane=draw(st.sampled_from(("normal", "safety"))),
        note=draw(st.sampled_from(("", "why\nnot"))),
        event=Event.model_validate(event),
        actions=tuple(draw(st.lists(st.sampled_from(ACTIONS), min_size=1, max_size=2))),
    )


COMPONENTS = [Controller(component_name="controller"), DriveManager(component_name="drive_manager")]


def is_low() -> bool:
    return True


@property_test(st.tuples(rules("one"), rules("two")), many=MANY // 2)
def test_any_table_is_the_same_again(pair: tuple[Rule, Rule]) -> None:
    table = Table(rules=pair)
    scope: dict[str, Any] = {c.node_name: c for c in COMPONENTS}
    again = read_fragment(table, {**scope, "is_low": is_low}, COMPONENTS)
    assert hashes(again) == hashes(table)
    assert [(r.name, r.note) for r in again.rules] == [(r.name, r.note) for r in table.rules]
    assert Table.model_validate_json(export(table, "json")) == table
    assert Table.model_validate(yaml.safe_load(export(table, "yaml"))) == table


def test_the_text_reads_as_a_person_would_have_written_it() -> None:
    field = Signal(topic="controller/status", type=STATUS, path=("status",), timeout=None)
    table = Table(
        rules=(
            Rule(
                id="stuck",
                name="Controller stuck → unblock",
                event=Event(
                    condition=Compare(signal=field, operator="==", value=1), cooldown=60.0, hold=2.0
                ),
                actions=(ACTIONS[0], ACTIONS[2]),
            ),
        )
    )
    text = to_python(table, title="the robot")
    assert text.startswith("# Rules of the robot, as a recipe declares them.\n")
    assert (
        "    Event(controller_status.msg.status == 1, keep_event_delay=60.0)"
        ".as_rule('stuck', name='Controller stuck → unblock', hold=2.0): [\n" in text
    )
    assert "        Action(drive_manager.move_to_unblock),\n" in text
    assert re.search(r"^# Components of the recipe: drive_manager$", text, re.M)
    assert "kompass.rules" not in text


def test_a_band_is_written_as_recipes_write_it() -> None:
    signal = Signal(topic="level", type=FLOAT, path=("data",))
    condition = Not(condition=Compare(signal=signal, operator="between", value=(0.2, 0.4)))
    table = Table(rules=(Rule(id="r", event=Event(condition=condition), actions=ACTIONS[:1]),))
    text = to_python(table)
    assert "Event(~(level.msg.data.between(0.2, 0.4)))" in text
    assert "Expression" not in text


def test_functions_of_the_recipe_are_named_for_whoever_pastes_it() -> None:
    condition = CallableCondition(name="is_low", rate=5.0)
    table = Table(
        rules=(Rule(id="r", event=Event(condition=condition), actions=(Python(name="shout"),)),)
    )
    text = to_python(table)
    assert "# Functions of the recipe, which must stand above: is_low, shout\n" in text
    assert "Event(is_low, check_rate=5.0)" in text


def test_the_text_imports_what_rules_are_made_of_from_one_place_that_stays() -> None:
    signal = Signal(topic="level", type=FLOAT, path=("data",))
    condition = AllOf(conditions=(Absent(signal=signal, seconds=2.0), Rate(topic="a", below=5.0)))
    event = Event(condition=condition, mode=Queued(size=3), max_rate=MaxRate(count=3, window=10.0))
    table = Table(rules=(Rule(id="r", event=event, actions=(RaiseAlarm(alarm="quiet"),)),))
    imports = [line for line in to_python(table).splitlines() if line.startswith("from ")]
    assert imports == [
        "from kompass.expressions import Expression",
        "from kompass.ros import Action, Event",
        "from kompass.rules import actions as data",
        "from kompass.rules.schema import Absent, MaxRate, Queued, Rate, Signal",
    ]


def test_an_unknown_format_is_refused() -> None:
    with pytest.raises(ValueError, match="'xml' is not known; known are: json, yaml, python"):
        export(Table(), "xml")  # type: ignore[arg-type]
