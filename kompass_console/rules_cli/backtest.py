"""The command that tries a table on what the robot has recorded."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kompass_console.cli_error import CliError
from kompass_console.rules_cli.options import ROLE, RobotOptions, command

# ROS is imported when a command runs: help answers at once.
if TYPE_CHECKING:
    from kompass.rules.schema.table import Table


def add_to(app: typer.Typer) -> None:
    """Add the command."""
    command(app, "backtest")(backtest)


def backtest(
    robot: RobotOptions,
    file: Annotated[
        Path | None,
        typer.Argument(help="A table in JSON or YAML; else the one in force."),
    ] = None,
    recording: Annotated[
        str,
        typer.Option(
            help="A recording on the robot, or an MCAP file here, for which no robot is asked; "
            "else the flight recorder's ring."
        ),
    ] = "",
    seconds: Annotated[float, typer.Option(min=0.0, help="The last ones of it; 0 for all.")] = 0.0,
) -> None:
    """Try a table on a recording: what would have fired, had it been applied at its start."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from kompass_console.rules_cli import printing
    from kompass_console.rules_cli.table_file import TableFile

    table = None if file is None else TableFile(file).table
    here = Path(recording)
    if here.suffix == ".mcap" and here.is_file():
        _on_file(robot, table, here, seconds)
        return
    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeElapsedColumn(),
        console=printing.console(error=True),
        transient=True,
        disable=robot.json,
    )
    with robot.connect() as client, bar:
        if table is not None and not robot.json:
            # The recording tells of then; somebody who is about to apply it asks about now, too.
            printing.show_now(client.get(client.monitor.check(table.model_dump_json(), ROLE)))
        task = bar.add_task("back-test", total=1.0)

        def show(progress: float, text: str) -> None:
            bar.update(task, completed=progress, description=text or "back-test")

        answer = client.backtest(
            (table or client.get(client.monitor.table()).table).model_dump_json(),
            recording=recording,
            seconds=seconds,
            progress=show,
        )
    robot.tell(answer, lambda: printing.show_backtest(answer))


def _on_file(robot: RobotOptions, table: Table | None, recording: Path, seconds: float) -> None:
    from kompass.recorder.mcap.contents import NotMcap
    from kompass.recorder.replay.backtest import NoRecording, backtest_files
    from kompass_console.rules_cli import printing

    if table is None:
        raise CliError(2, f"--recording {recording}: it is a file here; give the table to try, too")
    try:
        report, remark = backtest_files(table, [recording], seconds)
    except (NoRecording, NotMcap) as error:
        raise CliError(1, f"{recording.name}: {error}") from None
    if remark:
        typer.echo(f"▲ {remark}", err=True)
    robot.tell(report, lambda: printing.show_backtest(report))
