"""Conditions as data: what must be true for a rule to fire.

A verdict is true, false or unknown (Kleene). A leaf is unknown while its topic was never received
or its value is older than the signal's timeout; ``not`` of unknown is unknown; unknown never fires.
"""

from collections.abc import Iterator
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from kompass.rules.schema.model import Model, Name, PositiveSeconds, Scalar, TopicName, TypeName
from kompass.rules.schema.signals import Signal

Operator = Literal[
    "==",
    "!=",
    "<",
    "<=",
    ">",
    ">=",
    "in",
    "not_in",
    "between",
    "contains",
    "contains_any",
    "contains_all",
    "not_contains",
    "not_contains_any",
    "not_contains_all",
]
# Operators whose literal is one scalar, and those whose literal is a list of them.
_ONE = frozenset({"<", "<=", ">", ">="})
_MANY = frozenset(
    {"between", "contains_any", "contains_all", "not_contains_any", "not_contains_all"}
)
_LARGEST = 2**1023  # of whole numbers to which a float can be added


class Compare(Model):
    """A value against a literal.

    ``in`` and ``not_in`` take a list of options, or a text to look in. ``contains`` looks for an
    element of a list or a part of a text; with a list it means ``contains_all``. ``between`` takes
    two bounds and includes both. ``tolerance`` (in the unit of the field) is for ``==`` and ``!=``.
    """

    kind: Literal["compare"] = "compare"
    signal: Signal
    operator: Operator
    value: Scalar | tuple[Scalar, ...]
    tolerance: Annotated[float, Field(ge=0.0)] = 0.0

    @model_validator(mode="after")
    def _literal_fits_operator(self) -> Self:
        is_list = isinstance(self.value, tuple)
        if self.operator in _ONE and (is_list or isinstance(self.value, bool)):
            raise ValueError(f"value {self.value!r}: '{self.operator}' takes one number or text")
        if self.operator in _MANY and not is_list:
            raise ValueError(f"value {self.value!r}: '{self.operator}' takes a list")
        if self.operator in ("in", "not_in") and not isinstance(self.value, (tuple, str)):
            raise ValueError(f"value {self.value!r}: '{self.operator}' takes a list of options")
        if self.tolerance and self.operator not in ("==", "!="):
            raise ValueError(
                f"tolerance {self.tolerance!r}: only '==' and '!=' take one; "
                f"move the bound of '{self.operator}' instead"
            )
        if self.tolerance:
            self._check_tolerated()
        if self.operator == "between":
            self._check_bounds()
        elif is_list and not self.value and self.operator not in ("==", "!="):
            raise ValueError(f"value []: '{self.operator}' needs at least one item")
        return self

    def _check_tolerated(self) -> None:
        for value in self.value if isinstance(self.value, tuple) else (self.value,):
            if isinstance(value, int) and abs(value) > _LARGEST:
                raise ValueError(
                    f"value {value!r}: no tolerance can be added to a number beyond all floats; "
                    "give a smaller one, or leave the tolerance out"
                )

    def _check_bounds(self) -> None:
        bounds = self.value
        assert isinstance(bounds, tuple)
        numbers = [b for b in bounds if isinstance(b, (int, float)) and not isinstance(b, bool)]
        if len(bounds) != 2 or len(numbers) != 2 or numbers[0] > numbers[1]:
            raise ValueError(f"value {bounds!r}: 'between' takes two numbers, the lower one first")


class Changed(Model):
    """True for the one message whose value differs from the one before; never for the first.

    ``deadband`` (in the unit of the field) is how far a number must move from the value that
    counted last, so that a slow drift is noticed and noise is not.
    """

    kind: Literal["changed"] = "changed"
    signal: Signal
    deadband: Annotated[float, Field(ge=0.0)] = 0.0


class Received(Model):
    """True for each message as it arrives, and false between messages."""

    kind: Literal["received"] = "received"
    signal: Signal


