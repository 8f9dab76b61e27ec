"""Rules as data: signals, conditions, events, actions, tables.

Whatever a rule is made of can be imported from here, except for actions
(:mod:`kompass.rules.schema.actions`); exported recipes do so.
"""

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
from kompass.rules.schema.events import Event, MaxRate, Mode, Parallel, Queued, Restart, Single
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Severity, Table

__all__ = [
    "Absent",
    "AllOf",
    "AnyOf",
    "CallableCondition",
    "Changed",
    "Compare",
    "Condition",
    "Event",
    "MaxRate",
    "Mode",
    "Not",
    "Parallel",
    "Queued",
    "Rate",
    "Received",
    "Restart",
    "Rule",
    "Severity",
    "Signal",
    "Single",
    "Table",
]
