"""A condition is checked while the recipe is read, and means what it says."""

from collections.abc import Callable

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from kompass_interfaces.msg import TwistArray
from rclpy.qos import DurabilityPolicy

from kompass.components import Planner
from kompass.events import OnEqual
from kompass.expressions import Expression, MessageField, condition_of, reference_of
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.tables.recipe_check import check_recipe
from kompass.rclpy_ext.topic import QoSConfig, Topic
from kompass.recipe.event import Event
from kompass.recipe.table import RecipeRules, recipe_rules
from kompass.recipe.verbs import log
from kompass.rules.schema.conditions import AllOf, AnyOf, Compare, Not, Received
from kompass.rules.schema.describe import describe

SCAN = Topic(name="/scan", msg_type="LaserScan")
BATTERY = Topic(name="battery", msg_type="Float32", data_timeout=60.0)
JOINTS = Topic(name="joints", msg_type="sensor_msgs/JointState")
STATUS = Planner().status_topic


def compare(expression: object) -> Compare:
    condition = condition_of(expression)
    assert isinstance(condition, Compare)
    return condition


def test_a_comparison_names_topic_type_path_and_value() -> None:
    made = compare(STATUS.msg.status == 1)
    assert (made.signal.topic, made.signal.path) == ("planner/status", ("status",))
    assert made.signal.type == "automatika_ros_sugar/msg/ComponentStatus"
    assert (made.operator, made.value) == ("==", 1)


def test_a_declared_timeout_is_kept() -> None:
    assert compare(BATTERY.msg.data < 11).signal.timeout == 60.0


def test_whole_numbers_and_fractions_mix() -> None:
    assert compare(BATTERY.msg.data > 5).value == 5
    assert compare(STATUS.msg.status > 0.5).value == 0.5


def test_conditions_combine_with_and_or_not_and_topics() -> None:
    both = condition_of(SCAN & ~(BATTERY.msg.data < 11) | (STATUS.msg.status != 0))
    assert isinstance(both, AnyOf)
    first = both.conditions[0]
    assert isinstance(first, AllOf)
    assert isinstance(first.conditions[0], Received)
    assert isinstance(first.conditions[1], Not)


def test_an_item_of_a_list_can_be_compared() -> None:
    assert compare(SCAN.msg.ranges[0] < 0.3).signal.path == ("ranges", 0)


@pytest.mark.parametrize(("name", "item"), [("name", "a"), ("position", 1.0)])
def test_fields_of_any_name_can_be_used(name: str, item: object) -> None:
    assert compare(getattr(JOINTS.msg, name).contains_any([item])).signal.path == (name,)


def test_a_text_is_not_looked_for_among_numbers() -> None:
    with pytest.raises(TypeError, match=r"/joints position contains 'a': 'a' is no number"):
        JOINTS.msg.position.contains("a")


def test_is_in_takes_a_list_and_contains_looks_into_lists_and_texts() -> None:
    assert compare(STATUS.msg.status.is_in([1, 3])).value == (1, 3)
    assert compare(STATUS.msg.src_topics.contains("/scan")).operator == "contains"
    assert compare(STATUS.msg.msg.contains("Algorithm")).value == "Algorithm"


def test_between_takes_two_numbers_and_its_opposite_is_not() -> None:
    inside = compare(BATTERY.msg.data.between(0.2, 0.4))
    assert (inside.operator, inside.value) == ("between", (0.2, 0.4))
    assert describe(inside) == "0.2 <= battery.data <= 0.4"
    assert compare(BATTERY.msg.data.between(np.float64(11), 11)).value == (11.0, 11)
    assert compare(SCAN.msg.ranges[0].between(0, 1)).signal.path == ("ranges", 0)
    outside = condition_of(~BATTERY.msg.data.between(0.2, 0.4))
    assert isinstance(outside, Not)
    assert outside.condition == inside


@pytest.mark.parametrize("field", [BATTERY.msg.data, SCAN.msg.ranges[0]])
def test_between_with_the_higher_number_first_is_an_error_of_that_line(field: MessageField) -> None:
    with pytest.raises(ValueError, match="give the lower number first"):
        field.between(0.4, 0.2)


def test_a_mistyped_field_offers_the_nearest() -> None:
    with pytest.raises(AttributeError, match="no field 'statuss'; did you mean 'status'"):
        STATUS.msg.statuss  # noqa: B018 - reading it is the mistake


@pytest.mark.parametrize(
    "mistake",
    [
        lambda: STATUS.msg.status == "1",
        lambda: STATUS.msg.status == True,  # noqa: E712
        lambda: STATUS.msg.msg > 3,
        lambda: SCAN.msg.ranges == 0.3,
        lambda: SCAN.msg.header == 1,
        lambda: STATUS.msg.status.is_in(["a"]),
        lambda: STATUS.msg.status.contains(1),
        lambda: STATUS.msg.msg.between(1, 2),
        lambda: STATUS.msg.status.between("a", "b"),
        lambda: STATUS.msg.status.between(False, 2),
        lambda: SCAN.msg.ranges.between(0.1, 0.2),
        lambda: SCAN.msg.ranges[0].between(0.1, "0.2"),
        lambda: STATUS.msg.status & (BATTERY.msg.data > 1),
        lambda: (BATTERY.msg.data > 1) and (STATUS.msg.status == 1),
        lambda: 1 < BATTERY.msg.data < 2,
        lambda: SCAN.msg.ranges["a"],
    ],
)
def test_what_cannot_be_compared_is_an_error_of_that_line(mistake: object) -> None:
    with pytest.raises(TypeError):
        mistake()  # type: ignore[operator]