class Absent(Model):
    """True once nothing was received for ``seconds``: the only leaf that asks for silence.

    A message counts if it has the value of ``signal`` (``detections[0]`` of an empty list does
    not). With ``from_start`` a topic that never spoke counts as silent from the start; without, it
    is unknown until its first message.
    """

    kind: Literal["absent"] = "absent"
    signal: Signal
    seconds: PositiveSeconds
    from_start: bool = True


class Rate(Model):
    """True while messages arrive slower (or faster) than a rate, over a sliding window.

    Unknown until one window has passed since the first message. Exactly one of ``below`` and
    ``above`` (Hz) is given.
    """

    kind: Literal["rate"] = "rate"
    topic: TopicName
    type: TypeName | None = None
    below: Annotated[float, Field(gt=0.0)] | None = None
    above: Annotated[float, Field(gt=0.0)] | None = None
    window: Annotated[float, Field(gt=0.0, le=3600.0)] = 1.0

    @model_validator(mode="after")
    def _one_bound(self) -> Self:
        if (self.below is None) == (self.above is None):
            raise ValueError(
                f"below={self.below!r}, above={self.above!r}: give exactly one of them"
            )
        bound = self.below if self.below is not None else self.above
        assert bound is not None
        if bound * self.window > 100_000:
            raise ValueError(
                f"{bound} Hz over {self.window} s is more than 100000 messages; shorten the window"
            )
        return self


class CallableCondition(Model):
    """A function of the recipe, asked at ``rate`` Hz; its answers arrive as samples.

    The shell feeds each answer as a sample of the topic ``callable/<name>`` whose message is the
    answer itself.
    """

    kind: Literal["callable"] = "callable"
    name: Name
    rate: Annotated[float, Field(gt=0.0)] | None = None
    timeout: PositiveSeconds | None = None

    @property
    def topic(self) -> str:
        """Name of the pseudo topic on which the answers arrive."""
        return f"callable/{self.name}"


class AllOf(Model):
    """True when all are true; false as soon as one is false."""

    kind: Literal["all"] = "all"
    conditions: Annotated[tuple["Condition", ...], Field(min_length=1)]


class AnyOf(Model):
    """True as soon as one is true; false when all are false."""

    kind: Literal["any"] = "any"
    conditions: Annotated[tuple["Condition", ...], Field(min_length=1)]


class Not(Model):
    """The opposite; unknown stays unknown."""

    kind: Literal["not"] = "not"
    condition: "Condition"


Leaf: TypeAlias = Compare | Changed | Received | Absent | Rate | CallableCondition
Condition: TypeAlias = Annotated[
    Compare | Changed | Received | Absent | Rate | CallableCondition | AllOf | AnyOf | Not,
    Field(discriminator="kind"),
]

for _model in (AllOf, AnyOf, Not):
    _model.model_rebuild()

TreePath: TypeAlias = tuple[int, ...]


def children(condition: Condition) -> tuple[Condition, ...]:
    """Return the direct sub-conditions; none for a leaf."""
    if isinstance(condition, (AllOf, AnyOf)):
        return condition.conditions
    return (condition.condition,) if isinstance(condition, Not) else ()


def leaves(condition: Condition, at: TreePath = ()) -> Iterator[tuple[TreePath, Leaf]]:
    """Walk the leaves from left to right, each with the child indices that lead to it."""
    if isinstance(condition, (AllOf, AnyOf, Not)):
        for index, child in enumerate(children(condition)):
            yield from leaves(child, (*at, index))
    else:
        yield at, condition


def topic_of(leaf: Leaf) -> str:
    """Return the topic that a leaf listens to."""
    if isinstance(leaf, (Rate, CallableCondition)):
        return leaf.topic
    return leaf.signal.topic


def timeout_of(leaf: Leaf) -> float | None:
    """Seconds after which the leaf's value no longer counts; None if it never goes stale."""
    if isinstance(leaf, (Absent, Rate)):
        return None
    return leaf.timeout if isinstance(leaf, CallableCondition) else leaf.signal.timeout
