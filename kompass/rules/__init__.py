"""The rule engine: pure functions over rules as data; no ROS, no clock, no threads, no I/O.

Three rooms. ``schema``: rules as pydantic data (signals, conditions, events, actions, tables).
``engine``: a table compiled, and the state that :func:`step` changes. ``checks``: what in a rule
does not fit the robot. ``engine`` and ``checks`` import ``schema``; nothing else of ours is.

One message: a shell calls ``step(table, state, Sample(topic, message), now)`` (``engine/step.py``).
What became due before comes first (``schedule.py``). Each field that a rule uses is read once; the
comparisons that its new value can change (``leaf_index.py``) are evaluated (``predicates.py``).
Rules whose leaves changed are evaluated as trees; ``once``, cooldown, mode and rate limit
(``runs.py``) decide whether a :class:`Firing` comes out (``firing.py``). The shell settles
who gets which component (``arbitrate.py``), runs the actions and reports :class:`RunEnded`.
"""

from kompass.rules.checks.catalog import (
    ArgumentSpec,
    Catalog,
    ComponentSpec,
    FieldType,
    MethodSpec,
    ParameterSpec,
    StackCatalog,
)
from kompass.rules.checks.check import check_rule, check_table
from kompass.rules.checks.problem import Problem
from kompass.rules.engine.arbitrate import Arbitration, Outranked, Running, arbitrate, components_of
from kompass.rules.engine.compiled_table import CompiledTable, compile_table
from kompass.rules.engine.explain import Explanation, Gate, explain
from kompass.rules.engine.firing import (
    Firing,
    Input,
    LeafVerdict,
    Note,
    Output,
    RunEnded,
    Sample,
    Tick,
)
from kompass.rules.engine.migration import (
    Migration,
    MigrationReport,
    migrate_state,
    plan_migration,
    swap,
)
from kompass.rules.engine.schedule import next_deadline
from kompass.rules.engine.state import Counters, EngineState, counters
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema import actions
from kompass.rules.schema.arguments import ArgumentError, expand, resolve
from kompass.rules.schema.describe import describe
from kompass.rules.schema.events import Event
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Severity, Table, rule_hash, table_hash

__all__ = [
    "Arbitration",
    "ArgumentError",
    "ArgumentSpec",
    "Catalog",
    "CompiledTable",
    "ComponentSpec",
    "Counters",
    "EngineState",
    "Event",
    "Explanation",
    "FieldType",
    "Firing",
    "Gate",
    "Input",
    "LeafVerdict",
    "MethodSpec",
    "Migration",
    "MigrationReport",
    "Note",
    "Output",
    "Outranked",
    "ParameterSpec",
    "Problem",
    "Rule",
    "RunEnded",
    "Running",
    "Sample",
    "Severity",
    "Signal",
    "StackCatalog",
    "Table",
    "Tick",
    "actions",
    "arbitrate",
    "check_rule",
    "check_table",
    "compile_table",
    "components_of",
    "counters",
    "describe",
    "expand",
    "explain",
    "initial_state",
    "migrate_state",
    "next_deadline",
    "plan_migration",
    "resolve",
    "rule_hash",
    "step",
    "swap",
    "table_hash",
]
