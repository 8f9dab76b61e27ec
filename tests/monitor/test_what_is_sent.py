"""What a rule says is what is heard on the wire, and what cannot be sent is not."""

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import count
from typing import Any

import pytest
from automatika_ros_sugar.srv import ChangeParameters, ExecuteMethod
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from kompass_interfaces.msg import RuleFiring
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Byte, Float32, Float64, Int32, String, UInt8

from kompass.field_types import field_types
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.monitor import Monitor
from kompass.monitor.settings import MonitorSettings
from kompass.monitor.start import Start
from kompass.rclpy_ext.executor import TaskExecutor
from kompass.rclpy_ext.messages import fill, to_plain
from kompass.rclpy_ext.node import PlainNode
from kompass.rclpy_ext.topic import Topic
from kompass.recipe.event import Event
from kompass.recipe.table import RecipeRules, recipe_rules
from kompass.recipe.verbs import publish_message
from kompass.rules.schema.actions import Action as RuleAction
from kompass.rules.schema.actions import Method, Publish, Reconfigure, UpdateParameters
from kompass.rules.schema.conditions import Compare, Received
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Table
from tests.rules.building import rule
from tests.support.fields import alike, class_of, literal, message_as_received, message_data
from tests.support.spinning import Spinning

pytestmark = pytest.mark.ros
RELIABLE = QoSProfile(depth=100)
SAMPLE = (
    *(f"std_msgs/msg/{name}" for name in ("Bool", "Byte", "Char", "ByteMultiArray", "String")),
    *(f"std_msgs/msg/{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64)),
    *(f"std_msgs/msg/Float{bits}" for bits in (32, 64)),
    *(f"std_msgs/msg/{name}MultiArray" for name in ("UInt8", "Int64", "Float32")),
    "diagnostic_msgs/msg/DiagnosticArray",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "nav_msgs/msg/Path",
    "sensor_msgs/msg/JointState",
    "sensor_msgs/msg/LaserScan",
    "shape_msgs/msg/SolidPrimitive",
    "unique_identifier_msgs/msg/UUID",
)
_number = count()


class World:
    """A monitor, and another node that speaks to it and hears what its rules say."""

    def __init__(self, spinning: Spinning, monitor: str, executor: TaskExecutor) -> None:
        self.spinning, self.node, self._executor = spinning, spinning.node, executor
        self.told: dict[str, list[str]] = {}
        self._publishers: dict[str, Any] = {}
        # Nothing is destroyed before the node is: the executor may be about to look at it.
        self.node.create_subscription(RuleFiring, f"{monitor}/firings", self._hear, RELIABLE)

    def _hear(self, step: Any) -> None:
        if step.phase == "action":
            self.told.setdefault(step.rule_id, []).append(step.text)

    def until(self, condition: Callable[[], object], timeout: float = 10.0) -> None:
        """Let both nodes work until a condition holds."""

        def holds() -> object:
            self._executor.spin_once(timeout_sec=0.01)
            return condition()

        self.spinning.until(holds, timeout)

    def rest(self, seconds: float) -> None:
        """Let both nodes work for a while."""
        end = time.monotonic() + seconds
        self.until(lambda: time.monotonic() > end)

    def listen(self, kind: type[Any], topic: str, qos: QoSProfile = RELIABLE) -> list[Any]:
        """What is heard on a topic, as it comes."""
        heard: list[Any] = []
        self.node.create_subscription(kind, topic, heard.append, qos)
        return heard

    def say(self, topic: str, message: Any) -> None:
        """Publish once, when the monitor listens."""
        if topic not in self._publishers:
            publisher = self.node.create_publisher(type(message), topic, RELIABLE)
            self._publishers[topic] = publisher
        publisher = self._publishers[topic]
        self.until(lambda: publisher.get_subscription_count() > 0)
        publisher.publish(message)

    def outcome(self, rule_id: str, number: int = 1) -> str:
        """What the journal says of the last action of a rule, once it has been told so often."""
        self.until(lambda: len(self.told.get(rule_id, ())) >= number)
        return self.told[rule_id][-1]


@contextmanager
def monitoring(spinning: Spinning, rules: list[Rule] | RecipeRules) -> Iterator[World]:
    """A world with these rules in force."""
    recipe = rules if isinstance(rules, RecipeRules) else RecipeRules(Table(rules=tuple(rules)))
    node = PlainNode(f"monitor_{next(_number)}")
    executor = TaskExecutor()
    executor.add_node(node)
    monitor = Monitor(
        *(node, executor, recipe, RecipeCatalog([], recipe)),
        start=Start(recipe.table, 1, "epoch"),
        store=None,
        settings=MonitorSettings(robot="test"),
        ask=lambda _: None,
    )
    world = World(spinning, node.get_name(), executor)
    try:
        yield world
    finally:
        monitor.close()
        executor.shutdown()
        node.destroy_node()


def on_message(topic: str, kind: str, rule_id: str, *actions: RuleAction) -> Rule:
    condition = Received(signal=Signal(topic=topic, type=kind))
    return rule(condition, rule_id, actions=actions, source="recipe")


def publish(topic: str, kind: str, **message: Any) -> Publish:
    return Publish(topic=topic, type=kind, message=message)


def test_a_byte_is_heard_as_it_was_written(spinning: Spinning) -> None:
    kind = "diagnostic_msgs/msg/DiagnosticStatus"
    told = on_message("press", "std_msgs/msg/Float64", "tell", publish("health_out", kind, level=2))
    with monitoring(spinning, [told]) as world:
        heard = world.listen(DiagnosticStatus, "health_out")
        for number in range(1, 21):
            world.say("press", Float64())
            assert world.outcome("tell", number) == "published to 1 listener"
        world.until(lambda: len(heard) == 20)
    assert {message.level for message in heard} == {b"\x02"}


@pytest.mark.parametrize(
    ("said", "out", "reason"),
    [
        (Float64(data=300.0), UInt8, "data = 300.0: it is an integer (uint8: 0 to 255)"),
        (Float64(data=2.0**40), Int32, "give a whole number from -2147483648 to 2147483647"),
        (Float64(data=1e300), Float32, "it is a number (float32)"),
        (Float64(data=256.0), Byte, "it is an integer (byte: 0 to 255)"),
        (String(data="0.5"), Float32, "data = '0.5': it is a number (float32)"),
        (Float64(data=0.5), Int32, "data = 0.5"),
        (Int32(data=1), String, "it is a text (string)"),
    ],
)
def test_what_a_message_brings_and_a_field_cannot_hold_is_not_sent_and_the_journal_says_why(
    spinning: Spinning, said: Any, out: type[Any], reason: str
) -> None:
    kinds = [f"std_msgs/msg/{each.__name__}" for each in (type(said), out)]
    # One participant of DDS has one type for a topic.
    names = [f"{kind.rpartition('/')[2]}_{way}" for kind, way in zip(kinds, "io", strict=True)]
    told = on_message(names[0], kinds[0], "pass", publish(names[1], kinds[1], data="$msg.data"))
    with monitoring(spinning, [told]) as world:
        heard = world.listen(out, names[1])
        world.say(names[0], said)
        assert reason in world.outcome("pass")
        world.rest(0.2)
        assert heard == []


@settings(
    max_examples=3,
    deadline=None,
    derandomize=True,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)
@given(
    st.fixed_dictionaries({name: message_data(name, finite=True) for name in SAMPLE}),
    st.fixed_dictionaries({name: message_data(name, finite=False) for name in SAMPLE}),
)
def test_literals_and_references_of_many_types_arrive_equal(
    spinning: Spinning, literals: dict[str, Any], brought: dict[str, Any]
) -> None:
    rules = []
    for number, kind in enumerate(SAMPLE):
        references = {name: f"$msg.{name}" for name in field_types(class_of(kind))}
        actions = (
            publish(f"literal_{number}", kind, **literal(literals[kind])),
            publish(f"reference_{number}", kind, **references),
        )
        rules.append(on_message(f"in_{number}", kind, f"r{number}", *actions))
    with monitoring(spinning, rules) as world:
        heard = {
            name: world.listen(class_of(kind), name)
            for number, kind in enumerate(SAMPLE)
            for name in (f"literal_{number}", f"reference_{number}")
        }
        for number, kind in enumerate(SAMPLE):
            world.say(f"in_{number}", fill(class_of(kind)(), brought[kind]))
        world.until(lambda: all(heard.values()), 20.0)
    for number, kind in enumerate(SAMPLE):
        for name, data in (("literal", literals), ("reference", brought)):
            (arrived,) = heard[f"{name}_{number}"]
            assert alike(to_plain(arrived), message_as_received(kind, data[kind])), (name, kind)


def test_a_byte_is_compared_with_a_number_by_a_rule_in_force(spinning: Spinning) -> None:
    kind = "diagnostic_msgs/msg/DiagnosticStatus"
    rules = [
        rule(
            Compare(
                signal=Signal(topic="health", type=kind, path=("level",)),
                operator=operator,  # type: ignore[arg-type]
                value=value,
            ),
            name,
            actions=(publish("alarm", "std_msgs/msg/Byte", data="$msg.level"),),
            source="recipe",
        )
        for name, operator, value in (("two", "==", 2), ("much", ">=", 2), ("in", "in", (2, 3)))
    ]
    with monitoring(spinning, rules) as world:
        heard = world.listen(Byte, "alarm")
        for level in (b"\x00", DiagnosticStatus.ERROR, b"\x01"):
            world.say("health", DiagnosticStatus(level=level))
        world.until(lambda: len(heard) == 3)
        world.rest(0.2)
    assert [message.data for message in heard] == [b"\x02"] * 3


def test_a_recipe_compares_bytes_with_the_constants_of_their_messages(spinning: Spinning) -> None:
    health = Topic(name="health", msg_type="diagnostic_msgs/DiagnosticStatus")
    byte = Topic(name="byte", msg_type="Byte")
    out = Topic(name="byte_out", msg_type="Byte")
    rules = recipe_rules(
        {
            Event(health.msg.level == DiagnosticStatus.ERROR): publish_message(
                topic=out, msg=Byte(data=DiagnosticStatus.ERROR)
            ),
            Event(byte.msg.data == 2): publish_message(topic=out, msg=Byte(data=b"\x07")),
        },
        [],
    )
    with monitoring(spinning, rules) as world:
        heard = world.listen(Byte, "byte_out")
        world.say("health", DiagnosticStatus(level=DiagnosticStatus.ERROR))
        world.until(lambda: len(heard) == 1)
        world.say("byte", Byte(data=b"\x01"))
        world.say("byte", Byte(data=b"\x02"))
        world.until(lambda: len(heard) == 2)
    assert [message.data for message in heard] == [b"\x02", b"\x07"]


def test_a_message_that_an_event_parser_made_wrong_is_not_sent(spinning: Spinning) -> None:
    number, out = (
        Topic(name="number", msg_type="Float64"),
        Topic(name="parsed_out", msg_type="Byte"),
    )

    def made(msg: Any, **_: Any) -> Byte:
        return Byte(data=int(msg.data))

    action = publish_message(topic=out, msg=Byte())
    action.event_parser(made, "msg")
    rules = recipe_rules({Event(number): action}, [])
    (one,) = rules.table.rules
    with monitoring(spinning, rules) as world:
        heard = world.listen(Byte, "parsed_out")
        world.say("number", Float64(data=300.0))
        assert "data = 300: it is an integer (byte: 0 to 255)" in world.outcome(one.id)
        world.say("number", Float64(data=3.0))
        assert world.outcome(one.id, 2) == "published to 1 listener"
        world.until(lambda: bool(heard))
    assert [message.data for message in heard] == [b"\x03"]


def test_the_journal_says_how_many_listened(spinning: Spinning) -> None:
    kind = "std_msgs/msg/Float64"
    told = on_message("press", kind, "tell", publish("counted", kind, data=1.0))
    with monitoring(spinning, [told]) as world:
        world.say("press", Float64())
        assert world.outcome("tell") == "published, but nobody listens"
        first, second = world.listen(Float64, "counted"), world.listen(Float64, "counted")
        world.say("press", Float64())
        assert world.outcome("tell", 2) == "published to 2 listeners"
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        third = world.listen(Float64, "counted", latched)
        world.say("press", Float64())
        assert world.outcome("tell", 3) == (
            "published to 2 listeners; 1 more asks for a latched topic, and got nothing"
        )
        world.until(lambda: len(first) == len(second) == 2)
        assert third == []


def test_the_publishers_of_rules_leave_a_latched_topic_latched(spinning: Spinning) -> None:
    kind = "std_msgs/msg/Float64"
    told = on_message("press", kind, "tell", publish("map", kind, data=2.0))
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    server = spinning.node.create_publisher(Float64, "map", latched)

    def offers() -> list[DurabilityPolicy]:
        infos = spinning.node.get_publishers_info_by_topic("/map")
        return [info.qos_profile.durability for info in infos]

    with monitoring(spinning, [told]) as world:
        world.until(lambda: offers() == [DurabilityPolicy.TRANSIENT_LOCAL] * 2)
        heard = world.listen(Float64, "map", latched)
        world.say("press", Float64())
        assert world.outcome("tell") == "published to 1 listener"
        world.until(lambda: bool(heard))
    assert server.topic_name == "/map"


def test_nobody_stands_ready_where_a_second_publisher_would_halt_the_robot(
    spinning: Spinning,
) -> None:
    kind = "geometry_msgs/msg/Twist"
    told = on_message("press", "std_msgs/msg/Float64", "drive", publish("some_velocity", kind))
    with monitoring(spinning, [told]) as world:
        assert spinning.node.count_publishers("/some_velocity") == 0
        world.say("press", Float64())
        assert world.outcome("drive") == "published, but nobody listens"
        world.until(lambda: spinning.node.count_publishers("/some_velocity") == 0)


def test_lists_messages_and_bytes_reach_components_as_plain_data(spinning: Spinning) -> None:
    kind = "diagnostic_msgs/msg/DiagnosticArray"
    called: dict[str, Any] = {}

    def execute(request: Any, response: Any) -> Any:
        called[request.name] = json.loads(request.kwargs_json)
        response.success = True
        return response

    def change(request: Any, response: Any) -> Any:
        called["parameters"] = dict(
            zip(request.names, map(json.loads, request.values), strict=True)
        )
        response.success = [True] * len(request.names)
        response.error_msg = [""] * len(request.names)
        return response

    spinning.node.create_service(ExecuteMethod, "arm/execute_method", execute)
    spinning.node.create_service(ChangeParameters, "arm/update_config_parameters", change)
    arguments: dict[str, Any] = {
        "whole": "$msg.status",
        "parts": ["$msg.status[0].level", {"name": "$msg.status[1].name"}, 1.5],
    }
    reach = Method(component="arm", method="reach", kwargs=arguments)
    set_ = UpdateParameters(component="arm", parameters=arguments)
    configure = Reconfigure(component="arm", config=arguments)
    rules = [on_message("array", kind, "r", reach, set_, configure)]
    statuses = [DiagnosticStatus(level=b"\x02", name="a"), DiagnosticStatus(name="b")]
    with monitoring(spinning, rules) as world:
        world.say("array", DiagnosticArray(status=statuses))
        world.outcome("r", 3)
    given = {"whole": to_plain(statuses), "parts": [2, {"name": "b"}, 1.5]}
    assert called["reach"] == called["parameters"] == given
    assert called["reconfigure"] == {"new_config": given, "keep_alive": False}
