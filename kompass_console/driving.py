"""What the commands that make many drives have in common: how they end, and what they leave."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from kompass_console.cli_error import CliError

BAD_INPUT = 2


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
