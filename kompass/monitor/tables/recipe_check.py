"""Whether rules fit the robot; a recipe whose rules do not is refused before anything starts."""

from __future__ import annotations

from collections.abc import Iterator

from rclpy.exceptions import InvalidTopicNameException
from rclpy.validate_topic_name import validate_topic_name

from kompass.rulebook.lint.lint import findings_of
from kompass.rulebook.schema.report import Finding
from kompass.rules.checks.catalog import Catalog
from kompass.rules.checks.check import check_rule
from kompass.rules.schema.actions import CallService, CancelGoal, Publish, SendGoal, topics_in
from kompass.rules.schema.conditions import CallableCondition, leaves, topic_of
from kompass.rules.schema.table import Rule, Table

SHOWN = 5  # problems that are told


def faults_of(rule: Rule, catalog: Catalog) -> tuple[Finding, ...]:
    """What makes a rule unfit for the robot that a catalog describes; empty if it fits."""
    return (*_name_findings(rule), *findings_of(check_rule(rule, catalog)))


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


def _name_findings(rule: Rule) -> Iterator[Finding]:
    """The names of topics, services and action servers that ROS refuses, as errors."""
    for field, name in dict.fromkeys(_names(rule)):
        try:
            validate_topic_name(name)
        except InvalidTopicNameException as error:
            yield Finding(
                level="error",
                code="invalid-name",
                rule_id=rule.id,
                field=field,
                value=name,
                text=str(error).splitlines()[0].removeprefix("Invalid topic name: "),
                remedy="use letters, digits, '_' and '/', as in 'front/scan'",
            )


def _names(rule: Rule) -> Iterator[tuple[str, str]]:
    event = rule.event
    for field, condition in (("event.condition", event.condition), ("event.clear", event.clear)):
        for _, leaf in () if condition is None else leaves(condition):
            if not isinstance(leaf, CallableCondition):
                yield field, topic_of(leaf)
    for index, action in enumerate(rule.actions):
        where = f"actions[{index}]"
        for topic in topics_in(action):
            yield where, topic
        if isinstance(action, Publish):
            yield f"{where}.topic", action.topic
        elif isinstance(action, CallService):
            yield f"{where}.service", action.service
        elif isinstance(action, SendGoal | CancelGoal):
            yield f"{where}.action", action.action
