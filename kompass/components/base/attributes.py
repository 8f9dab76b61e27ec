"""Attributes that a recipe sets on a component, and mistakes in writing them.

Python takes any name, and one that is no setting would be passed over without a word. A class of
one's own may have attributes of its own all the same; of it, what is nearly a setting is refused.
"""

import difflib
import dis
import inspect
from collections.abc import Collection
from functools import cache

from pydantic import BaseModel

from kompass.components.base.hooks import LETTERS, LIKENESS, is_ours
from kompass.settings import ignored_of


def mistaken_attribute(
    kind: type, name: str, config: BaseModel, instance: Collection[str]
) -> str | None:
    """Why setting an attribute that an object does not have yet is a mistake; None if it is none.

    Parameters
    ----------
    kind
        Class of the component.
    name
        Of the attribute.
    config
        Settings of the component.
    instance
        Names that the object has already.
    """
    if name.startswith("_") or name in instance or hasattr(kind, name) or name in _set_by(kind):
        return None
    what = f"a {kind.__name__} has no attribute '{name}'"
    fields, ignored = type(config).model_fields, ignored_of(type(config))
    if name in fields:
        return f"{what}; it is a setting: config.{name} = …"
    settable = {
        one for one in dir(kind) if getattr(inspect.getattr_static(kind, one), "fset", None)
    }
    known = {one for one in {*settable, *instance} if not one.startswith("_")}
    candidates = sorted({*known, *fields})
    if is_ours(kind):  # it sets no attributes of its own that are not known
        if name in ignored:
            return f"{what}: {ignored[name]}"
        near = difflib.get_close_matches(name, candidates, n=1)
        if not near:
            return f"{what}; known are {', '.join(sorted(settable))}, and those of config"
        remedy = ""
    else:
        near = difflib.get_close_matches(name, candidates, n=1, cutoff=LIKENESS)
        if not near or abs(len(near[0]) - len(name)) > LETTERS:
            return None
        remedy = " If it is something else, give it a name that is less like it"
    meant = near[0] if near[0] in known else f"config.{near[0]}"
    return f"{what}; did you mean '{meant}'?{remedy}"


@cache
def _set_by(kind: type) -> frozenset[str]:
    """The attributes that the methods of a class set by themselves, on whatever object."""
    return frozenset(
        step.argval
        for one in kind.__mro__
        for value in vars(one).values()
        if inspect.isfunction(method := inspect.unwrap(value) if callable(value) else value)
        for step in dis.get_instructions(method)
        if step.opname == "STORE_ATTR"
    )
