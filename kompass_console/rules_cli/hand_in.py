"""Hand a table in: check it, show what it changes, ask, apply; or say why not."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import typer

from kompass.rulebook.schema.report import ApplyReport, CheckReport, Conflict, Finding
from kompass.rules.schema.model import Model
from kompass.rules.schema.table import Table
from kompass_console.cli_error import CliError
from kompass_console.rules_cli.options import ROLE, RobotOptions

# ROS is imported when a command runs: help answers at once.
if TYPE_CHECKING:
    from kompass.monitor.client import Applied
    from kompass.rclpy_ext.reply import Reply
    from kompass_console.rules_cli.connection import MonitorConnection


class ChangeRequest(NamedTuple):
    """What goes with a table.

    Attributes
    ----------
    expected
        Revision that must be in force; 0 for whatever is when it is checked.
    probation
        Seconds; 0 for none, negative for the robot's default.
    reset
        Ids of unchanged rules that start afresh.
    """

    author: str
    reason: str = ""
    yes: bool = False
    expected: int = 0
    probation: float = -1.0
    cancel_running: bool = False
    reset: tuple[str, ...] = ()


def hand_in(
    robot: RobotOptions,
    client: MonitorConnection,
    table: Table,
    request: ChangeRequest,
    locate: Callable[[Finding], str] | None = None,
) -> None:
    """Put a table in force, and tell of it.

    Parameters
    ----------
    locate
        Tells a finding with its place in a file.

    Raises
    ------
    RobotRefused
        When the robot does not take it; nothing was changed.
    CliError
        When nobody agreed.
    """
    from kompass_console.rules_cli import printing
    from kompass_console.rules_cli.robot_refused import RobotRefused

    text = table.model_dump_json()
    report = client.get(client.monitor.check(text, ROLE))
    if not robot.json:
        printing.show_now(report)
        printing.show_diff(report.diff, title=f"against revision {report.revision}")
        printing.show_findings(report.findings, map(locate, report.findings) if locate else None)
    if not report.ok:
        tell_json(robot, report)
        raise RobotRefused("this table cannot be applied; nothing was changed")
    expected = request.expected or report.revision
    if expected == report.revision and not report.diff.changes and not request.reset:
        tell_json(robot, report)
        if not robot.json:
            typer.echo(f"nothing was applied: revision {report.revision} is the same")
        return
    agree(robot, request.yes, f"apply this to revision {expected}?")
    applied = or_say_why_not(
        robot,
        client,
        lambda: client.monitor.apply(
            text,
            expected=expected,
            author=request.author,
            role=ROLE,
            reason=request.reason,
            probation=request.probation,
            cancel_running=request.cancel_running,
            reset=request.reset,
        ),
    )
    robot.tell(applied, lambda: printing.show_applied(applied))


def or_say_why_not(
    robot: RobotOptions, client: MonitorConnection, change: Callable[[], Reply[Applied]]
) -> ApplyReport:
    """Make a change; print why in full when it was not made.

    Raises
    ------
    RobotRefused
        When it was not made.
    """
    from kompass_console.rules_cli import printing
    from kompass_console.rules_cli.robot_refused import RobotRefused

    try:
        return client.wait(change()).report.parsed()
    except RobotRefused as refused:
        body = refused.body
        if robot.json and body is not None:
            tell_json(robot, body)
        elif isinstance(body, Conflict):
            printing.show_conflict(body)
        elif isinstance(body, CheckReport):
            printing.show_findings(body.findings)
        raise


def agree(robot: RobotOptions, yes: bool, question: str) -> None:
    """Ask a person; a script has to say so beforehand.

    Raises
    ------
    CliError
        When nobody can be asked, or the answer is no.
    """
    if yes:
        return
    if robot.json or not sys.stdin.isatty():
        raise CliError(2, "nobody can be asked here whether to go on; add --yes")
    if not typer.confirm(question):
        raise CliError(1, "nothing was changed")


def tell_json(robot: RobotOptions, body: Model) -> None:
    """Print a model where JSON was asked for."""
    if robot.json:
        typer.echo(body.model_dump_json(indent=2))
