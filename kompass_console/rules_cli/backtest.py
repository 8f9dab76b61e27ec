"""The command that tries a table on what the robot has recorded."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kompass_console.rules_cli.options import ROLE, RobotOptions, command


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
        str, typer.Option(help="An MCAP file on the robot; else the flight recorder's ring.")
    ] = "",
    seconds: Annotated[float, typer.Option(min=0.0, help="The last ones of it; 0 for all.")] = 0.0,
) -> None:
    """Try a table on a recording: what would have fired, had it been applied at its start."""
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from kompass_console.rules_cli import printing
    from kompass_console.rules_cli.table_file import TableFile

    table = None if file is None else TableFile(file).table
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
