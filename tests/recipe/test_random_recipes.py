"""A recipe does what it says, whichever recipe: five hundred of them against a plain model."""

from __future__ import annotations

import random
from typing import Any

import pytest

from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.recipe_call import RecipeCall
from kompass.monitor.tables.recipe_check import check_recipe
from kompass.recipe.parsed import Parsed
from kompass.recipe.table import RecipeRules, recipe_rules
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.firing import Firing, Input, RunEnded, Sample, Tick
from kompass.rules.engine.schedule import next_deadline
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema import actions as kinds
from kompass.rules.schema.arguments import ArgumentError, resolve
from kompass.rules.schema.conditions import CallableCondition
from tests.recipe.random_recipes import (
    DRIVER,
    KINDS,
    MISTAKES,
    PLANNER,
    Recipe,
    Writer,
    plain,
    value_of,
)

RECIPES = 500
GRID = 0.25  # s; exact in floating point, so that what is due at a moment is due at that moment


class Carried:
    """The recipe as it is read, on the engine; what its rules do is done by hand, and noted."""

    def __init__(self, recipe: Recipe) -> None:
        self.noted = recipe.noted
        self.made: RecipeRules = recipe_rules(recipe.launcher._events_actions, [PLANNER, DRIVER])
        check_recipe(self.made.table, RecipeCatalog([PLANNER, DRIVER], self.made))
        self.table = compile_table(self.made.table)
        self.state = initial_state(self.table, 0.0)
        self.numbers = {rule.id: number for number, rule in enumerate(self.made.table.rules)}
        self.done: list[tuple[float, int, list[Any]]] = []

    def take(self, topic: str, message: Any, now: float) -> None:
        # As the monitor does: what is due before is carried out before.
        while (due := next_deadline(self.table, self.state)) is not None and due <= now:
            self._step(Tick(), due)
        self._step(Sample(topic, message), now)

    def _step(self, event: Input, now: float) -> None:
        self.state, out = step(self.table, self.state, event, now)
        for firing in out:
            if not isinstance(firing, Firing):
                continue  # a note that it came close
            self.done.append((firing.at, self.numbers[firing.rule_id], self._run(firing)))
            ended = RunEnded(firing.rule_id, firing.run_id)
            self.state, _ = step(self.table, self.state, ended, firing.at)

    def ask(self, number: int, now: float) -> None:
        condition = self.made.table.rules[number].event.condition
        assert isinstance(condition, CallableCondition)
        self.take(condition.topic, bool(RecipeCall(self.made.polled[condition.name]).run()), now)

    def _run(self, firing: Firing) -> list[Any]:
        made: list[Any] = []
        for action in firing.actions:
            try:
                made.append(self._do(action, firing))
            except ArgumentError:
                made.append(None)
                break
        return made

    def _do(self, action: kinds.Action, firing: Firing) -> Any:
        def values(data: Any) -> dict[str, Any]:
            given = resolve(data, firing.message, firing.messages)
            return {key: _plain(value) for key, value in given.items()}

        match action:
            case kinds.Log():
                return ("log", action.text)
            case kinds.Publish():
                return ("publish", action.topic, values(action.message))
            case kinds.CallService():
                return ("call_service", action.service, values(action.request))
            case kinds.UpdateParameters():
                return ("update_parameters", action.component, values(action.parameters))
            case kinds.Lifecycle():
                return ("lifecycle", action.component, action.action)
            case kinds.Method():
                return ("method", action.component, values(action.kwargs))
        assert isinstance(action, kinds.Python)
        entry = self.made.functions[action.name]
        if isinstance(entry, Parsed):
            made = RecipeCall(entry.parser.make, {"message": firing.message}).run()
            (request,) = entry.parser.arguments(made).values()
            assert isinstance(entry.action, kinds.CallService)
            return ("call_service", entry.action.service, {"data": request.data})
        assert callable(entry)
        before = len(self.noted)
        RecipeCall(entry, resolve(action.kwargs, firing.message, firing.messages)).run()
        (noted,) = self.noted[before:]
        return ("note", _plain(noted))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return type(value)(_plain(item) for item in value)
    return plain(value)


def message(topic: str, value: Any) -> Any:
    return KINDS[topic](data=value)


@pytest.mark.parametrize("hundred", range(RECIPES // 100))
def test_a_random_recipe_does_what_a_plain_model_of_it_does(hundred: int) -> None:
    fired = 0
    for seed in range(100 * hundred, 100 * hundred + 100):
        rng = random.Random(seed)
        recipe = Writer(rng).recipe()
        carried = Carried(recipe)
        now = 0.0
        for _ in range(25):
            now += GRID * rng.choice((0, 1, 1, 1, 2, 3, 6))
            if recipe.asked and rng.random() < 0.4:
                number = rng.choice([*recipe.asked])
                answer = rng.random() < 0.6
                recipe.asked[number](answer)
                recipe.world.hear(f"callable {number}", answer, now)
                carried.ask(number, now)
            else:
                topic = rng.choice([*KINDS])
                value = value_of(topic, rng)
                recipe.world.hear(topic, value, now)
                carried.take(topic, message(topic, value), now)
        # NaN is not equal to itself, but is written the same.
        said, did = (
            [repr(run) for run in sorted_runs(runs)] for runs in (recipe.world.done, carried.done)
        )
        assert did == said, f"recipe {seed}: {carried.made.table.model_dump_json(indent=1)}"
        fired += len(carried.done)
    assert fired > 300


@pytest.mark.parametrize("mistake", MISTAKES)
def test_what_cannot_be_carried_out_is_refused_in_one_sentence(mistake: str) -> None:
    writer = Writer(random.Random(mistake))
    recipe = writer.recipe()

    def read() -> None:
        MISTAKES[mistake](writer, recipe.launcher)
        Carried(recipe)

    with pytest.raises((TypeError, ValueError, AttributeError)) as told:
        read()
    assert str(told.value).strip()
    assert "\n" not in str(told.value)


def sorted_runs(runs: list[tuple[float, int, list[Any]]]) -> list[Any]:
    return sorted(runs, key=lambda run: run[:2])
