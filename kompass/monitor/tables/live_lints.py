"""What there is to think about in a table, on the robot as it is now."""

from __future__ import annotations

from collections.abc import Mapping

from kompass.monitor.engine_loop import EngineLoop
from kompass.monitor.introspection.graph import Graph
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rulebook.lint.context import verdicts_after
from kompass.rulebook.lint.lint import lint_table
from kompass.rulebook.schema.report import Finding
from kompass.rules.engine.compiled_table import CompiledTable
from kompass.rules.engine.state import EngineState
from kompass.rules.schema.table import Table
from kompass.rules.schema.values import Verdict


class LiveLints:
    """A :class:`kompass.monitor.tables.table_validator.Lints`; called on a worker.

    The engine's thread only copies its state, and nothing for a table that is in force already.
    """

    def __init__(self, main: MainThread, loop: EngineLoop, graph: Graph) -> None:
        self._main, self._loop, self._graph = main, loop, graph

    def foreseen(self, table: CompiledTable) -> list[Finding]:
        """The lints of a table, if it were in force now."""
        now, compiled, state = self._main.call(self._snapshot)
        return self.found(table.table, verdicts_after(compiled, state, table, now))

    def found(self, table: Table, verdicts: Mapping[str, Verdict]) -> list[Finding]:
        """The lints of a table whose new conditions say this."""
        return lint_table(table, self._graph.facts()._replace(verdicts=verdicts))

    def _snapshot(self) -> tuple[float, CompiledTable, EngineState]:
        return self._loop.now, self._loop.table, self._loop.state.copy()
