"""``kompass-console audit``: who did what on this robot, and whether its log is whole."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import typer

from kompass_console.cli_error import CliError

FOLLOW_PERIOD = 0.5  # s between two looks
EXIT_CODES = """
Exit codes: 0 done and the log is whole, 1 the log is broken or cannot be read, 2 something in the
command is wrong.
"""

app = typer.Typer(
    name="audit",
    help="Who did what through the console, on this robot.",
    epilog=EXIT_CODES,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Name = Annotated[
    str | None,
    typer.Option(help="The robot; needed only where several have a log."),
]
DataDir = Annotated[
    Path | None,
    typer.Option(help="Where robots keep their data; else as for 'run'.", show_default=False),
]


@app.callback(invoke_without_command=True)
def show(
    context: typer.Context,
    count: Annotated[int, typer.Option(min=1, help="How many lines, the newest.")] = 50,
    follow: Annotated[bool, typer.Option("--follow", "-f", help="Go on with new lines.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print lines as they are kept.")] = False,
    text: Annotated[str, typer.Option(help="Only lines that hold this.")] = "",
    name: Name = None,
    data_dir: DataDir = None,
) -> None:
    """Who did what through the console, on this robot: the newest lines, oldest first."""
    if context.invoked_subcommand is not None:
        return
    from kompass_console.audit.read import lines_after, newest

    folder = _folder(name, data_dir)
    try:
        lines, _ = newest(folder, count=count, text=text)
        _print(reversed(lines), as_json)
        last = max((line["seq"] for line in lines), default=0)
        while follow:
            time.sleep(FOLLOW_PERIOD)
            fresh = lines_after(folder, last)
            last = max((line["seq"] for line in fresh), default=last)
            wanted = text.casefold()
            _print((line for line in fresh if wanted in json.dumps(line).casefold()), as_json)
    except OSError as error:
        raise CliError(1, f"cannot read {folder}: {error.strerror}") from None


@app.command()
def verify(
    file: Annotated[
        Path | None,
        typer.Argument(help="An exported file or another folder; else this robot's log."),
    ] = None,
    known: Annotated[
        str | None,
        typer.Option(
            metavar="LINE:SHA256",
            help="A line as an earlier 'verify' printed it; it must be there unchanged.",
            show_default=False,
        ),
    ] = None,
    name: Name = None,
    data_dir: DataDir = None,
) -> None:
    """Follow the chain from line to line and name the first broken link."""
    from kompass_console.audit.verify import verify as follow_chain

    path = file or _folder(name, data_dir)
    try:
        verdict = follow_chain(path, _known(known))
    except OSError as error:
        raise CliError(1, f"cannot read {path}: {error.strerror}") from None
    for note in verdict.notes:
        typer.echo(f"note: {note}")
    if verdict.broken:
        raise CliError(1, f"the audit log in {path} is broken: {verdict.broken}")
    if verdict.last is None:
        typer.echo(f"{path} has no lines")
        return
    typer.echo(
        f"whole: {verdict.lines} lines, {verdict.first} to {verdict.last.seq}\n"
        f"the last is {verdict.last.seq}:{verdict.last.digest}"
    )


def _known(given: str | None) -> tuple[int, str] | None:
    if given is None:
        return None
    number, _, found = given.partition(":")
    if not number.isdigit() or len(found) != 64:
        raise CliError(2, f"--known {given}: give it as LINE:SHA256, as 'audit verify' prints it")
    return int(number), found.lower()


def _folder(name: str | None, root: Path | None) -> Path:
    """The audit log that is meant: the named robot's, else the only one there is."""
    from kompass.store.errors import StoreUnwritable
    from kompass.store.paths import DATA_DIR, ROBOT_NAME, data_dir, robot_folder
    from kompass_console.audit.files import FOLDER, audit_folder

    environment = dict(os.environ)
    if root is not None:
        environment[DATA_DIR] = str(root.absolute())
    if name is not None:
        environment[ROBOT_NAME] = name
    try:
        folder, robots = audit_folder(environment), data_dir(environment)
    except StoreUnwritable as error:
        raise CliError(2, str(error)) from None
    if folder.is_dir():
        return folder
    there = [] if environment.get(ROBOT_NAME) else sorted(robots.glob(f"*/{FOLDER}"))
    if len(there) == 1:
        return there[0]
    if there:
        known = ", ".join(each.parent.name for each in there)
        raise CliError(2, f"several robots have an audit log in {robots}; --name one of: {known}")
    raise CliError(
        1, f"there is no audit log in {robot_folder(environment)}; give --name or --data-dir"
    )


def _print(lines: Iterable[dict[str, Any]], as_json: bool) -> None:
    for line in lines:
        typer.echo(json.dumps(line) if as_json else _sentence(line))
    sys.stdout.flush()


def _sentence(line: dict[str, Any]) -> str:
    """One line for a terminal. What people typed is in it: nothing that steers a terminal is."""
    shown = ("seq", "time", "who", "role", "session", "from", "what", "outcome", "prev")
    more = {key: value for key, value in line.items() if key not in shown}
    role = f" ({line['role']} {line.get('session', '')})".replace(" )", ")") if line["role"] else ""
    place = f" from {line['from']}" if line.get("from") else ""
    details = f"  {json.dumps(more)}" if more else ""
    text = f"{line['time']}  {line['who']}{role}{place}: {line['what']}: {line['outcome']}{details}"
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)
