"""What the shell knows of the robot, in the terms in which rules are checked against it.

The engine knows no message definitions and no components; the shell brings them as a
:class:`Catalog`.
"""

from collections.abc import Collection, Iterable, Mapping
from typing import Literal, NamedTuple, Protocol, runtime_checkable

from pydantic import JsonValue

FieldKind = Literal["bool", "int", "float", "text", "message", "list"]
# Sort of an argument or a parameter; `any` where it is not known.
ValueKind = Literal["bool", "int", "float", "text", "list", "object", "any"]


class FieldType(NamedTuple):
    """Type of a field.

    Attributes
    ----------
    kind
        What sort of value it holds.
    name
        Name of the message type, for ``message``.
    element
        Type of the elements, for ``list``.
    primitive
        Of IDL (``octet``, ``uint8``, ``float`` …), for what is neither list nor message; empty
        where only the sort is known.
    size
        How many elements a list has, if it always has as many.
    bound
        How many elements a list, or characters a text, has at most; None for any number.
    """

    kind: FieldKind
    name: str = ""
    element: "FieldType | None" = None
    primitive: str = ""
    size: int | None = None
    bound: int | None = None


class ArgumentSpec(NamedTuple):
    """An argument of a method.

    Attributes
    ----------
    kind
        Sort of its value.
    required
        Whether a call must give it.
    options
        The values it may have; empty if it may have any of its kind.
    element
        Sort of the items of a list.
    message
        Type of the message whose fields it is, for an ``object``; empty for any mapping.
    """

    name: str
    kind: ValueKind = "any"
    required: bool = True
    default: JsonValue = None
    text: str = ""
    options: tuple[JsonValue, ...] = ()
    element: ValueKind = "any"
    message: str = ""


class MethodSpec(NamedTuple):
    """A method of a component.

    Attributes
    ----------
    open
        Whether it takes arguments beside those that are named.
    recipe_only
        Whether only rules of the recipe may call it.
    """

    name: str
    arguments: tuple[ArgumentSpec, ...] = ()
    text: str = ""
    open: bool = False
    recipe_only: bool = False


class ParameterSpec(NamedTuple):
    """A parameter of a component; ``name`` with dots for one inside of another.

    Attributes
    ----------
    kind
        Sort of its value.
    minimum, maximum
        Bounds of a number, both included; None for none.
    options
        The values it may have; empty if it may have any of its kind.
    optional
        Whether it may be null.
    element
        Sort of the items of a list.
    """

    name: str
    kind: ValueKind = "any"
    value: JsonValue = None
    text: str = ""
    minimum: float | None = None
    maximum: float | None = None
    options: tuple[JsonValue, ...] = ()
    optional: bool = False
    element: ValueKind = "any"


class ComponentSpec(NamedTuple):
    """A component of the stack: what rules may call, and what they may change.

    Attributes
    ----------
    ignored
        Names of parameters that only older files may give a value, and why it has no effect.
    gate
        Whether it stands before the wheels.
    hears, speaks
        The topics of its inputs and of its outputs, without the leading slash.
    serves
        The actions that it serves, without the leading slash.
    takes_goals
        Whether one of these takes the places that the robot is sent to.
    """

    name: str
    kind: str = ""
    methods: Mapping[str, MethodSpec] = {}
    parameters: Mapping[str, ParameterSpec] = {}
    ignored: Mapping[str, str] = {}
    gate: bool = False
    hears: frozenset[str] = frozenset()
    speaks: frozenset[str] = frozenset()
    serves: frozenset[str] = frozenset()
    takes_goals: bool = False


class Catalog(Protocol):
    """The message definitions that the shell knows."""

    def field_type(self, type_name: str, path: tuple[str | int, ...]) -> FieldType | None:
        """Return the type at a path of a message type; None if there is no such path.

        The empty path gives the message itself, or None if the type is not known.
        """

    def fields(self, type_name: str) -> Iterable[str]:
        """Return the names of the fields of a message type; empty if it is not known."""


@runtime_checkable
class StackCatalog(Catalog, Protocol):
    """A catalog that knows the components and the recipe's functions too."""

    def components(self) -> Mapping[str, ComponentSpec]:
        """Return the components of the stack by node name."""

    def functions(self) -> Collection[str]:
        """Return the names of the recipe's functions that rules may call or poll."""
