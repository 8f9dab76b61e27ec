"""Whether rules fit the robot; a recipe whose rules do not is refused before anything starts."""

from __future__ import annotations

from kompass.monitor.tables.ros_names import name_findings
from kompass.rulebook.lint.lint import findings_of
from kompass.rulebook.schema.report import Finding
from kompass.rules.checks.catalog import Catalog
from kompass.rules.checks.check import check_rule
from kompass.rules.schema.table import Rule, Table

SHOWN = 5


def faults_of(rule: Rule, catalog: Catalog) -> tuple[Finding, ...]:
    """What makes a rule unfit for the robot that a catalog describes; empty if it fits."""
    return (*name_findings(rule), *findings_of(check_rule(rule, catalog)))


def check_recipe(table: Table, catalog: Catalog) -> None:
    """Check the rules that a recipe declares.

    Raises
    ------
    ValueError
        Naming rule, field, value and remedy of each problem.
    """
    problems = [
        f"rule '{each.rule_id}': {each.field} = {each.value!r}: {each.text}; {each.remedy}"
        for rule in table.rules
        for each in faults_of(rule, catalog)
    ]
    if problems:
        more = f"; and {len(problems) - SHOWN} more" if len(problems) > SHOWN else ""
        raise ValueError("; ".join(problems[:SHOWN]) + more)
