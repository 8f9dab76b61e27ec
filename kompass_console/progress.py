"""How far a command with many drives is."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from typing import TypeVar

import typer

PERIOD = 2.0  # s between two lines of progress where there is no terminal
Drive = TypeVar("Drive")


def with_progress(drives: Iterator[Drive], total: int) -> Iterator[Drive]:
    """Say how far it is: in one line of a terminal, or a line now and then."""
    terminal = sys.stderr.isatty()
    told, begun = time.monotonic(), time.monotonic()
    for done, drive in enumerate(drives, 1):
        now = time.monotonic()
        if terminal or now - told >= PERIOD or done == total:
            told = now
            left = (now - begun) / done * (total - done)
            text = f"{done} of {total} drives" + (f", {left:.0f} s left" if done < total else "")
            end = "\n" if not terminal or done == total else ""
            typer.echo(f"\r{text}  {end}" if terminal else text, err=True, nl=not terminal)
        yield drive
