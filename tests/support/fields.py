"""Values for the fields of messages: ones that they can hold, and ones that they cannot."""

import importlib
import math
import pkgutil
import sys
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st

from kompass.field_types import field_types
from kompass.message_types import message_class
from kompass.rules.checks.catalog import FieldType

Values = st.SearchStrategy[Any]
MOST = 2  # items of a list of any length
RANGES = {
    "octet": (0, 255),
    **{f"int{n}": (-(1 << (n - 1)), (1 << (n - 1)) - 1) for n in (8, 16, 32, 64)},
    **{f"uint{n}": (0, (1 << n) - 1) for n in (8, 16, 32, 64)},
}
JUNK: Values = st.one_of(
    st.none(), st.booleans(), st.integers(-5, 5), st.just(0.5), st.just("5"), st.just({"no": 1})
)


def sendable_types() -> list[str]:
    """All messages, requests and goals of the packages that are installed, as rules name them."""
    found = set()
    packages = [
        Path(site) / each.name for site in sys.path for each in pkgutil.iter_modules([site])
    ]
    for package in {folder.name: folder for folder in packages}.values():
        for kind, part in (("msg", ""), ("srv", "Request"), ("action", "Goal")):
            # The extension that converts messages lies beside them: other packages have none.
            if not (package / kind / "__init__.py").exists() or not list(package.glob("*_s__*")):
                continue
            module = importlib.import_module(f"{package.name}.{kind}")
            for name, value in vars(module).items():
                made = getattr(value, part, None) if part else value
                if hasattr(made, "get_fields_and_field_types") and isinstance(made, type):
                    found.add(f"{package.name}/{kind}/{name}{'_' * bool(part)}{part}")
    return sorted(found)


def class_of(type_name: str) -> type[Any]:
    found = message_class(type_name)
    assert found is not None, type_name
    return found


def message_data(type_name: str, *, finite: bool = True) -> Values:
    """Values of all fields of a message, as JSON has them (and NaN, unless ``finite``)."""
    fields = field_types(class_of(type_name))
    return st.fixed_dictionaries(
        {name: values(found, finite=finite) for name, found in fields.items()}
    )


def values(found: FieldType, *, finite: bool = True) -> Values:
    """What a field can hold."""
    if found.kind == "message":
        return message_data(found.name, finite=finite)
    if found.kind == "list":
        assert found.element is not None
        most = min(MOST, found.bound or MOST)
        low, high = (0, most) if found.size is None else (found.size, found.size)
        return st.lists(values(found.element, finite=finite), min_size=low, max_size=high)
    if found.kind == "bool":
        return st.booleans()
    if found.kind == "int":
        whole = st.integers(*RANGES[found.primitive])
        return whole | st.integers(0, 100).map(float)
    if found.kind == "float":
        width = 32 if found.primitive == "float" else 64
        real = st.floats(width=width, allow_nan=not finite, allow_infinity=not finite)  # type: ignore[arg-type]
        return real | st.integers(-1000, 1000)
    text = st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=8)
    return text | st.just("$msg.data")


def misfits(found: FieldType) -> Values:
    """Pairs of what a field cannot hold and the way to what is wrong in it."""
    if found.kind == "message":
        return whole(JUNK.filter(lambda v: v != {"no": 1})) | message_misfits(found.name)
    if found.kind == "list":
        assert found.element is not None
        wrong = [whole(JUNK)]
        if found.size is not None:
            wrong.append(whole(lists(found.element, found.size + 1)))
            wrong.append(whole(lists(found.element, found.size - 1)))
        elif found.bound is not None and found.bound < 100:
            wrong.append(whole(lists(found.element, found.bound + 1)))
        count = 1 if found.size is None else found.size
        good = st.lists(values(found.element), min_size=count, max_size=count)
        return st.one_of(*wrong, st.tuples(good, misfits(found.element)).map(_in_list))
    if found.kind == "int":
        low, high = RANGES[found.primitive]
        outside = st.integers(max_value=low - 1) | st.integers(min_value=high + 1)
        junk = JUNK.filter(lambda v: isinstance(v, bool) or not isinstance(v, int))
        return whole(outside | junk | st.just(1e300))
    if found.kind == "float":
        beyond: Values = st.just(10**400)
        if found.primitive == "float":
            beyond = beyond | st.floats(min_value=3.5e38, allow_infinity=False)
        return whole(beyond | JUNK.filter(lambda v: isinstance(v, bool) or not _is_number(v)))
    if found.kind == "bool":
        return whole(JUNK.filter(lambda v: not isinstance(v, bool)))
    texts = st.sampled_from(["a\0b", "half a pair \ud800"])
    if found.bound is not None:
        texts |= st.just("é" * (found.bound // 2 + 1))
    return whole(texts | JUNK.filter(lambda v: not isinstance(v, str)))


def message_misfits(type_name: str) -> Values:
    """As :func:`misfits`, for a whole message; one of its fields is wrong."""
    fields = field_types(class_of(type_name))
    wrong = [
        st.tuples(st.just(name), misfits(found)).map(_in_message) for name, found in fields.items()
    ]
    return st.one_of(*wrong, st.just(({"no_such_field": 1}, "")))


def whole(wrong: Values) -> Values:
    return wrong.map(lambda value: (value, ""))


def lists(element: FieldType, count: int) -> Values:
    return st.lists(values(element), min_size=count, max_size=count)


def _in_list(drawn: tuple[list[Any], tuple[Any, str]]) -> tuple[list[Any], str]:
    good, (value, way) = drawn
    return [*good[:-1], value], f"[{len(good) - 1}]{way}"


def _in_message(drawn: tuple[str, tuple[Any, str]]) -> tuple[dict[str, Any], str]:
    name, (value, way) = drawn
    return {name: value}, f".{name}{way}"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float)


def literal(value: Any) -> Any:
    """A value as one writes it in a rule: a text that begins with a dollar sign gets a second."""
    if isinstance(value, str):
        return f"${value}" if value.startswith("$") else value
    if isinstance(value, list):
        return [literal(item) for item in value]
    return {k: literal(v) for k, v in value.items()} if isinstance(value, dict) else value


def as_received(found: FieldType, value: Any) -> Any:
    """What a receiver reads from a field that was given a value, as plain data."""
    if found.kind == "message":
        return message_as_received(found.name, value)
    if found.kind == "list":
        assert found.element is not None
        return [as_received(found.element, item) for item in value]
    if found.primitive == "float":
        return float(np.float32(value))
    return float(value) if found.kind == "float" else int(value) if found.kind == "int" else value


def message_as_received(type_name: str, data: dict[str, Any]) -> dict[str, Any]:
    fields = field_types(class_of(type_name))
    return {name: as_received(fields[name], value) for name, value in data.items()}


def alike(one: Any, other: Any) -> bool:
    """Whether plain data are of the same values and types; NaN is NaN, and True is not 1."""
    if type(one) is not type(other):
        return False
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(alike(one[key], other[key]) for key in one)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(alike, one, other))
    if isinstance(one, float) and math.isnan(one):
        return math.isnan(other)
    return bool(one == other)
