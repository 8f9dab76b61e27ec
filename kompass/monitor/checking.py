"""Refuse a recipe whose rules do not fit the robot, before anything starts."""

from __future__ import annotations

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
    problems = check_table(table, catalog)
    if problems:
        more = f"; and {len(problems) - SHOWN} more" if len(problems) > SHOWN else ""
        raise ValueError("; ".join(map(str, problems[:SHOWN])) + more)
