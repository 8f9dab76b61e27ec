"""Which methods of a component may be called by a rule, or by anybody on the ROS graph.

Only decorated methods are: without that, every attribute of a component would be an interface. The
recipe may open others of one's own, one by one and for its own rules, by naming them.
"""

import functools
import inspect
import json
import typing
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar, overload

from pydantic import PydanticUserError, TypeAdapter, ValidationError

from kompass.invalid import first_invalid
from kompass.rclpy_ext.messages import fill

ATTRIBUTE = "__component_action__"
Method = TypeVar("Method", bound=Callable[..., Any])


@dataclass(frozen=True)
class ActionSpec:
    """What is known of a component action.

    Attributes
    ----------
    name
        Of the method.
    active
        Whether the component must be active for it.
    description
        For people and tools; the first line of the docstring unless given.
    recipe_only
        Whether only rules of the recipe may call it.
    """

    name: str
    active: bool
    description: Any
    recipe_only: bool = False


@overload
def component_action(function: Method) -> Method: ...
@overload
def component_action(
    function: None = None,
    *,
    description: Any = None,
    active: bool = False,
    recipe_only: bool = False,
) -> Callable[[Method], Method]: ...
def component_action(
    function: Method | None = None,
    *,
    description: Any = None,
    active: bool = False,
    recipe_only: bool = False,
) -> Method | Callable[[Method], Method]:
    """Mark a method of a component as callable by rules; bare, or with arguments.

    A method that takes long is written as ``async def`` and awaits ROS futures
    (:meth:`kompass.components.Component.sleep`): the component's loop goes on meanwhile. It returns
    True for success, False for failure, or something that JSON can carry.

    Parameters
    ----------
    description
        Shown to people; the first line of the docstring unless given.
    active
        Refuse the call while the component is not active.
    recipe_only
        Refuse it to the rules that people make or change: what it does is for the recipe to say.
    """

    def mark(method: Method) -> Method:
        first_line = (inspect.getdoc(method) or method.__name__).splitlines()[0]
        spec = ActionSpec(method.__name__, active, description or first_line, recipe_only)
        setattr(method, ATTRIBUTE, spec)
        return method

    return mark if function is None else mark(function)


def actions_of(kind: type) -> Mapping[str, ActionSpec]:
    """The component actions of a class by name, inherited and overridden ones included."""
    return _actions_of(kind)


@functools.cache
def _actions_of(kind: type) -> Mapping[str, ActionSpec]:
    found: dict[str, ActionSpec] = {}
    for base in reversed(kind.__mro__):
        for name, value in vars(base).items():
            spec = getattr(value, ATTRIBUTE, None)
            if isinstance(spec, ActionSpec):
                found[name] = spec
    return found


def undecorated(kind: type, name: str, base: type) -> ActionSpec | None:
    """What is known of a public method that is not marked; None if it is one of ``base`` or none.

    It is for rules of the recipe alone.
    """
    method = getattr(kind, name, None)
    if name.startswith("_") or hasattr(base, name) or not inspect.isfunction(method):
        return None
    first_line = (inspect.getdoc(method) or name).splitlines()[0]
    return ActionSpec(name, active=False, description=first_line, recipe_only=True)


class ActionRefused(ValueError):
    """The call names no action, does not fit it, or comes at the wrong time."""


def fitted_call(
    owner: str, method: Callable[..., Any], kwargs: Mapping[str, Any]
) -> dict[str, Any]:
    """The arguments of a call that came as JSON, as ``method`` takes them.

    A mapping becomes the message that the method asks for, a list of mappings a list of them.
    Where a type is declared that JSON can have, the value must be of it.

    Raises
    ------
    ActionRefused
        When ``method`` does not take ``kwargs``; names what is wrong.
    """
    declared = _declared(getattr(method, "__func__", method), inspect.ismethod(method))
    signature, hints = declared.signature, declared.hints
    try:
        # Telling what is wrong is slower than to see that nothing is.
        if not declared.needed <= kwargs.keys() <= declared.known:
            signature.bind(**kwargs)
    except TypeError as error:
        raise ActionRefused(
            f"{owner}.{method.__name__}: {error}; it takes {signature_text(signature)}"
        ) from None
    fitted = {}
    for name, value in kwargs.items():
        try:
            fitted[name] = _fitted(hints.get(name, Any), value)
        except (ValueError, AttributeError) as error:
            why = first_invalid(error).text if isinstance(error, ValidationError) else str(error)
            raise ActionRefused(
                f"{owner}.{method.__name__}: {name} = {value!r}: {why}; it takes "
                f"{signature_text(signature)}"
            ) from None
    return fitted


class _Declared(NamedTuple):
    """What a function takes.

    Attributes
    ----------
    known, needed
        Names of the arguments that it takes by name, and of those without a default.
    """

    signature: inspect.Signature
    hints: Mapping[str, Any]
    known: frozenset[str]
    needed: frozenset[str]


# Rules call the same few again and again, and are to be quick. Kept is the function: a method
# would keep its component alive, and with it the component's place on the ROS network.
@functools.lru_cache(maxsize=256)
def _declared(function: Callable[..., Any], is_bound: bool) -> _Declared:
    try:
        hints = typing.get_type_hints(function)
    except (NameError, TypeError):
        hints = {}  # names that only the type checker sees
    signature = inspect.signature(function)
    own = list(signature.parameters.values())[is_bound:]
    by_name = [each for each in own if each.kind in (each.POSITIONAL_OR_KEYWORD, each.KEYWORD_ONLY)]
    return _Declared(
        signature.replace(parameters=own),
        hints,
        known=frozenset(each.name for each in by_name),
        # One that no name reaches makes every call one to be looked at.
        needed=frozenset(
            each.name
            for each in own
            if each.default is each.empty
            and each.kind not in (each.VAR_POSITIONAL, each.VAR_KEYWORD)
        ),
    )


# JSON has them as Python does; of texts those of ASCII: half a character (U+D800) is in none.
_AS_THEY_ARE = (bool, int, str)
_kept_adapter = functools.lru_cache(maxsize=256)(TypeAdapter)


def _adapter(hint: Any) -> TypeAdapter[Any]:
    try:
        hash(hint)
    except TypeError:  # a mapping in an Annotated
        return TypeAdapter(hint)
    return _kept_adapter(hint)


def _fitted(hint: Any, value: Any) -> Any:
    if hasattr(hint, "get_fields_and_field_types") and isinstance(value, Mapping):
        return fill(hint(), value)
    if typing.get_origin(hint) is list and isinstance(value, list):
        return [_fitted(typing.get_args(hint)[0], item) for item in value]
    if hint is int and isinstance(value, float) and value.is_integer():
        return int(value)
    is_plain = hint in _AS_THEY_ARE and type(value) is hint
    if is_plain and (hint is not str or str(value).isascii()):
        return value
    try:
        adapter = _adapter(hint)
    except PydanticUserError:
        if hasattr(hint, "get_fields_and_field_types"):
            raise ValueError(f"it is no {hint.__name__}; give its fields by name") from None
        return value  # of a type of the component's own, of which nothing is known
    adapter.validate_json(json.dumps(value), strict=True)
    return value


def signature_text(signature: inspect.Signature) -> str:
    """The parameters of a signature, as a person writes a call."""
    return f"({', '.join(map(str, signature.parameters.values()))})"
