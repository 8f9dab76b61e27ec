"""Fallbacks of components as rules: what a component does about its own failure."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from automatika_ros_sugar.msg import ComponentStatus
from pydantic import JsonValue

from kompass.components.base.component import Component
from kompass.components.base.fallbacks import KINDS
from kompass.expressions import condition_of
from kompass.recipe.action import Action
from kompass.recipe.action_data import ActionData
from kompass.rules.schema.actions import Action as RuleAction
from kompass.rules.schema.actions import Python, topics_in
from kompass.rules.schema.conditions import AllOf, Condition
from kompass.rules.schema.events import Event
from kompass.rules.schema.table import Rule

# A failure that passes by itself within this time, as while the first messages arrive, is left to
# do so.
HOLD = 1.0  # s
PAUSE = 2.0  # s at least between two tries
RECOVERED = 5.0  # s of health after which a failure is a new one
LEVELS = {
    "on_algorithm_fail": ComponentStatus.STATUS_FAILURE_ALGORITHM_LEVEL,
    "on_component_fail": ComponentStatus.STATUS_FAILURE_COMPONENT_LEVEL,
    "on_system_fail": ComponentStatus.STATUS_FAILURE_SYSTEM_LEVEL,
}


@dataclass
class FallbackSequence:
    """Actions tried one after another while a component fails.

    Attributes
    ----------
    actions
        In their order.
    max_retries
        How often each is tried; None for once, or for ever if there is only one.
    giveup
        What follows the last, once.
    tried
        How many tries there were since the component was last well.
    """

    actions: tuple[RuleAction, ...]
    max_retries: int | None
    giveup: tuple[RuleAction, ...] = ()
    tried: int = 0

    def next(self) -> RuleAction | None:
        """The action to try now; None when there is nothing left."""
        retries = self.max_retries
        if retries is None and len(self.actions) == 1:
            return self.actions[0]
        step, self.tried = self.tried // (retries or 1), self.tried + 1
        if step < len(self.actions):
            return self.actions[step]
        after = self.tried - 1 - len(self.actions) * (retries or 1)
        return self.giveup[after] if after < len(self.giveup) else None

    def reset(self) -> None:
        """Begin anew with the next failure."""
        self.tried = 0


@dataclass
class FallbackActions:
    """The actions of a component's fallbacks, by kind of failure."""

    by_kind: dict[str, list[Action]] = field(default_factory=dict)

    def all(self) -> Iterator[Action]:
        """Walk all of them."""
        for actions in self.by_kind.values():
            yield from actions


def fallback_actions(component: Component) -> FallbackActions:
    """What a component's fallbacks do; functions that were given bare become actions.

    Raises
    ------
    TypeError
        When one of them cannot be an action.
    """
    made = FallbackActions()
    for kind in KINDS:
        fallback = getattr(component.fallbacks, kind)
        if fallback is not None:
            made.by_kind[kind] = [
                one if isinstance(one, Action) else Action(one) for one in fallback.actions
            ]
    return made


def fallback_rules(
    component: Component, actions: FallbackActions, data_of: ActionData
) -> list[Rule]:
    """The rules of a component's fallbacks; their actions become functions, as sequences.

    Raises
    ------
    ValueError
        When an action lacks an argument.
    """
    declared = component.fallbacks
    status = component.status_topic.msg.status

    def data(kind: str) -> tuple[RuleAction, ...]:
        where = f"{component.node_name}.{kind}"
        return tuple(data_of.of(action, where) for action in actions.by_kind.get(kind, ()))

    giveup = data("on_giveup")
    pause = max(PAUSE, 1.0 / component.config.fallback_rate)
    rules, sequences = [], []
    for kind in (*LEVELS, "on_fail"):
        fallback = getattr(declared, kind)
        if fallback is None:
            continue
        if kind == "on_fail":
            others = [condition_of(status != LEVELS[k]) for k in LEVELS if getattr(declared, k)]
            failing = condition_of(status != ComponentStatus.STATUS_HEALTHY)
            condition: Condition = AllOf(conditions=(failing, *others)) if others else failing
        else:
            condition = condition_of(status == LEVELS[kind])
        sequence = FallbackSequence(data(kind), fallback.max_retries, giveup)
        sequences.append(sequence)
        name = f"{component.node_name} {kind.replace('_', ' ')}"
        data_of.functions[name] = sequence
        # The topics from which arguments are taken must be listened to.
        topics = {
            topic for action in (*sequence.actions, *sequence.giveup) for topic in topics_in(action)
        }
        kwargs: dict[str, JsonValue] = {
            f"/{topic}": f"$topic[/{topic}]" for topic in sorted(topics)
        }
        rules.append(
            Rule(
                id=name.replace(" ", "-").replace("_", "-"),
                name=name,
                event=Event(condition=condition, hold=HOLD, cooldown=pause),
                actions=(Python(name=name, kwargs=kwargs, timeout=None),),
                source="recipe",
            )
        )
    if sequences:
        name = f"{component.node_name} recovered"
        data_of.functions[name] = _reset_of(sequences)
        rules.append(
            Rule(
                id=name.replace(" ", "-").replace("_", "-"),
                name=name,
                event=Event(
                    condition=condition_of(status == ComponentStatus.STATUS_HEALTHY),
                    trigger="edge",
                    # One that was restarted is well until it has waited for its inputs in vain.
                    hold=component.config.topic_subscription_timeout + RECOVERED,
                    first_true_is_edge=False,
                ),
                actions=(Python(name=name),),
                source="recipe",
            )
        )
    return rules


def _reset_of(sequences: list[FallbackSequence]) -> Callable[[], None]:
    def reset() -> None:
        for sequence in sequences:
            sequence.reset()

    return reset
