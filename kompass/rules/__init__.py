"""The rule engine: pure functions over rules as data; no ROS, no clock, no threads, no I/O.

:func:`step` takes a message, the passing of time or the end of a run, and returns what fires. A
shell feeds it and carries out the firings; nothing else decides whether a rule fires.
"""

from kompass.rules.arbitrate import Arbitration, Lost, Running, arbitrate, components_of
from kompass.rules.arguments import ArgumentError, expand, resolve
from kompass.rules.bridge import Bridge, bridge
from kompass.rules.carry import Carried, carry, exchange
from kompass.rules.catalog import (
    ArgumentSpec,
    Catalog,
    ComponentSpec,
    FieldType,
    MethodSpec,
    ParameterSpec,
    StackCatalog,
)
from kompass.rules.check import check_rule, check_table
from kompass.rules.compiled import CompiledTable, compile_table
from kompass.rules.describe import describe
from kompass.rules.engine import initial_state, step
from kompass.rules.events import Event
from kompass.rules.explain import Explanation, Gate, explain
from kompass.rules.firing import Done, Firing, Input, LeafVerdict, Note, Output, Sample, Tick
from kompass.rules.problem import Problem
from kompass.rules.schedule import next_deadline
from kompass.rules.signals import Signal
from kompass.rules.state import Counters, State, counters
from kompass.rules.table import Rule, Severity, Table, rule_hash, table_hash

__all__ = [
    "Arbitration",
    "ArgumentError",
    "ArgumentSpec",
    "Bridge",
    "Carried",
    "Catalog",
    "CompiledTable",
    "ComponentSpec",
    "Counters",
    "Done",
    "Event",
    "Explanation",
    "FieldType",
    "Firing",
    "Gate",
    "Input",
    "LeafVerdict",
    "Lost",
    "MethodSpec",
    "Note",
    "Output",
    "ParameterSpec",
    "Problem",
    "Rule",
    "Running",
    "Sample",
    "Severity",
    "Signal",
    "StackCatalog",
    "State",
    "Table",
    "Tick",
    "arbitrate",
    "bridge",
    "carry",
    "check_rule",
    "check_table",
    "compile_table",
    "components_of",
    "counters",
    "describe",
    "exchange",
    "expand",
    "explain",
    "initial_state",
    "next_deadline",
    "resolve",
    "rule_hash",
    "step",
    "table_hash",
]
