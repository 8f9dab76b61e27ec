"""A signal: one value inside the messages of one topic."""

from collections.abc import Callable
from operator import attrgetter, itemgetter
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from kompass.rules.schema.model import Model, PositiveSeconds, TopicName, TypeName
from kompass.rules.schema.values import MISSING, finite_numbers, of_field

# Imported where messages are read: the command line, which only shows rules, is to begin at once.
if TYPE_CHECKING:
    import numpy as np

Aggregate = Literal["min", "max", "mean", "len", "any", "all"]
FieldName = Annotated[str, Field(pattern=r"^[A-Za-z_]\w*$")]
Index = Annotated[int, Field(ge=-1_000_000, le=1_000_000)]
Path = tuple[FieldName | Index, ...]

# A field that is not there is not an error: arrays are empty, and unions of messages exist.
_ABSENT = (AttributeError, IndexError, KeyError, TypeError)


class Signal(Model):
    """One value inside the messages of a topic.

    Attributes
    ----------
    topic
        Name of the topic; a leading slash makes no difference.
    type
        Message type, ``package/msg/Name``.
    path
        Field names and indices from the message to the value; empty for the whole message.
    aggregate
        What to make of an array: ``min``, ``max`` and ``mean`` over its finite values, ``len``
        (all values counted), ``any`` and ``all`` (of finite values: is not zero). An array without
        finite values has no ``min``, ``max``, ``mean`` and ``all``: the verdict is unknown.
    timeout
        Seconds after which a value no longer counts; ``None`` for a latched topic, whose last
        message stays true until the next.
    """

    topic: TopicName
    type: TypeName
    path: Path = ()
    aggregate: Aggregate | None = None
    timeout: PositiveSeconds | None = 1.0


def path_text(path: tuple[str | int, ...]) -> str:
    """Return a path as one writes it: ``poses[0].position.x``."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def reader(path: tuple[str | int, ...], aggregate: str | None) -> Callable[[Any], Any]:
    """Make the function that reads a signal from a message; ``MISSING`` where there is none."""
    steps = _steps(path)
    reduce = _REDUCTIONS[aggregate] if aggregate else of_field
    if len(steps) == 1 and aggregate is None:
        step = steps[0]

        def read_one(message: Any) -> Any:
            try:
                value = step(message)
            except _ABSENT:
                return MISSING
            return value if type(value) is float or type(value) is int else of_field(value)

        return read_one

    def read(message: Any) -> Any:
        try:
            for step in steps:
                message = step(message)
        except _ABSENT:
            return MISSING
        return reduce(message)

    return read


def _steps(path: tuple[str | int, ...]) -> list[Callable[[Any], Any]]:
    steps: list[Callable[[Any], Any]] = []
    names: list[str] = []
    for part in path:
        if isinstance(part, str):
            names.append(part)
            continue
        if names:
            steps.append(attrgetter(".".join(names)))
            names = []
        steps.append(itemgetter(part))
    if names:
        steps.append(attrgetter(".".join(names)))
    return steps


def _finite(value: Any) -> "np.ndarray[Any, np.dtype[np.float64]] | None":
    """Return the finite values of an array-like, or None if it is not one."""
    if isinstance(value, (str, int, float)) or not hasattr(value, "__len__"):
        return None
    import numpy as np

    if type(value) is list:
        value = of_field(value)  # of bytes, which NumPy would take for digits
    try:
        # A buffer (array.array, the common case of a scan) is read without a copy per element.
        values = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        values = np.asarray(finite_numbers(value), dtype=np.float64)
    return values[np.isfinite(values)]


def _length(value: Any) -> Any:
    return len(value) if hasattr(value, "__len__") else MISSING


def _minimum(value: Any) -> Any:
    values = _finite(value)
    return MISSING if values is None or not values.size else float(values.min())


def _maximum(value: Any) -> Any:
    values = _finite(value)
    return MISSING if values is None or not values.size else float(values.max())


def _mean(value: Any) -> Any:
    values = _finite(value)
    return MISSING if values is None or not values.size else float(values.mean())


def _any(value: Any) -> Any:
    values = _finite(value)
    return MISSING if values is None else bool(values.any())


def _all(value: Any) -> Any:
    values = _finite(value)
    return MISSING if values is None or not values.size else bool(values.all())


_REDUCTIONS: dict[str, Callable[[Any], Any]] = {
    "len": _length,
    "min": _minimum,
    "max": _maximum,
    "mean": _mean,
    "any": _any,
    "all": _all,
}
