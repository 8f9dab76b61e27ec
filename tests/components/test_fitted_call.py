"""A call of a component's method is accepted exactly when the method takes it."""

import inspect
import json
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from kompass.components.base.actions import ActionRefused, fitted_call


class Robot:
    """Methods of all shapes."""

    def nothing(self) -> None: ...
    def two(self, a: Any, b: Any) -> None: ...
    def one_of_two(self, a: Any, b: Any = 1) -> None: ...
    def by_name(self, *, a: Any, b: Any = 1) -> None: ...
    def by_place(self, a: Any, /, b: Any) -> None: ...
    def by_place_or_not(self, a: Any = 1, /, b: Any = 2) -> None: ...
    def any_others(self, a: Any, **others: Any) -> None: ...
    def by_place_and_others(self, a: Any, /, **others: Any) -> None: ...
    def any_number(self, *a: Any, b: Any = 1) -> None: ...
    def true(self, value: bool) -> None: ...
    def whole(self, value: int) -> None: ...
    def real(self, value: float) -> None: ...
    def text(self, value: str) -> None: ...


ROBOT = Robot()
SHAPES = [
    *(ROBOT.nothing, ROBOT.two, ROBOT.one_of_two, ROBOT.by_name, ROBOT.by_place),
    *(ROBOT.by_place_or_not, ROBOT.any_others, ROBOT.by_place_and_others, ROBOT.any_number),
]
TYPED: dict[type, Callable[..., Any]] = {
    bool: ROBOT.true,
    int: ROBOT.whole,
    float: ROBOT.real,
    str: ROBOT.text,
}


@pytest.mark.parametrize("method", SHAPES, ids=lambda method: method.__name__)
@given(names=st.sets(st.sampled_from(["a", "b", "c", "self"])))
def test_the_names_are_those_that_the_method_takes(
    method: Callable[..., Any], names: set[str]
) -> None:
    kwargs = dict.fromkeys(names, 0)
    try:
        inspect.signature(method).bind(**kwargs)
    except TypeError:
        with pytest.raises(ActionRefused, match="it takes"):
            fitted_call("robot", method, kwargs)
    else:
        assert fitted_call("robot", method, kwargs) == kwargs


@pytest.mark.parametrize("hint", TYPED, ids=lambda hint: hint.__name__)
@given(
    value=st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False)
    | st.text(st.characters())
    | st.just("half \ud800 a character")
    | st.lists(st.integers(), max_size=2)
)
def test_a_value_is_of_the_declared_type_as_json_knows_it(hint: type, value: Any) -> None:
    whole = hint is int and isinstance(value, float) and value.is_integer()
    try:
        if not whole:
            TypeAdapter(hint).validate_json(json.dumps(value), strict=True)
    except ValidationError:
        with pytest.raises(ActionRefused, match="value ="):
            fitted_call("robot", TYPED[hint], {"value": value})
    else:
        fitted = fitted_call("robot", TYPED[hint], {"value": value})["value"]
        assert fitted == value
        assert type(fitted) is (int if whole else type(value))
