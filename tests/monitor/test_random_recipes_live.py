"""Some of the random recipes, carried out by a monitor on real DDS: its journal, and the wire."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest
from kompass_interfaces.msg import RuleFiring
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import String
from std_srvs.srv import SetBool

from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.monitor import Monitor
from kompass.monitor.settings import MonitorSettings
from kompass.monitor.start import Start
from kompass.recipe.table import recipe_rules
from kompass.rules.engine.compiled_table import compile_table
from tests.recipe.plain_model import World
from tests.recipe.random_recipes import DRIVER, KINDS, PLANNER, Recipe, Writer, plain, value_of
from tests.support.spinning import Spinning, spinner

pytestmark = [pytest.mark.ros, pytest.mark.slow]
MESSAGES = 12
RELIABLE = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)


class Live:
    """A monitor that runs a recipe, and everything that the recipe speaks with."""

    def __init__(self, spinning: Spinning, recipe: Recipe) -> None:
        self.spinning, self.recipe, node = spinning, recipe, spinning.node
        made = recipe_rules(recipe.launcher._events_actions, [PLANNER, DRIVER])
        self.numbers = {rule.id: number for number, rule in enumerate(made.table.rules)}
        self.heard: list[str] = []
        self.asked: list[bool] = []
        self.steps: list[Any] = []
        self._ends: list[Callable[[], Any]] = []
        own = [
            node.create_subscription(String, "said", lambda m: self.heard.append(m.data), RELIABLE),
            node.create_subscription(
                RuleFiring, f"{node.get_name()}/firings", self.steps.append, 100
            ),
        ]
        light = node.create_service(SetBool, "light", self._switch)
        self._publishers = {
            name: node.create_publisher(kind, name, RELIABLE) for name, kind in KINDS.items()
        }
        self.monitor = Monitor(
            *(node, spinning.executor, made, RecipeCatalog([PLANNER, DRIVER], made)),
            start=Start(made.table, 1, "epoch"),
            store=None,
            settings=MonitorSettings(robot="test"),
            ask=lambda _: None,
        )
        self._ends += [self.monitor.close, lambda: node.destroy_service(light)]
        self._ends += [partial(node.destroy_subscription, one) for one in own]
        self._ends += [partial(node.destroy_publisher, one) for one in self._publishers.values()]
        for name in compile_table(made.table).topic_types():
            spinning.until(partial(self._is_heard, name), 20.0)

    def _switch(self, request: Any, response: Any) -> Any:
        self.asked.append(request.data)
        response.success = True
        return response

    def _is_heard(self, topic: str) -> bool:
        """Whether the monitor listens as reliably as is spoken, and with one reader."""
        readers = self.spinning.node.get_subscriptions_info_by_topic(topic)
        publisher = self._publishers[topic]
        return (
            bool(readers)
            and all(each.qos_profile.reliability == ReliabilityPolicy.RELIABLE for each in readers)
            and publisher.get_subscription_count() == 1
        )

    def say(self, topic: str, value: Any) -> None:
        self._publishers[topic].publish(KINDS[topic](data=value))

    def runs(self, phase: str) -> list[Any]:
        return [step for step in self.steps if step.phase == phase]

    def close(self) -> None:
        for end in self._ends:
            end()


def told(world: World) -> list[tuple[int, list[tuple[bool, str]]]]:
    """The runs that must be in the journal."""
    texts: dict[str, Callable[[Any], str]] = {
        "log": lambda made: made[1],
        "note": lambda made: made[1][0],
        "publish": lambda made: "published to 1 listener",
        "call_service": lambda made: "message ",
    }
    return [
        (number, [(True, texts[one[0]](one)) if one else (False, "") for one in made])
        for _, number, made in world.done
    ]


@pytest.fixture
def fresh() -> Iterator[Spinning]:
    """A node for each recipe: a monitor's subscriptions last as long as its node."""
    with spinner() as one:
        yield one


@pytest.mark.parametrize("seed", range(6))
def test_a_random_recipe_does_on_the_wire_what_a_plain_model_of_it_does(
    seed: int, fresh: Spinning
) -> None:
    rng = random.Random(f"live {seed}")
    recipe = Writer(rng, timeless=True).recipe()
    live = Live(fresh, recipe)
    try:
        for moment in range(MESSAGES):
            topic = rng.choice([*KINDS])
            value = value_of(topic, rng)
            recipe.world.hear(topic, value, float(moment))
            live.say(topic, value)
            # What a message sets going must have ended before the next one.
            fresh.until(lambda: len(live.runs("done")) >= len(recipe.world.done), 20.0)
            fresh.rest(0.05)
        fresh.rest(0.3)
        assert_same(live, recipe.world)
    finally:
        live.close()


def assert_same(live: Live, world: World) -> None:
    actions: dict[tuple[str, int], list[tuple[bool, str]]] = {}
    for step in live.runs("fired"):
        actions[(step.rule_id, step.run_id)] = []
    for step in live.runs("action"):
        said = step.text if step.ok else ""
        actions[(step.rule_id, step.run_id)].append((step.ok, said))
    journal = sorted((live.numbers[rule_id], made) for (rule_id, _), made in actions.items())
    assert journal == sorted(told(world))
    made = [one for _, _, run in world.done for one in run if one is not None]
    assert alike(live.recipe.noted, [one[1] for one in made if one[0] == "note"])
    assert alike(live.heard, [one[2]["data"] for one in made if one[0] == "publish"])
    assert alike(live.asked, [one[2]["data"] for one in made if one[0] == "call_service"])


def alike(did: list[Any], said: list[Any]) -> bool:
    """Whether the same things were done; of what one message sets going, the order is free."""
    return sorted(map(_text, did)) == sorted(map(_text, said))


def _text(value: Any) -> str:
    return json.dumps(value, default=plain)
