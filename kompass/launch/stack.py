"""A recipe that is ready to run, before there are any processes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from kompass.components.base.component import Component
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.recipe.table import RecipeRules
from kompass.robot import RobotConfig
from kompass.supervisor.liveness import LivenessLimits


@dataclass(frozen=True)
class Monitored:
    """What the monitor is given: the recipe's rules, and what rules are checked against."""

    rules: RecipeRules
    catalog: RecipeCatalog


@dataclass(frozen=True)
class Stack:
    """All that a launcher knows when it is brought up.

    Attributes
    ----------
    groups
        The components, those together that share a process.
    activate
        Names of those that become active at once.
    namespace
        ROS namespace of the nodes.
    monitored
        None without a monitor.
    process_retries
        How often in a row a process that died is started again before it is given up.
    patience
        When a process counts as busy or stuck; None for what is usual.
    activation_timeout
        Within which all must be active [s]; None to wait for ever.
    """

    groups: Sequence[Sequence[Component]]
    activate: frozenset[str]
    namespace: str
    monitored: Monitored | None
    process_retries: int
    patience: LivenessLimits | None
    activation_timeout: float | None

    @property
    def components(self) -> list[Component]:
        """All of them."""
        return [component for group in self.groups for component in group]

    @property
    def robot(self) -> RobotConfig | None:
        """As the recipe describes it; None where nobody did."""
        described = (component.robot for component in self.components)
        return next((robot for robot in described if robot is not None), None)

    @property
    def model_type(self) -> str:
        """A :class:`kompass.robot.RobotType`; empty where nobody described the robot."""
        return "" if self.robot is None else self.robot.model_type

    @property
    def heard(self) -> frozenset[str]:
        """Full names of the topics that components listen to."""
        found = set()
        for one in self.components:
            for key in one.inputs_keys:
                given = one.get_in_topic(key)
                for topic in given if isinstance(given, list) else [given]:
                    if topic is not None:
                        found.add(f"/{topic.name.removeprefix('/')}")
        return frozenset(found)

    @property
    def inactive(self) -> list[str]:
        """Names of those of which it is known that they come up without becoming active."""
        return [
            one.node_name
            for one in self.components
            if one.lacks_robot or one.node_name not in self.activate
        ]


# Takes a stack that is to run, and returns when it has ended.
Run = Callable[[Stack], None]
_takers: list[Run] = []


@contextmanager
def stacks_go_to(take: Run) -> Iterator[None]:
    """While it lasts, ``launcher.bringup()`` gives its stack to somebody instead of running it."""
    _takers.append(take)
    try:
        yield
    finally:
        _takers.remove(take)


def taker(otherwise: Run) -> Run:
    """Who takes a stack now; ``otherwise`` where nobody asked for it."""
    return _takers[-1] if _takers else otherwise
