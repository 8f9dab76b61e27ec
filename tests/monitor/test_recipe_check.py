"""A recipe whose rules do not fit the robot is refused, with where and what to do."""

from typing import Any

import pytest

from kompass.components import Component
from kompass.components.base.actions import component_action
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.introspection.message_types import MessageTypes, constants
from kompass.monitor.tables.recipe_check import check_recipe
from kompass.recipe.table import RecipeRules
from kompass.rules.checks.catalog import FieldType
from kompass.rules.schema.table import Table
from tests.support.rules import compare, rule


class Lamp(Component):
    """Shines, or does not."""

    @component_action
    def switch(self, on: bool, colour: str = "white") -> bool:
        """Switch it on or off."""
        return on and bool(colour)


def call(method: str, **kwargs: Any) -> dict[str, Any]:
    return {"kind": "method", "component": "lamp", "method": method, "kwargs": kwargs}


def change(**parameters: Any) -> dict[str, Any]:
    return {"kind": "update_parameters", "component": "lamp", "parameters": parameters}


def check(made: dict[str, Any]) -> None:
    catalog = RecipeCatalog([Lamp("lamp")], RecipeRules())
    check_recipe(Table.model_validate({"rules": [made]}), catalog)


def test_what_fits_passes() -> None:
    for action in (call("switch", on=True), call("restart"), change(loop_rate=5)):
        check(rule("r", compare("a", ">", 1), action))


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (rule("r", compare("a", ">", 1, path="dat")), ("rule 'r'", "did you mean 'data'")),
        (rule("r", compare("a", ">", "x")), ("an integer",)),
        (rule("r", compare("a-b", ">", 1)), ("must not contain",)),
        (rule("r", compare("a", ">", 1), call("swich", on=True)), ("swich", "switch")),
        (rule("r", compare("a", ">", 1), call("switch")), ("on",)),
        (rule("r", compare("a", ">", 1), call("switch", on="yes")), ("on", "true or false")),
        (rule("r", compare("a", ">", 1), call("switch", on=True, size=1)), ("size",)),
        (rule("r", compare("a", ">", 1), change(loop_rat=5)), ("loop_rate",)),
        (rule("r", compare("a", ">", 1), change(loop_rate="fast")), ("loop_rate", "number")),
        (
            rule("r", compare("a", ">", 1), change(executor_spin_timeout=1.0)),
            ("executor_spin_timeout", "would have no effect"),
        ),
        (rule("r", compare("a", ">", 1), {"kind": "python", "name": "nobody"}), ("nobody",)),
    ],
)
def test_what_does_not_fit_is_refused(made: dict[str, Any], words: tuple[str, ...]) -> None:
    with pytest.raises(ValueError) as refused:
        check(made)
    for word in words:
        assert word in str(refused.value)


STATUS = "automatika_ros_sugar/msg/ComponentStatus"


@pytest.mark.parametrize(
    ("operator", "value"), [("==", 300), ("==", 1.5), ("in", [0, 300]), ("==", -1)]
)
def test_a_status_that_no_component_can_have_is_not_waited_for(operator: str, value: Any) -> None:
    signal = {"topic": "controller/status", "type": STATUS, "path": ["status"]}
    condition = {"kind": "compare", "signal": signal, "operator": operator, "value": value}
    with pytest.raises(ValueError, match=r"'status' is an integer \(.*0 to 255\): this is never"):
        check(rule("r", condition))


def test_messages_requests_and_goals_are_known_by_their_fields() -> None:
    types = MessageTypes()
    known = types.field_type
    single, double = FieldType("float", primitive="float"), FieldType("float", primitive="double")
    assert known("sensor_msgs/msg/LaserScan", ("ranges",)) == FieldType("list", element=single)
    assert known("nav_msgs/msg/Path", ("poses", 0, "pose", "position", "x")) == double
    truth = FieldType("bool", primitive="boolean")
    assert known("std_srvs/srv/SetBool_Request", ("data",)) == truth
    assert known("kompass_interfaces/action/PlanPath_Goal", ("goal", "position", "x")) is not None
    assert known("geometry_msgs/msg/PoseWithCovariance", ("covariance", 3)) == double
    assert known("geometry_msgs/msg/PoseWithCovariance", ("covariance", 36)) is None
    assert known("shape_msgs/msg/SolidPrimitive", ("dimensions",)) == FieldType(
        "list", element=double, bound=3
    )
    text = FieldType("text", primitive="string", bound=255)
    assert known("type_description_interfaces/msg/FieldType", ("nested_type_name",)) == text
    assert known("std_msgs/msg/Nothing", ()) is None
    assert known("no_such/msg/Bool", ()) is None
    assert known("std_msgs/msg/Bool", ("data", "more")) is None
    assert list(types.walk("std_srvs/srv/Trigger_Request")) == []


def test_constants_are_told_with_their_field() -> None:
    found = constants("automatika_ros_sugar/msg/ComponentStatus", "status")
    assert found["STATUS_FAILURE_ALGORITHM_LEVEL"] == 1
    assert constants("std_msgs/msg/Int32", "data") == {}
