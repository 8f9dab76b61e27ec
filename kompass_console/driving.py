"""What the commands that make many drives have in common: how far they are, how they end, and what
they leave."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import typer

from kompass_console.cli_error import CliError

BAD_INPUT, NOT_DRIVEN, INTERRUPTED = 2, 3, 130  # exit codes
PERIOD = 2.0  # s between two lines of progress where there is no terminal
Drive = TypeVar("Drive")


def with_progress(drives: Iterator[Drive], total: int) -> Iterator[Drive]:
    """Say how far it is: in one line of a terminal, or a line now and then.

    A drive is told once whoever makes something of it has done so: what was told is not lost.
    """
    terminal = sys.stderr.isatty()
    told, begun = time.monotonic(), time.monotonic()
    for done, drive in enumerate(drives, 1):
        yield drive
        now = time.monotonic()
        if terminal or now - told >= PERIOD or done == total:
            told = now
            left = (now - begun) / done * (total - done)
            text = f"{done} of {total} drives" + (f", {left:.0f} s left" if done < total else "")
            end = "\n" if not terminal or done == total else ""
            typer.echo(f"\r{text}  {end}" if terminal else text, err=True, nl=not terminal)


@contextmanager
def ended_as_by_hand() -> Iterator[None]:
    """SIGTERM, of a time limit or a service manager, ends what is inside as Ctrl-C does."""

    def end(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def check_writable(option: str, file: Path) -> None:
    """Refuse a file that cannot be written before the drives take hours.

    Raises
    ------
    CliError
        When there is no such folder, or nobody may write there.
    """
    if not file.absolute().parent.is_dir():
        raise CliError(
            BAD_INPUT, f"{option} {file}: there is no folder {file.parent}; make it first"
        )
    there = file.exists()
    try:
        file.open("a", encoding="utf-8").close()
        if not there:
            file.unlink()
    except OSError as error:
        said = f"{option} {file}: it cannot be written ({error.strerror}); give another file"
        raise CliError(BAD_INPUT, said) from None


def write_all(*files: tuple[str, Path | None, Callable[[], str]]) -> CliError | None:
    """Write what drives have told to the files of options; what one that cannot be written says.

    The others are written all the same: the drives may have taken hours.
    """
    problem: CliError | None = None
    for option, file, text in files:
        if file is None:
            continue
        try:
            file.write_text(text(), encoding="utf-8")
        except OSError as error:
            said = f"{option} {file}: it cannot be written ({error.strerror}); give another file"
            problem = problem or CliError(BAD_INPUT, said)
    return problem
