"""Refuse a recipe whose rules do not fit the robot, before anything starts."""

from __future__ import annotations

from kompass.monitor.names import name_findings
from kompass.rulebook.lint import findings_of
from kompass.rules.catalog import Catalog
from kompass.rules.check import check_table
from kompass.rules.table import Table

SHOWN = 5


def check_recipe(table: Table, catalog: Catalog) -> None:
    """Check the rules that a recipe declares.

    Raises
    ------
    ValueError
        Naming rule, field, value and remedy of each problem.
    """
    problems = [
        f"rule '{each.rule_id}': {each.field} = {each.value!r}: {each.text}; {each.remedy}"
        for each in (*name_findings(table), *findings_of(check_table(table, catalog)))
    ]
    if problems:
        more = f"; and {len(problems) - SHOWN} more" if len(problems) > SHOWN else ""
        raise ValueError("; ".join(problems[:SHOWN]) + more)
