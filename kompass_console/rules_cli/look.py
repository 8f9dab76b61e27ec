"""Commands that look at the rules and change nothing."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, NoReturn

import typer

from kompass_console.cli_error import CliError
from kompass_console.rules_cli.options import ROLE, RobotOptions, command

# ROS is imported when a command runs: help answers at once.
if TYPE_CHECKING:
    from kompass.recorder.replay.explain import Explained
    from kompass_console.rules_cli.looking import Looking

FOLLOW_PERIOD = 0.5  # s between two looks at the journal
PAGE = 200  # entries that a look goes back
Format = Literal["json", "yaml", "python"]
RevisionOption = Annotated[
    int, typer.Option(min=0, help="A revision of the history; 0 for the one in force.")
]
Before = Annotated[int, typer.Option(min=0, help="Only those below this number.")]


def add_to(app: typer.Typer) -> None:
    """Add the commands."""
    command(app, "show")(show)
    command(app, "check")(check)
    command(app, "history")(history)
    command(app, "diff")(diff)
    command(app, "explain")(explain)
    command(app, "firings")(firings)
    command(app, "export")(export)
    app.command("schema")(schema)


def show(robot: RobotOptions, revision: RevisionOption = 0) -> None:
    """Show the rules, and how each is doing."""
    with robot.look() as robot_says:
        view = robot_says.table(revision)
        current = view.revision == view.active
        statuses = robot_says.statuses(view.revision) if current and not robot.json else {}
    from kompass_console.rules_cli import printing

    robot.tell(view, lambda: printing.show_table(view, statuses))


def check(
    robot: RobotOptions,
    file: Annotated[Path, typer.Argument(help="A table in JSON or YAML.")],
) -> None:
    """Say what is wrong with a table, and what applying it would do; changes nothing."""
    from kompass_console.rules_cli import printing
    from kompass_console.rules_cli.robot_refused import RobotRefused
    from kompass_console.rules_cli.table_file import TableFile

    source = TableFile(file)
    with robot.connect() as client:
        report = client.get(client.monitor.check(source.table.model_dump_json(), ROLE))

    def tell() -> None:
        printing.show_now(report)
        printing.show_findings(report.findings, map(source.locate, report.findings))
        printing.show_diff(report.diff, title=f"against revision {report.revision}")
        printing.show_effect(report.effect, done=False)

    robot.tell(report, tell)
    if not report.ok:
        raise RobotRefused(f"{file} cannot be applied; nothing was changed")


def history(
    robot: RobotOptions,
    count: Annotated[int, typer.Option(min=1, max=1000, help="At most so many.")] = 20,
    before: Before = 0,
) -> None:
    """List the revisions, newest first: who, when, why, and what changed."""
    from kompass_console.rules_cli import printing

    with robot.look() as robot_says:
        answer = robot_says.history(before, count)
    robot.tell(answer, lambda: printing.show_history(answer))


def diff(
    robot: RobotOptions,
    before: Annotated[int, typer.Argument(metavar="A", min=1, help="A revision.")],
    after: Annotated[
        int, typer.Argument(metavar="[B]", min=0, help="Another; else the one in force.")
    ] = 0,
) -> None:
    """Show what differs between two revisions."""
    from kompass_console.rules_cli import printing

    with robot.look() as robot_says:
        answer = robot_says.diff(before, after)
    title = f"from revision {answer.before} to {answer.after}"
    robot.tell(answer, lambda: printing.show_diff(answer, title=title))


def explain(
    robot: RobotOptions,
    rule: Annotated[str, typer.Argument(help="Id of a rule.")],
    run: Annotated[
        int, typer.Option(min=0, help="A firing (column 'run' of 'firings'); 0 for now.")
    ] = 0,
    epoch: Annotated[
        str, typer.Option(help="Life of the monitor that the run belongs to; else this one.")
    ] = "",
    recording: Annotated[
        Path | None,
        typer.Option(help="An MCAP file here, of a robot or a drill; no robot is asked then."),
    ] = None,
    at: Annotated[
        float | None,
        typer.Option(min=0.0, help="Second of the recording, or of the drive; else its end."),
    ] = None,
) -> None:
    """Say why a rule fires or does not: each value, its age, and what holds the rule back."""
    from kompass_console.rules_cli import printing

    if recording is not None:
        then = _explain_recorded(recording, rule, run, at)
        robot.tell(then.view, lambda: printing.show_explanation(then.view, at=then.at))
        return
    if at is not None:
        raise CliError(2, f"--at {at:g}: the past is in a --recording; give one")
    with robot.look() as robot_says:
        answer = robot_says.explain(rule, run, epoch)
    robot.tell(answer, lambda: printing.show_explanation(answer))


def _explain_recorded(recording: Path, rule: str, run: int, at: float | None) -> Explained:
    from kompass.recorder.mcap.contents import NotMcap
    from kompass.recorder.replay.backtest import NoRecording
    from kompass.recorder.replay.explain import explain_recorded

    if not recording.is_file():
        raise CliError(2, f"--recording {recording}: there is no such file; give an MCAP file")
    try:
        return explain_recorded(recording, rule, at=at, run=run)
    except (NoRecording, NotMcap) as error:
        raise CliError(1, f"{recording.name}: {error}") from None


def firings(
    robot: RobotOptions,
    rule: Annotated[str, typer.Option(help="Of this rule only.")] = "",
    count: Annotated[int, typer.Option(min=1, max=1000, help="At most so many.")] = 30,
    before: Before = 0,
    follow: Annotated[
        bool, typer.Option("--follow", "-f", help="Go on with what fires, until Ctrl-C.")
    ] = False,
) -> None:
    """List what fired, newest first, and what came of it."""
    from kompass_console.rules_cli import printing

    with robot.look() as robot_says:
        if follow:
            _follow(robot, robot_says, rule, count)
        answer = robot_says.firings(before, count, rule)
    robot.tell(answer, lambda: printing.show_firings(answer))


def _follow(robot: RobotOptions, robot_says: Looking, rule: str, count: int) -> NoReturn:
    """Print entries as they come, oldest first, and once more when their actions have ended."""
    from kompass_console.rules_cli import printing

    told: dict[int, float | None] = {}
    while True:
        wanted = max(count, PAGE) if told else count
        journal = robot_says.firings(0, wanted, rule)
        for entry in reversed(journal.firings):
            if entry.number in told and told[entry.number] == entry.ended:
                continue
            told[entry.number] = entry.ended
            if robot.json:
                typer.echo(entry.model_dump_json())
            else:
                printing.show_entry(entry)
        time.sleep(FOLLOW_PERIOD)


def export(
    robot: RobotOptions,
    format_: Annotated[
        Format, typer.Option("--format", help="JSON, YAML, or a fragment of a recipe.")
    ] = "yaml",
    revision: RevisionOption = 0,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="A new file; else the terminal.")
    ] = None,
    merge: Annotated[
        bool, typer.Option("--merge", help="The table that a changed recipe waits to merge.")
    ] = False,
) -> None:
    """Write the rules as JSON or YAML to edit and apply, or as Python for a recipe."""
    from kompass.recipe.export import export as as_text

    with robot.look() as robot_says:
        view = robot_says.table(revision)
    if merge and view.merge is None:
        raise CliError(1, "no edits wait to be merged")
    table = view.merge.table if merge and view.merge is not None else view.table
    from kompass.store.private import private_opener

    title = f"{view.robot}, revision {view.revision}"
    text = as_text(table, "json" if robot.json else format_, title=title)
    if output is None:
        typer.echo(text, nl=False)
        return
    try:
        with open(output, "x", encoding="utf-8", opener=private_opener) as file:
            file.write(text)
    except FileExistsError:
        raise CliError(2, f"{output} exists already; give a new file") from None
    except OSError as error:
        raise CliError(2, f"cannot write {output}: {error.strerror}; give another file") from None


def schema() -> None:
    """Print the JSON Schema of a table, for editors that check while one types."""
    from kompass.rules.schema.table import Table

    typer.echo(json.dumps(Table.model_json_schema(), indent=2))