def test_a_field_can_stand_for_an_argument() -> None:
    commands = Topic(name="/control_list", msg_type=TwistArray)
    reference = reference_of(commands.msg.linear_velocities.x[0])
    assert reference == "$topic[/control_list].linear_velocities.x[0]"


def test_a_condition_reads_as_one_writes_it() -> None:
    assert "status" in describe(condition_of(STATUS.msg.status == 1))


def test_a_value_counts_for_a_second_unless_stated_and_for_ever_when_latched() -> None:
    latched = QoSConfig(durability=DurabilityPolicy.TRANSIENT_LOCAL)
    assert Topic(name="mode", msg_type="Bool").data_timeout == 1.0
    assert Topic(name="mode", msg_type="Bool", data_timeout=60.0).data_timeout == 60.0
    assert Topic(name="mode", msg_type="Bool", qos_profile=latched).data_timeout is None
    asked = Topic(name="mode", msg_type="Bool", qos_profile=latched, data_timeout=5.0)
    assert asked.data_timeout == 5.0


HEALTH = Topic(name="health", msg_type="diagnostic_msgs/DiagnosticStatus")
BYTES = Topic(name="bytes", msg_type="ByteMultiArray")
ID = Topic(name="id", msg_type="unique_identifier_msgs/UUID")


def test_a_byte_is_compared_with_numbers_and_with_the_constants_of_its_message() -> None:
    for wanted in (2, DiagnosticStatus.ERROR, np.uint8(2)):
        assert compare(HEALTH.msg.level == wanted).value == 2
    assert compare(HEALTH.msg.level >= DiagnosticStatus.WARN).value == 1
    assert compare(HEALTH.msg.level.is_in([DiagnosticStatus.OK, 1])).value == (0, 1)
    assert compare(HEALTH.msg.level.between(b"\x01", 3)).value == (1, 3)
    assert compare(BYTES.msg.data == [b"\x01", 2]).value == (1, 2)
    assert compare(BYTES.msg.data == b"\x01").value == (1,)
    assert compare(BYTES.msg.data.contains(b"\x01")).value == 1
    assert compare(BYTES.msg.data[0] == b"\x01").value == 1
    made = OnEqual("stale", HEALTH, DiagnosticStatus.STALE, "level").rule_event.condition
    assert compare(Expression(made)).value == 3
    with pytest.raises(TypeError, match="it is a number"):
        HEALTH.msg.level == "2"  # noqa: B015


COUNT = Topic(name="count", msg_type="Int32")


@pytest.mark.parametrize(
    ("mistake", "said"),
    [
        (
            lambda: HEALTH.msg.level == 300,
            r"/health level == 300: it is an integer \(byte: 0 to 255\), and never 300; give a ",
        ),
        (
            lambda: COUNT.msg.data == 2**40,
            r"/count data == 1099511627776: .*\(int32: -2147483648 to 2147483647\), and never 109",
        ),
        (lambda: COUNT.msg.data == 10.5, r"/count data == 10\.5: it is an integer .* never 10\.5"),
        (lambda: COUNT.msg.data.is_in([1, 2.5]), r"data in \[1, 2\.5\]: .* and never 2\.5; give "),
        (lambda: BYTES.msg.data.contains(256), r"data contains 256: .*0 to 255.* and never 256"),
        (lambda: ID.msg.uuid[0] == -1, r"uuid\[0\] == -1: .*0 to 255.* and never -1"),
        (lambda: ID.msg.uuid == [1, 2], r"a list of exactly 16 uint8, and never 2; give 16 items"),
        (lambda: OnEqual("e", COUNT, 2**40, "data"), r"/count data == 1099511627776: "),
    ],
)
def test_a_value_that_the_field_never_holds_is_an_error_of_that_line(
    mistake: Callable[[], object], said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        mistake()


def test_bounds_beyond_what_a_field_holds_and_fractions_as_bounds_are_read() -> None:
    assert compare(COUNT.msg.data > 10.5).value == 10.5
    assert compare(COUNT.msg.data < 2**40).value == 2**40
    assert compare(COUNT.msg.data == 10.0).value == 10.0
    assert compare(COUNT.msg.data != 2**40).operator == "!="


def test_an_item_of_a_fixed_list_of_numbers_is_a_number() -> None:
    assert compare(ID.msg.uuid[0] == 5).signal.path == ("uuid", 0)
    assert compare(ID.msg.uuid[-16] > 5).value == 5
    with pytest.raises(TypeError, match="it is a number"):
        ID.msg.uuid[0] == "5"  # noqa: B015


@pytest.mark.parametrize("index", [16, -17])
def test_an_item_that_a_fixed_list_never_has_is_refused(index: int) -> None:
    catalog = RecipeCatalog([], RecipeRules())
    made = recipe_rules({Event(ID.msg.uuid[index] == 5): log(msg="!")}, [])
    with pytest.raises(ValueError, match=r"'uuid' always has 16 items.*choose one of \[0\] to"):
        check_recipe(made.table, catalog)
    made = recipe_rules({Event(ID.msg.uuid[0] == 5): log(msg="!")}, [])
    check_recipe(made.table, catalog)
