"""Conditions as a person would write them: ``min(scan.ranges) < 0.3``."""

from kompass.rules.schema.conditions import (
    Absent,
    AllOf,
    AnyOf,
    CallableCondition,
    Changed,
    Compare,
    Condition,
    Not,
    Rate,
    Received,
)
from kompass.rules.schema.model import Scalar
from kompass.rules.schema.signals import Signal, path_text


def describe(condition: Condition) -> str:
    """Return one line of text for a condition; brackets only where they are needed."""
    if isinstance(condition, AllOf):
        return " and ".join(_inner(c, condition) for c in condition.conditions)
    if isinstance(condition, AnyOf):
        return " or ".join(_inner(c, condition) for c in condition.conditions)
    if isinstance(condition, Not):
        return f"not {_inner(condition.condition, condition)}"
    if isinstance(condition, Compare):
        return _compare(condition)
    if isinstance(condition, Changed):
        by = f" by more than {condition.deadband:g}" if condition.deadband else ""
        return f"{describe_signal(condition.signal)} changed{by}"
    if isinstance(condition, Received):
        return f"{describe_signal(condition.signal)} received"
    if isinstance(condition, Absent):
        return f"{describe_signal(condition.signal)} absent for {condition.seconds:g} s"
    if isinstance(condition, Rate):
        side, bound = ("below", condition.below) if condition.below else ("above", condition.above)
        return f"rate of {condition.topic} {side} {bound:g} Hz over {condition.window:g} s"
    return _callable(condition)


def describe_signal(signal: Signal) -> str:
    """Return a signal as text: ``min(scan.ranges)``, ``path.poses[0].pose``."""
    path = path_text(signal.path)
    joint = "" if not path or path.startswith("[") else "."
    text = f"{signal.topic}{joint}{path}"
    return f"{signal.aggregate}({text})" if signal.aggregate else text


def _callable(condition: CallableCondition) -> str:
    # A name that tells functions apart ends with what does: `near (limit=0.5)`.
    return condition.name if condition.name.endswith(")") else f"{condition.name}()"


def _inner(condition: Condition, outer: AllOf | AnyOf | Not) -> str:
    text = describe(condition)
    composite = isinstance(condition, (AllOf, AnyOf)) and len(condition.conditions) > 1
    spaced = isinstance(outer, Not) and not isinstance(condition, (Not, CallableCondition))
    return f"({text})" if spaced or (composite and condition.kind != outer.kind) else text


def _compare(condition: Compare) -> str:
    signal, value = describe_signal(condition.signal), condition.value
    if condition.operator == "between":
        assert isinstance(value, tuple)
        return f"{_literal(value[0])} <= {signal} <= {_literal(value[1])}"
    text = f"{signal} {condition.operator.replace('_', ' ')} {_literal(value)}"
    return f"{text} (±{condition.tolerance:g})" if condition.tolerance else text


def _literal(value: Scalar | tuple[Scalar, ...]) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_literal(item) for item in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return f'"{value}"' if isinstance(value, str) else _number(value)


def _number(value: float) -> str:
    """The short form, where it is the same number: two that differ are told apart."""
    try:
        short = f"{value:g}"
    except OverflowError:  # a whole number beyond all floats
        return str(value)
    return short if float(short) == value else str(value)
