"""A mistyped attribute of a component is an error of its line; attributes of one's own are not."""

from typing import Any

import pytest

from kompass.components import Component, Controller, DriveManager, Planner
from kompass.config import BaseComponentConfig


class CounterConfig(BaseComponentConfig):
    """Settings of the counter."""

    limit: float = 0.5
    algorithms: int = 1


class Counter(Component):
    """Has attributes of its own, some of them like the names of settings."""

    config: CounterConfig
    config_class = CounterConfig
    quiet = False

    def __init__(self, component_name: str) -> None:
        super().__init__(component_name)
        self.count = 0
        self.loop_rates = [1.0, 2.0]

    def init_variables(self) -> None:
        self.limit = self.config.limit


@pytest.mark.parametrize(
    ("component", "name", "remedy"),
    [
        (Controller(), "algoritm", r"did you mean 'algorithm'\?"),
        (Planner(), "run_typ", r"did you mean 'run_type'\?"),
        (Controller(), "direct_sensr", r"did you mean 'direct_sensor'\?"),
        (Planner(), "loop_rat", r"did you mean 'loop_rate'\?"),
        (DriveManager(), "publish_cmds_in_parallel", r"known are action_type, .*loop_rate"),
        (DriveManager(), "closed_loop", r"'closed_loop': the base holds the commanded speed"),
        (DriveManager(), "scan_timeout", r"it is a setting: config\.scan_timeout = …"),
        (DriveManager(), "scan_timeot", r"did you mean 'config\.scan_timeout'\?"),
        (Planner(), "main_action_nam", r"did you mean 'main_action_name'\?"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_mistyped_attribute_is_offered_the_nearest(
    component: Component, name: str, remedy: str
) -> None:
    with pytest.raises(AttributeError, match=remedy) as refused:
        setattr(component, name, True)
    assert str(refused.value).startswith(f"{component.node_name}: a {type(component).__name__} has")
    assert not hasattr(component, name)


@pytest.mark.parametrize(
    ("name", "value"),
    [("count", 3), ("loop_rates", []), ("quiet", True), ("limit", 0.1), ("note", "mine")],
)
def test_a_component_of_ones_own_has_attributes_of_its_own(name: str, value: Any) -> None:
    counter = Counter("counter")
    counter.init_variables()
    setattr(counter, name, value)
    assert getattr(counter, name) == value
