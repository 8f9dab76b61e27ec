"""What there is to think about in a table, on the robot as it is now."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from kompass.monitor.inputs.previews import Previews
from kompass.monitor.inputs.rule_inputs import topics_of
from kompass.monitor.introspection.graph import Graph
from kompass.monitor.live_engine import LiveEngine
from kompass.rulebook.lint.lint import lint_table
from kompass.rulebook.outlook import Outlook, outlook
from kompass.rulebook.schema.report import Finding
from kompass.rules.engine.compiled_table import CompiledTable
from kompass.rules.schema.table import Table
from kompass.rules.schema.values import Verdict


class Foreseen(NamedTuple):
    """A table that may come, as if it were applied now.

    Attributes
    ----------
    findings
        Its lints.
    outlook
        What it would do at once.
    """

    findings: list[Finding]
    outlook: Outlook


class LiveLints:
    """Lints tables with what engine and graph know; to be called on a worker.

    Parameters
    ----------
    engine
        Its state is copied to see what a coming table would find.
    graph
        What there is on the robot.
    previews
        Hears what only a coming table looks at.
    """

    def __init__(self, engine: LiveEngine, graph: Graph, previews: Previews) -> None:
        self._engine, self._graph, self._previews = engine, graph, previews

    def unheard(self, table: CompiledTable) -> dict[str, str]:
        """The topics with their types that only a coming table looks at."""
        listened = self._engine.in_force.by_topic
        return {name: kind for name, kind in topics_of(table).items() if name not in listened}

    def foreseen(self, table: CompiledTable) -> Foreseen:
        """A table that may come, as if it were applied now.

        What only it looks at is known as far as the previews have heard it.
        """
        others = self.unheard(table)
        heard = self._previews.newest(others) if others else {}
        now, in_force, state = self._engine.snapshot()
        facts = self._graph.facts()
        rates = {name: each.rate for name, each in (facts.topics or {}).items() if each.rate}
        look = outlook(in_force, state, table, now, rates=rates, heard=heard)
        found = lint_table(table.table, facts._replace(verdicts=look.verdicts))
        return Foreseen(found, look)

    def found(self, table: Table, verdicts: Mapping[str, Verdict]) -> list[Finding]:
        """The lints of a table that has come.

        Parameters
        ----------
        verdicts
            What the conditions that were new to it said then, by rule id.
        """
        return lint_table(table, self._graph.facts()._replace(verdicts=verdicts))
