"""Commands that change the rules in force."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from kompass_console.rules_cli.options import (
    ROLE,
    Author,
    Probation,
    Reason,
    RobotOptions,
    Yes,
    author_of,
    command,
    probation_seconds,
)

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
    robot: RobotOptions,
    file: Annotated[Path, typer.Argument(help="A table in JSON or YAML.")],
    reason: Reason = "",
    yes: Yes = False,
    probation: Probation = "default",
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
    from kompass_console.rules_cli.hand_in import ChangeRequest, hand_in
    from kompass_console.rules_cli.table_file import TableFile

    source = TableFile(file)
    request = ChangeRequest(
        author_of(author),
        reason,
        yes,
        expected_revision,
        probation_seconds(probation),
        cancel_running,
        tuple(reset or ()),
    )
    with robot.connect() as client:
        hand_in(robot, client, source.table, request, source.locate)


def confirm(
    robot: RobotOptions,
    revision: Annotated[int, typer.Argument(min=0, help="It; else the one in force.")] = 0,
    author: Author = None,
) -> None:
    """Keep the revision that is on probation."""
    who = author_of(author)
    with robot.connect() as client:
        number = revision or client.get(client.monitor.table()).active
        said = client.wait(client.monitor.confirm(number, author=who, role=ROLE))
    typer.echo(said)


def rollback(
    robot: RobotOptions,
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
    from kompass_console.rules_cli.hand_in import agree, or_say_why_not

    who = author_of(author)
    with robot.connect() as client:
        active = client.get(client.monitor.table()).active
        if revision and not robot.json:
            change = client.get(client.monitor.diff(active, revision))
            printing.show_diff(change, title=f"from revision {active} back to {revision}")
        agree(robot, yes, f"go back to {f'revision {revision}' if revision else 'the one before'}?")
        applied = or_say_why_not(
            robot,
            client,
            lambda: client.monitor.roll_back(
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
    robot: RobotOptions,
    rule: Annotated[str, typer.Argument(help="Id of a rule.")],
    author: Author = None,
) -> None:
    """Let a rule start afresh: its once, its cooldown and its rate limit."""
    who = author_of(author)
    with robot.connect() as client:
        typer.echo(client.wait(client.monitor.reset(rule, author=who, role=ROLE)))


def _show_rolled_back(applied: Any) -> None:
    from kompass_console.rules_cli import printing

    printing.show_diff(applied.diff)
    printing.show_applied(applied)
