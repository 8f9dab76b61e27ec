"""``kompass-console`` many times in one process, which keeps what takes seconds to import.

What a command says, and the code it ends with, are those of a process of its own; that it is one
is for other tests. What drives are forked from is kept from one drill to the next, too.
"""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

from tests.support.patience import patient
from tests.support.processes import end_with_parent

T = TypeVar("T")

_PROGRAM = """
import json, os, sys
from kompass_console.cli import main
answers = os.fdopen(int(sys.argv[1]), "w")
for line in sys.stdin:
    sys.argv = ["kompass-console", *json.loads(line)]
    code = 0
    try:
        main()
    except SystemExit as ended:
        code = ended.code or 0
    sys.stdout.flush()
    sys.stderr.flush()
    print(json.dumps(code), file=answers, flush=True)
"""


class Done(NamedTuple):
    """A command that has ended."""

    returncode: int
    stdout: str
    stderr: str


class Commands:
    """Runs commands, one after the other."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="kompass-commands-")
        # Whatever the command starts writes there, too.
        self._files = [Path(self._folder.name, name) for name in ("stdout", "stderr")]
        self._answers, theirs = os.pipe()
        with self._files[0].open("ab") as stdout, self._files[1].open("ab") as stderr:
            self._process = subprocess.Popen(
                [sys.executable, "-c", _PROGRAM, str(theirs)],
                stdin=subprocess.PIPE,
                stdout=stdout,
                stderr=stderr,
                pass_fds=[theirs],
                preexec_fn=end_with_parent,
                text=True,
            )
        os.close(theirs)

    def run(self, *arguments: str | Path, timeout: float = 60.0) -> Done:
        """``kompass-console ARGUMENTS``, which ends within ``timeout`` [s]."""
        began = [file.stat().st_size for file in self._files]
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps([str(each) for each in arguments]) + "\n")
        self._process.stdin.flush()
        ready, _, _ = select.select([self._answers], [], [], patient(timeout))
        assert ready, f"not within {patient(timeout):g} s: kompass-console {arguments}"
        answer = os.read(self._answers, 100)
        said = [
            file.read_bytes()[begin:].decode()
            for file, begin in zip(self._files, began, strict=True)
        ]
        assert answer, f"it ended: {said}"
        return Done(json.loads(answer), *said)

    def close(self) -> None:
        """End the process, and with it all that it keeps."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait(patient(10.0))
        os.close(self._answers)
        self._folder.cleanup()


def ended_by(
    sent: signal.Signals, command: Sequence[str], begun: Callable[[subprocess.Popen[str]], T]
) -> tuple[T, int, str, str]:
    """A command that gets a signal, with all its processes, as of a terminal or a container.

    What ``begun`` returned, which waits until the signal is due; exit code, output and errors.
    """
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as running:
        try:
            seen = begun(running)
            os.killpg(running.pid, sent)
            told, errors = running.communicate(timeout=patient(30))
        finally:
            if running.poll() is None:
                os.killpg(running.pid, signal.SIGKILL)
    return seen, running.returncode, told, errors
