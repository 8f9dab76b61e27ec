"""One drill in a process of its own, with all that it forks."""

from __future__ import annotations

import fcntl
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from pydantic import ValidationError

from kompass.drills.runner.program import DRILL_LINE, DrillOrder, Failed, Finished, Progress

_PREFIX = "kompass-drills-"
_LONGEST_LINE = 32 << 20  # bytes; the report of 200 pairs takes a fifth of that
_MOST_LINES = 10_000

DrillNews = Progress | Failed | Finished


class DrillProcess:
    """Runs an order, and tells what the program says of it.

    Parameters
    ----------
    order
        What to try; its starter is this process.
    limit
        Seconds after which it is ended.
    heard
        Called with each line, in a thread of this; the last is the end, one way or the other.
    """

    def __init__(self, order: DrillOrder, limit: float, heard: Callable[[DrillNews], None]) -> None:
        self._order, self._heard = order, heard
        self._lock = threading.Lock()
        self._group: int | None = None  # of the processes that run
        self._why = ""  # it was ended from here
        self._timer = threading.Timer(limit, self.end, [_too_long(limit)])
        self._timer.daemon = True
        # The kernel ends the program with the thread that started it: it must be this one, which
        # stays until the program has ended.
        self._thread = threading.Thread(target=self._run, daemon=True, name="drill")
        self._thread.start()

    def end(self, why: str) -> None:
        """End it and all that it has forked; it fails for this reason."""
        with self._lock:
            self._why = self._why or why
            self._kill()

    def join(self) -> None:
        """Wait until nothing is left of it."""
        self._thread.join()

    def _kill(self) -> None:
        if self._group is not None:
            os.killpg(self._group, signal.SIGKILL)

    def _run(self) -> None:
        self._timer.start()
        try:
            last = self._follow()
        except OSError as error:
            last = Failed(text=f"The drill could not be started: {error.strerror}.")
        finally:
            self._timer.cancel()
        self._heard(Failed(text=self._why) if self._why else last)

    def _follow(self) -> Failed | Finished:
        """Start the program and hear it to its end; what came of it."""
        # Who is killed tidies nothing up: what drives leave goes with this folder.
        with (
            _own_folder() as folder,
            subprocess.Popen(
                [sys.executable, "-m", "kompass.drills.runner.program"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env={**os.environ, "TMPDIR": folder},
                process_group=0,  # to be ended whole; in the robot's session, to which it gives way
            ) as program,
        ):
            with self._lock:
                self._group = program.pid
                if self._why:
                    self._kill()
            try:
                return self._converse(program)
            finally:
                # The program is not waited for yet, so its number cannot mean another's group.
                with self._lock:
                    self._kill()
                    self._group = None

    def _converse(self, program: subprocess.Popen[bytes]) -> Failed | Finished:
        assert program.stdin is not None
        assert program.stdout is not None
        try:
            program.stdin.write(self._order.model_dump_json().encode())
            program.stdin.close()
        except BrokenPipeError:
            return _without_a_word()
        for _ in range(_MOST_LINES):
            line = program.stdout.readline(_LONGEST_LINE)
            if not line:
                return _without_a_word()
            try:
                news = DRILL_LINE.validate_json(line)
            except ValidationError:
                break
            if not isinstance(news, Progress):
                return news
            self._heard(news)
        return Failed(
            text="The drill said more than can be taken; make fewer drives, or use "
            "kompass-console drill."
        )


@contextmanager
def _own_folder() -> Iterator[str]:
    """A folder for what drives leave; those of consoles that were killed go with it.

    It is locked for as long as its owner lives, whoever that is and in whatever container.
    """
    for left in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*"):
        with suppress(OSError), _locked(left):
            shutil.rmtree(left, ignore_errors=True)
    with (
        tempfile.TemporaryDirectory(prefix=_PREFIX, ignore_cleanup_errors=True) as folder,
        _locked(Path(folder)),
    ):
        yield folder


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Raises OSError where somebody else has locked it, or it is not ours."""
    opened = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    finally:
        os.close(opened)


def _without_a_word() -> Failed:
    return Failed(
        text="The drill ended without a word: perhaps the machine ran out of memory, or somebody "
        "killed it. The console's log may say more."
    )


def _too_long(limit: float) -> str:
    return (
        f"It took longer than {limit / 60:g} min, and was ended; make fewer drives, or use "
        "kompass-console drill."
    )
