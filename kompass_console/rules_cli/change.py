"""Commands that change the rules in force."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from kompass.rules.model import Model
from kompass_console.problem import Problem
from kompass_console.rules_cli.options import (
    ROLE,
    Author,
    Robot,
    author_of,
    command,
    probation_seconds,
)
from kompass_console.rules_cli.table_file import TableFile

Reason = Annotated[str, typer.Option("--reason", "-m", help="Why, for the history.")]
Yes = Annotated[bool, typer.Option("--yes", "-y", help="Do not ask.")]
CancelRunning = Annotated[
    bool,
    typer.Option(
        "--cancel-running",
        help="Cancel the running actions of rules that change, instead of letting them finish.",
    ),
]


def add_to(app: typer.Typer) -> None:
    """Add the commands."""
    command(app, "apply")(apply)
    command(app, "confirm")(confirm)
    command(app, "rollback")(rollback)
    command(app, "reset")(reset)


def apply(
    robot: Robot,
    file: Annotated[Path, typer.Argument(help="A table in JSON or YAML.")],
    reason: Reason = "",
    yes: Yes = False,
    probation: Annotated[
        str,
        typer.Option(
            metavar="SECONDS|off",
            help="It is taken back after so many seconds unless confirmed; else the robot's "
            "default.",
            show_default=False,
        ),
    ] = "default",
    expected_revision: Annotated[
        int,
        typer.Option(min=0, help="Apply only while this revision is in force; else the current."),
    ] = 0,
    cancel_running: CancelRunning = False,
    reset: Annotated[
        list[str] | None,
        typer.Option(metavar="RULE", help="Let an unchanged rule start afresh; may be repeated."),
    ] = None,
    author: Author = None,
) -> None:
    """Put a table in force: all of it between two messages, or nothing."""
    from kompass_console.rules_cli import printing
    from kompass_console.rules_cli.client import Refused

    wait, who, source = probation_seconds(probation), author_of(author), TableFile(file)
    with robot.connect() as client:
        report = client.check(source.table, ROLE)
        if not robot.json:
            printing.show_diff(report.diff, title=f"against revision {report.revision}")
            printing.show_findings(report.findings, map(source.locate, report.findings))
        if not report.ok:
            _print(robot, report)
            raise Refused(f"{file} cannot be applied; nothing was changed")
        expected = expected_revision or report.revision
        if expected == report.revision and not report.diff.changes and not reset:
            _print(robot, report)
            if not robot.json:
                typer.echo(f"nothing was applied: revision {report.revision} is the same")
            return
        _ask(robot, yes, f"apply this to revision {expected}?")
        applied = _or_conflict(
            robot,
            lambda: client.apply(
                source.table,
                expected=expected,
                author=who,
                role=ROLE,
                reason=reason,
                probation=wait,
                cancel_running=cancel_running,
                reset=reset or [],
            ),
        )
    robot.tell(applied, lambda: printing.show_applied(applied))


def confirm(
    robot: Robot,
    revision: Annotated[int, typer.Argument(min=0, help="It; else the one in force.")] = 0,
    author: Author = None,
) -> None:
    """Keep the revision that is on probation."""
    who = author_of(author)
    with robot.connect() as client:
        said = client.confirm(revision or client.table().active, author=who, role=ROLE)
    typer.echo(said)


def rollback(
    robot: Robot,
    revision: Annotated[
        int, typer.Argument(min=0, help="Whose table to take; else the one before.")
    ] = 0,
    reason: Reason = "",
    yes: Yes = False,
    expected_revision: Annotated[
        int, typer.Option(min=0, help="Only while this revision is in force; else the current.")
    ] = 0,
    cancel_running: CancelRunning = False,
    author: Author = None,
) -> None:
    """Put the table of an earlier revision in force again."""
    from kompass_console.rules_cli import printing

    who = author_of(author)
    with robot.connect() as client:
        active = client.table().active
        if revision and not robot.json:
            change = client.diff(active, revision)
            printing.show_diff(change, title=f"from revision {active} back to {revision}")
        _ask(robot, yes, f"go back to {f'revision {revision}' if revision else 'the one before'}?")
        applied = _or_conflict(
            robot,
            lambda: client.rollback(
                revision,
                expected=expected_revision or active,
                author=who,
                role=ROLE,
                reason=reason,
                cancel_running=cancel_running,
            ),
        )
    robot.tell(applied, lambda: _show_rolled_back(applied))


def reset(
    robot: Robot,
    rule: Annotated[str, typer.Argument(help="Id of a rule.")],
    author: Author = None,
) -> None:
    """Let a rule start afresh: its once, its cooldown and its rate limit."""
    who = author_of(author)
    with robot.connect() as client:
        typer.echo(client.reset(rule, author=who, role=ROLE))


def _show_rolled_back(applied: Any) -> None:
    from kompass_console.rules_cli import printing

    printing.show_diff(applied.diff)
    printing.show_applied(applied)


def _or_conflict(robot: Robot, change: Any) -> Any:
    """Make a change; print why in full when it was not made."""
    from kompass.rulebook.report import CheckReport, Conflict
    from kompass_console.rules_cli import printing
    from kompass_console.rules_cli.client import Refused

    try:
        return change()
    except Refused as refused:
        body = refused.body
        if robot.json and body is not None:
            _print(robot, body)
        elif isinstance(body, Conflict):
            printing.show_conflict(body)
        elif isinstance(body, CheckReport):
            printing.show_findings(body.findings)
        raise


def _print(robot: Robot, body: Model) -> None:
    if robot.json:
        typer.echo(body.model_dump_json(indent=2))


def _ask(robot: Robot, yes: bool, question: str) -> None:
    """Ask a person; a script has to say so beforehand.

    Raises
    ------
    Problem
        When nobody can be asked, or the answer is no.
    """
    if yes:
        return
    if robot.json or not sys.stdin.isatty():
        raise Problem(2, "nobody can be asked here whether to go on; add --yes")
    if not typer.confirm(question):
        raise Problem(1, "nothing was changed")
