"""A rule that was let in when less was known is told of, and refused when it fires."""

from collections.abc import Iterator
from typing import Any

import pytest
from kompass_interfaces.msg import RuleFiring, RulesState
from std_msgs.msg import Float64

from kompass.components import DriveManager
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.monitor import Monitor
from kompass.monitor.settings import MonitorSettings
from kompass.monitor.start import Start
from kompass.rclpy_ext.topic import LATCHED
from kompass.recipe.table import RecipeRules
from kompass.rules.schema.actions import CallService, Publish
from kompass.rules.schema.table import Table
from tests.rules.building import received, rule
from tests.support.spinning import Spinning

pytestmark = pytest.mark.ros
OLD = {
    "apply": (
        CallService(service="monitor/apply_rules", type="kompass_interfaces/srv/ApplyRules"),
        "engineer",
        "a rule may not change rules, places or missions (this rule has the rights of an engineer)",
    ),
    "blind": (
        Publish(topic="scan", type="sensor_msgs/msg/LaserScan"),
        "edited",
        "/scan is of the gate before the wheels",
    ),
    "dock": (
        CallService(service="dock/open", type="std_srvs/srv/Trigger"),
        "edited",
        "what /dock/open does is not known (this rule has the rights of an operator)",
    ),
}
TABLE = Table(
    rules=tuple(
        rule(received("press"), name, actions=(action,), source=source)
        for name, (action, source, _) in OLD.items()
    )
)


@pytest.fixture(scope="module")
def told(spinning: Spinning) -> Iterator[dict[str, str]]:
    """What a monitor that begins with these rules says: its notice, and of each rule that fired."""
    node, said = spinning.node, dict[str, str]()
    name = node.get_name()

    def hear(message: Any) -> None:
        if message.phase == "action":
            said[message.rule_id] = message.text

    node.create_subscription(
        RulesState,
        f"{name}/rules_state",
        lambda message: said.update(notice=message.notice),
        LATCHED.to_ros(),
    )
    node.create_subscription(RuleFiring, f"{name}/firings", hear, 100)
    recipe = RecipeRules()
    monitor = Monitor(
        *(node, spinning.executor, recipe, RecipeCatalog([DriveManager()], recipe)),
        start=Start(TABLE, 1, "epoch"),
        store=None,
        settings=MonitorSettings(robot="test"),
        ask=lambda _: None,
    )
    publisher = node.create_publisher(Float64, "press", 10)

    def all_told() -> bool:
        publisher.publish(Float64())
        return said.keys() >= {"notice", *OLD}

    spinning.until(all_told, 20.0)
    yield said
    monitor.close()


@pytest.mark.parametrize("old", OLD)
def test_what_a_rule_may_not_do_any_more_is_refused_when_it_fires(
    told: dict[str, str], old: str
) -> None:
    assert f"refused: {OLD[old][2]}" in told[old]


@pytest.mark.parametrize("old", OLD)
def test_it_is_said_at_the_start(told: dict[str, str], old: str) -> None:
    assert "rules may not do what they say" in told["notice"]
    assert f"'{old}' (" in told["notice"]
