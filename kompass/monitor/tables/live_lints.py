"""What there is to think about in a table, on the robot as it is now."""

from __future__ import annotations

from collections.abc import Mapping

from kompass.monitor.introspection.graph import Graph
from kompass.monitor.live_engine import LiveEngine
from kompass.rulebook.lint.context import verdicts_after
from kompass.rulebook.lint.lint import lint_table
from kompass.rulebook.schema.report import Finding
from kompass.rules.engine.compiled_table import CompiledTable
from kompass.rules.schema.table import Table
from kompass.rules.schema.values import Verdict


class LiveLints:
    """Lints tables with what engine and graph know; to be called on a worker.

    Parameters
    ----------
    engine
        Its state is copied to see what a coming table would find.
    graph
        What there is on the robot.
    """

    def __init__(self, engine: LiveEngine, graph: Graph) -> None:
        self._engine, self._graph = engine, graph

    def foreseen(self, table: CompiledTable) -> list[Finding]:
        """The lints of a table that may come, as if it were in force now."""
        now, in_force, state = self._engine.snapshot()
        return self.found(table.table, verdicts_after(in_force, state, table, now))

    def found(self, table: Table, verdicts: Mapping[str, Verdict]) -> list[Finding]:
        """The lints of a table that has come.

        Parameters
        ----------
        verdicts
            What the conditions that were new to it said then, by rule id.
        """
        return lint_table(table, self._graph.facts()._replace(verdicts=verdicts))
