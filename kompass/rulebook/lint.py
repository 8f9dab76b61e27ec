"""What is probably not meant so: forbids nothing, and says what to do instead."""

from collections.abc import Iterable

from kompass.rulebook.lint_context import LintContext
from kompass.rulebook.report import Finding
from kompass.rules.problem import Problem
from kompass.rules.table import Table


def lint_table(table: Table, context: LintContext) -> list[Finding]:
    """Return what is to be thought about, rule by rule; disabled rules are left alone."""
    return []


def findings_of(problems: Iterable[Problem]) -> list[Finding]:
    """Return the problems of :func:`kompass.rules.check.check_table` as errors."""
    return [
        Finding(
            level="error",
            code=problem.code,
            rule_id=problem.rule_id,
            field=problem.field,
            value=problem.value,
            text=problem.text,
            remedy=problem.remedy,
        )
        for problem in problems
    ]
