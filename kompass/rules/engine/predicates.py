"""Comparisons and trees compiled to functions, because they run for every message."""

from collections.abc import Callable
from typing import Any, Protocol, TypeAlias

from kompass.rules.schema.conditions import (
    AllOf,
    AnyOf,
    Compare,
    Condition,
    Not,
    TreePath,
    children,
)
from kompass.rules.schema.values import Verdict, compare, kind_of

Predicate: TypeAlias = Callable[[Any], Verdict]


class Verdicts(Protocol):
    """The verdicts of leaves, by their index."""

    def __getitem__(self, index: int, /) -> Verdict: ...


# From the verdicts of the leaves of a table to the verdict of one tree.
Evaluate: TypeAlias = Callable[[Verdicts], Verdict]


def predicate_of(condition: Compare) -> Predicate:
    """Return the function from a value to a verdict; common cases get one of their own."""
    operator, tolerance = condition.operator, condition.tolerance
    reference: Any = condition.value
    if isinstance(reference, tuple):
        reference = list(reference)

    def general(value: Any) -> Verdict:
        return compare(operator, value, reference, tolerance)

    if kind_of(reference) != "number" or tolerance:
        return general
    # For a float or an int the generic path would only add look-ups; NaN takes it, for no verdict.
    numeric = _NUMERIC.get(operator)
    return numeric(reference, general) if numeric else general


def _less(reference: float, general: Predicate) -> Predicate:
    def less(v: Any) -> Verdict:
        return v < reference if type(v) in _NUMBERS and v == v else general(v)

    return less


def _less_equal(reference: float, general: Predicate) -> Predicate:
    def less_equal(v: Any) -> Verdict:
        return v <= reference if type(v) in _NUMBERS and v == v else general(v)

    return less_equal


def _greater(reference: float, general: Predicate) -> Predicate:
    def greater(v: Any) -> Verdict:
        return v > reference if type(v) in _NUMBERS and v == v else general(v)

    return greater


def _greater_equal(reference: float, general: Predicate) -> Predicate:
    def greater_equal(v: Any) -> Verdict:
        return v >= reference if type(v) in _NUMBERS and v == v else general(v)

    return greater_equal


def _equal(reference: float, general: Predicate) -> Predicate:
    def equal(v: Any) -> Verdict:
        return v == reference if type(v) in _NUMBERS and v == v else general(v)

    return equal


def _unequal(reference: float, general: Predicate) -> Predicate:
    def unequal(v: Any) -> Verdict:
        return v != reference if type(v) in _NUMBERS and v == v else general(v)

    return unequal


_NUMBERS = frozenset({int, float})
_NUMERIC: dict[str, Callable[[float, Predicate], Predicate]] = {
    "<": _less,
    "<=": _less_equal,
    ">": _greater,
    ">=": _greater_equal,
    "==": _equal,
    "!=": _unequal,
}


def tree_of(condition: Condition, index: dict[TreePath, int], at: TreePath = ()) -> Evaluate:
    """Compile a tree.

    Parameters
    ----------
    condition
        The tree, or a sub-tree of it.
    index
        Index into the verdicts for the path of each leaf; -1 stands for a leaf taken as true.
    at
        Path of ``condition`` in its tree.
    """
    if isinstance(condition, Not):
        inner = tree_of(condition.condition, index, (*at, 0))

        def opposite(verdicts: Verdicts) -> Verdict:
            verdict = inner(verdicts)
            return None if verdict is None else not verdict

        return opposite
    if isinstance(condition, (AllOf, AnyOf)):
        parts = [tree_of(c, index, (*at, i)) for i, c in enumerate(children(condition))]
        return _joined(parts, decisive=isinstance(condition, AnyOf))
    leaf = index[at]
    if leaf < 0:
        return lambda _: True
    return lambda verdicts: verdicts[leaf]


def _joined(parts: list[Evaluate], decisive: bool) -> Evaluate:
    # `any` is decided by one true, `all` by one false; else one unknown makes it unknown.
    otherwise = not decisive

    def joined(verdicts: Verdicts) -> Verdict:
        result: Verdict = otherwise
        for part in parts:
            verdict = part(verdicts)
            if verdict is decisive:
                return decisive
            if verdict is None:
                result = None
        return result

    return joined
