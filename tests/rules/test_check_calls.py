"""A rule that calls what is not there, or gives it what it does not take, is refused."""

from collections.abc import Collection, Mapping
from typing import Any

import pytest

from kompass.rules.checks.catalog import ArgumentSpec, ComponentSpec, MethodSpec, ParameterSpec
from kompass.rules.checks.check import check_rule
from kompass.rules.schema.actions import (
    Lifecycle,
    Log,
    Method,
    Publish,
    Python,
    Reconfigure,
    UpdateParameters,
)
from kompass.rules.schema.conditions import CallableCondition
from tests.rules.building import compare, rule
from tests.rules.test_check import Definitions

CONTROLLER = ComponentSpec(
    "controller",
    methods={
        "follow": MethodSpec(
            "follow", (ArgumentSpec("speed", "float"), ArgumentSpec("loop", "bool", False, False))
        ),
        "unblock": MethodSpec("unblock", open=True),
    },
    parameters={
        "algorithm": ParameterSpec("algorithm", "text", options=("DWA", "Stanley", "$5")),
        "loop_rate": ParameterSpec("loop_rate", "float", minimum=1.0, maximum=100.0),
        "use_direct_sensor": ParameterSpec("use_direct_sensor", "bool"),
        "span": ParameterSpec("span", "int", optional=True),
        "robot.radius": ParameterSpec("robot.radius", "float"),
        "extra": ParameterSpec("extra", "object"),
    },
)


class Stack(Definitions):
    def components(self) -> Mapping[str, ComponentSpec]:
        return {"controller": CONTROLLER}

    def functions(self) -> Collection[str]:
        return {"say_hello"}


def problems(action: Any) -> list[str]:
    made = rule(compare("t", "<", 1), actions=(action,))
    found = check_rule(made, Stack())
    return [str(p) for p in found if p.field.startswith("actions")]


@pytest.mark.parametrize(
    "action",
    [
        Log(text="!"),
        Method(component="controller", method="follow", kwargs={"speed": 1}),
        Method(component="controller", method="follow", kwargs={"speed": "$msg.x", "loop": True}),
        Method(component="controller", method="unblock", kwargs={"anything": 1}),
        Method(component="controller", method="restart", kwargs={"wait_time": 1.0}),
        Lifecycle(component="controller", action="stop"),
        UpdateParameters(component="controller", parameters={"loop_rate": 10, "span": None}),
        UpdateParameters(component="controller", parameters={"robot.radius": 0.1, "extra.a": 1}),
        UpdateParameters(component="controller", parameters={"robot": {"radius": 0.1}}),
        UpdateParameters(component="controller", parameters={"algorithm": "$$5"}),
        Reconfigure(component="controller", config="controller.yaml"),
        Reconfigure(component="controller", config={"algorithm": "DWA"}),
        Python(name="say_hello"),
    ],
)
def test_what_is_there_may_be_called(action: Any) -> None:
    assert problems(action) == []


@pytest.mark.parametrize(
    ("action", "complaint"),
    [
        (Lifecycle(component="controler", action="stop"), "did you mean 'controller'?"),
        (Method(component="planner", method="x"), "no component 'planner'; known are: controller"),
        (Method(component="controller", method="folow"), "did you mean 'follow'?"),
        (Method(component="controller", method="follow"), "needs the argument 'speed'"),
        (
            Method(component="controller", method="follow", kwargs={"speed": "fast"}),
            "argument 'speed' of follow is a number",
        ),
        (
            Method(component="controller", method="follow", kwargs={"speed": 1, "sped": 1}),
            "takes no argument 'sped'; did you mean 'speed'?",
        ),
        (
            UpdateParameters(component="controller", parameters={"use_direct_sensr": True}),
            "did you mean 'use_direct_sensor'?",
        ),
        (
            UpdateParameters(component="controller", parameters={"use_direct_sensor": 1}),
            "is true or false",
        ),
        (
            UpdateParameters(component="controller", parameters={"algorithm": "DVA"}),
            "did you mean 'DWA'?",
        ),
        (UpdateParameters(component="controller", parameters={"loop_rate": 0.5}), "at least 1"),
        (UpdateParameters(component="controller", parameters={"loop_rate": None}), "is a number"),
        (Reconfigure(component="controller", config={"loop_rte": 5}), "mean 'loop_rate'?"),
        (Python(name="say_helo"), "did you mean 'say_hello'?"),
        (
            Publish(topic="o", type="p/msg/Status", message={"status": "bad"}),
            "'status' is an integer; give an integer",
        ),
        (Publish(topic="o", type="p/msg/Path", message={"poses": [{"z": 1}]}), "has no field 'z'"),
        (Publish(topic="o", type="p/msg/Path", message={"start": 1}), "give a message"),
    ],
)
def test_what_is_not_there_or_does_not_fit_is_named_with_its_remedy(
    action: Any, complaint: str
) -> None:
    (problem,) = problems(action)
    assert complaint in problem
    assert "actions[0]" in problem


def test_a_polled_function_must_be_one_of_the_recipe() -> None:
    (problem,) = check_rule(rule(CallableCondition(name="say_helo")), Stack())
    assert (problem.code, problem.value) == ("unknown-function", "say_helo")


def test_a_catalog_of_messages_alone_says_nothing_of_components() -> None:
    made = rule(CallableCondition(name="f"), actions=(Lifecycle(component="x", action="stop"),))
    assert check_rule(made, Definitions()) == []
