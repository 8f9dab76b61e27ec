"""Which functions of the recipe rules name: code that nobody can edit."""

from collections.abc import Iterator

from kompass.rules.schema.actions import Python
from kompass.rules.schema.conditions import CallableCondition, leaves
from kompass.rules.schema.table import Rule, Table


def functions_in(rule: Rule) -> Iterator[str]:
    """Walk the names of the functions that a rule calls, or asks for its condition."""
    for action in rule.actions:
        if isinstance(action, Python):
            yield action.name
    for condition in (rule.event.condition, rule.event.clear):
        for _, leaf in leaves(condition) if condition is not None else ():
            if isinstance(leaf, CallableCondition):
                yield leaf.name


def functions_of(table: Table) -> set[str]:
    """Return the names of all functions that a table names."""
    return {name for rule in table.rules for name in functions_in(rule)}


def has_code(rule: Rule) -> bool:
    """Whether a rule names a function of the recipe."""
    return next(functions_in(rule), None) is not None
