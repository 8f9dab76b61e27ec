"""Which methods of a component may be called by a rule, or by anybody on the ROS graph.

Only decorated methods are: without that, every attribute of a component would be an interface. The
recipe may open others of one's own, one by one and for its own rules, by naming them.
"""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar, overload

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


def check_call(owner: str, method: Callable[..., Any], kwargs: Mapping[str, Any]) -> None:
    """Raise ActionRefused, naming what is wrong, when ``method`` does not take ``kwargs``."""
    signature = inspect.signature(method)
    try:
        signature.bind(**kwargs)
    except TypeError as error:
        raise ActionRefused(
            f"{owner}.{method.__name__}: {error}; it takes {signature_text(signature)}"
        ) from None


def signature_text(signature: inspect.Signature) -> str:
    """The parameters of a signature, as a person writes a call."""
    return f"({', '.join(map(str, signature.parameters.values()))})"
