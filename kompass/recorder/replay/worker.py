"""What takes long happens in a process of its own: the engine has no time to share.

``python -m kompass.recorder.replay.worker`` reads one job from its standard input and
answers with JSON lines on its standard output: ``progress`` now and then, then ``answer`` or
``error``.
"""

from __future__ import annotations

import ctypes
import faulthandler
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Self

from pydantic import ValidationError

from kompass.invalid import first_invalid
from kompass.recorder.clip_writer import ClipNotSaved, save_clip
from kompass.recorder.mcap.contents import NotMcap
from kompass.recorder.places import BadName
from kompass.recorder.replay.backtest import NoRecording, backtest_files, recorded_files
from kompass.rules.schema.table import Table
from kompass.supervisor.process import PR_SET_PDEATHSIG, STDERR

NICENESS = 10
_EXPECTED = (BadName, ClipNotSaved, NoRecording, NotMcap)


class WorkerFailed(RuntimeError):
    """The job was not done; the message says why."""


class Worker:
    """A job under way in a process of its own.

    Parameters
    ----------
    job
        ``kind`` and the arguments of a function of this module.
    """

    def __init__(self, **job: Any) -> None:
        self._process = subprocess.Popen(
            # -P: what lies in the working directory is no module of ours.
            [sys.executable, "-P", "-m", "kompass.recorder.replay.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "KOMPASS_WORKER_PARENT": str(os.getpid())},
        )
        self._job = json.dumps(job).encode()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()

    def kill(self) -> None:
        """End it at once; from any thread."""
        self._process.kill()

    def answer(self, progress: Callable[[float], None] = lambda share: None) -> Any:
        """Wait for what it answers.

        Raises
        ------
        WorkerFailed
            When it could not, or was killed.
        """
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(self._job)
            self._process.stdin.close()
        except BrokenPipeError:
            pass  # it has ended already, which is found out below
        for line in self._lines():
            if "answer" in line:
                return line["answer"]
            if "error" in line:
                raise WorkerFailed(line["error"])
            progress(line["progress"])
        code = self._process.wait()
        raise WorkerFailed(_death(code))

    def _lines(self) -> Iterator[dict[str, Any]]:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            yield json.loads(line)


def _death(code: int) -> str:
    if code == -signal.SIGKILL:
        return (
            "the process that did it was killed; if nobody did so, memory is short: "
            "take fewer seconds, or have less run on this machine"
        )
    how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
    return f"the process that did it ended with {how}; its last words are in the stack's output"


def main() -> None:
    """Do the job that comes on standard input."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != int(os.environ.get("KOMPASS_WORKER_PARENT", os.getppid())):
        return  # whoever wanted it died before the line above
    os.nice(NICENESS)
    faulthandler.enable(STDERR)
    # What libraries print must not get among the answers.
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    job = json.load(sys.stdin)
    kind = job.pop("kind")

    def say(**data: Any) -> None:
        answers.write(json.dumps(data) + "\n")

    try:
        say(answer=_JOBS[kind](say, **job))
    except ValidationError as error:
        invalid = first_invalid(error)
        say(error=f"table: {invalid.where}: {invalid.text}")
    except OSError as error:
        where = f" in {Path(error.filename).parent}" if error.filename else ""
        say(error=f"{error.strerror or error}{where}")
    except _EXPECTED as error:
        say(error=str(error))


def _backtest(
    say: Callable[..., None], table: str, recordings: str, recording: str, seconds: float
) -> dict[str, str]:
    paths = recorded_files(Path(recordings), recording)
    done = backtest_files(
        Table.model_validate_json(table), paths, seconds, lambda share: say(progress=share)
    )
    return {"report": done.report.model_dump_json(), "remark": done.remark}


def _save(_: Callable[..., None], recordings: str, path: str, start: int, end: int) -> str:
    return str(save_clip(Path(recordings), Path(path), start, end))


_JOBS: dict[str, Callable[..., Any]] = {"backtest": _backtest, "save": _save}

if __name__ == "__main__":
    main()
