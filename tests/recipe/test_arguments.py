"""What a recipe gives an action is stored as plain data, to its innermost items."""

from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import Point, Pose
from std_msgs.msg import Byte, Float32, String, UInt8
from std_srvs.srv import SetBool

from kompass.actions import Action, publish_message, reconfigure, send_srv_request
from kompass.components import Component
from kompass.components.base.actions import component_action
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.tables.recipe_check import check_recipe
from kompass.recipe.arguments import as_data
from kompass.recipe.export import to_python
from kompass.recipe.table import RecipeRules, recipe_rules
from kompass.ros import Event, Topic
from kompass.rules.schema.actions import Method, Publish, arguments_of
from kompass.rules.schema.table import Table
from tests.rules.building import received, rule

SCAN = Topic(name="/scan", msg_type="LaserScan")
CLICK = Topic(name="/click", msg_type="PointStamped")


class Arm(Component):
    """Takes lists and messages."""

    def __init__(self) -> None:
        super().__init__("arm")

    @component_action
    def move(self, joints: list[float], names: list[str] | None = None) -> bool:
        """Moves."""
        return bool(joints)

    @component_action
    def reach(self, pose: Pose, options: dict[str, Any] | None = None) -> bool:
        """Reaches for it."""
        return pose is not None


ARM = Arm()


def test_references_and_texts_keep_their_meaning_wherever_they_stand() -> None:
    given = {"x": CLICK.msg.point.x, "list": [SCAN.msg.ranges[0], "$5", {"deep": CLICK.msg.point}]}
    assert as_data(given) == {
        "x": "$topic[/click].point.x",
        "list": ["$topic[/scan].ranges[0]", "$$5", {"deep": "$topic[/click].point"}],
    }
    assert as_data(np.array([1.5, 2.0])) == [1.5, 2.0]
    assert as_data(String(data="$5")) == {"data": "$$5"}
    assert as_data(DiagnosticStatus(level=DiagnosticStatus.ERROR))["level"] == 2


def test_lists_and_messages_are_arguments_of_component_actions() -> None:
    move = Action(ARM.move, kwargs={"joints": [0.5, SCAN.msg.angle_min], "names": ["a"]})
    assert arguments_of(move.to_data())["joints"] == [0.5, "$topic[/scan].angle_min"]
    reach = Action(ARM.reach, args=(Pose(position=Point(x=1.0)),))
    pose = arguments_of(reach.to_data())["pose"]
    assert isinstance(pose, dict)
    assert pose["position"] == {"x": 1.0, "y": 0.0, "z": 0.0}
    rules = recipe_rules({Event(SCAN): [move, reach]}, [ARM])
    check_recipe(rules.table, RecipeCatalog([ARM], rules))


@pytest.mark.parametrize(
    ("method", "kwargs", "words"),
    [
        ("move", {"joints": [0.5, "1"]}, r"joints\[1\] = '1'.*each item of .* is a number"),
        ("move", {"joints": {"a": 1}}, "is a list"),
        (
            "reach",
            {"pose": {"position": {"x": "1"}}},
            r"pose\.position\.x = '1'.*number \(float64\)",
        ),
        ("reach", {"pose": {"positoin": {}}}, "did you mean 'position'"),
        ("reach", {"pose": [1.0]}, "is a mapping"),
    ],
)
def test_an_argument_of_another_type_is_refused_with_its_place(
    method: str, kwargs: dict[str, Any], words: str
) -> None:
    action = Method(component="arm", method=method, kwargs=kwargs)
    table = Table(rules=(rule(received("t"), actions=(action,)),))
    with pytest.raises(ValueError, match=words):
        check_recipe(table, RecipeCatalog([ARM], RecipeRules()))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: publish_message(topic=SCAN, msg=UInt8(data=300)), r"data = 300.*uint8: 0 to 255"),
        (lambda: publish_message(topic=SCAN, msg=Float32(data="1")), r"data = '1'.*float32"),
        (
            lambda: send_srv_request(
                srv_name="s", srv_type=SetBool, srv_request_msg=SetBool.Request(data=1)
            ),
            r"data = 1.*bool",
        ),
        (lambda: Action(ARM.reach, args=(Pose(position=Byte()),)), "position = a Byte"),
    ],
)
def test_a_message_that_cannot_be_sent_is_an_error_of_that_line(make: Any, words: str) -> None:
    with pytest.raises((ValueError, TypeError), match=words):
        make()


def test_a_configuration_may_refer_to_topics() -> None:
    made = reconfigure(component=ARM, new_config={"loop_rate": SCAN.msg.scan_time})
    assert arguments_of(made.to_data()) == {"loop_rate": "$topic[/scan].scan_time"}


@pytest.mark.parametrize("text", ["$5", "$topic[/scan].angle_min", "plain"])
def test_an_exported_argument_is_the_same_when_it_is_read_again(text: str) -> None:
    stored = as_data(text) if text == "$5" else text
    for value in (stored, [stored]):
        options: Any = {"a": value}
        action = Method(component="arm", method="reach", kwargs={"options": options})
        table = Table(rules=(rule(received("t"), actions=(action,), source="recipe"),))
        scope: dict[str, Any] = {"arm": ARM}
        exec(to_python(table), scope)
        (again,) = recipe_rules(scope["events_actions"], [ARM]).table.rules
        assert arguments_of(again.actions[0]) == action.kwargs


def test_what_a_recipe_publishes_is_what_a_rule_holds() -> None:
    made = publish_message(topic=Topic(name="b", msg_type="Byte"), msg=Byte(data=b"\x07")).to_data()
    assert isinstance(made, Publish)
    assert made.message == {"data": 7}
