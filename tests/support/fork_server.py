"""Commands forked from a process that has imported what takes seconds to import.

What runs is a process like any other, with a session, files, an environment and an end of its own;
only the interpreter's start and the imports are not done again for each. That they work is for the
tests that start a command of its own.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import selectors
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from collections.abc import Mapping, Sequence
from io import TextIOWrapper
from pathlib import Path

from tests.support.processes import LIBC, PR_SET_PDEATHSIG, end_with_parent

PR_SET_CHILD_SUBREAPER = 36
IMPORTED = (
    "kompass.components",
    "kompass.monitor.process",
    "kompass.recorder.process",
    "kompass.simulation.node",
    "kompass.simulation.simulator",
    "kompass_console.cli",
    "kompass_console.server",
    "kompass_console.stack",
    "uvicorn.main",
)
MARKED = "KOMPASS_TEST_RUN"  # the variable by which a run finds what it has started
_LONGEST = 1 << 20  # bytes of an order


class Forked:
    """A process of the server's, as :class:`subprocess.Popen` shows one.

    Attributes
    ----------
    stdout
        What it, and all that it starts, says and complains.
    returncode
        With what it has ended; None while it runs, or nobody has looked.
    """

    def __init__(self, pid: int, stdout: TextIOWrapper, told: int, control: socket.socket) -> None:
        self.pid, self.stdout = pid, stdout
        self.returncode: int | None = None
        self._told, self._control = told, control
        self._lock = threading.Lock()

    def poll(self) -> int | None:
        """The code that it has ended with, if it has."""
        return self._look(0.0)

    def wait(self, timeout: float) -> int:
        """The code that it ends with, within ``timeout`` [s]."""
        code = self._look(timeout)
        if code is None:
            raise subprocess.TimeoutExpired(f"process {self.pid}", timeout)
        return code

    def send_signal(self, number: signal.Signals) -> None:
        """To it alone."""
        if self.poll() is None:
            os.kill(self.pid, number)

    def _look(self, timeout: float) -> int | None:
        with self._lock:
            if self.returncode is None:
                with selectors.DefaultSelector() as selector:
                    selector.register(self._told, selectors.EVENT_READ)
                    if not selector.select(timeout):
                        return None
                text = os.read(self._told, 20)
                assert text, "the process that all are forked from has ended"
                os.close(self._told)
                self.returncode = int(text)
                # Its number was nobody else's until now.
                self._control.send(json.dumps({"reap": self.pid}).encode())
            return self.returncode


class ForkServer:
    """Forks commands of ``kompass-console``."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-m", __name__, str(theirs.fileno())],
                pass_fds=[theirs.fileno()],
                preexec_fn=end_with_parent,
                start_new_session=True,
                env={**environment, "PYTHONUNBUFFERED": "1"},
            )
        self._lock = threading.Lock()

    def start(self, arguments: Sequence[str], environment: Mapping[str, str]) -> Forked:
        """Begin ``kompass-console ARGUMENTS`` in a session of its own."""
        output, its_output = os.pipe()
        told, tell = os.pipe()
        order = json.dumps(
            {"arguments": list(arguments), "environment": dict(environment), "cwd": str(Path.cwd())}
        ).encode()
        with self._lock:
            socket.send_fds(self._control, [order], [its_output, tell])
            os.close(its_output)
            os.close(tell)
            answer = self._control.recv(20)
        assert answer, "the process that all are forked from has ended"
        return Forked(int(answer), os.fdopen(output), told, self._control)

    def left(self) -> list[str]:
        """Processes that it has forked, or whose parents have left them, and that go on."""
        found = []
        for folder in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                fields = (folder / "stat").read_text().rpartition(")")[2].split()
                if int(fields[1]) == self._process.pid and fields[0] != "Z":
                    command = (folder / "cmdline").read_text().replace("\0", " ")
                    found.append(f"{folder.name}: {command}")
        return found

    def close(self) -> None:
        """End it; what it has forked ends with it."""
        self._control.close()
        self._process.wait(10.0)


class _Here:
    """The server of this process."""

    serves = False
    server: ForkServer | None = None


def serve() -> None:
    """Have :func:`server` start one when it is first asked for it."""
    _Here.serves = True


def server() -> ForkServer | None:
    """The one of this process; None where nobody has called :func:`serve`."""
    if _Here.serves and _Here.server is None:
        # It goes on when a module ends, and is not what that has left behind.
        unmarked = {name: value for name, value in os.environ.items() if name != MARKED}
        _Here.server = ForkServer(unmarked)
    return _Here.server


def left() -> list[str]:
    """What goes on of all that the server of this process has forked."""
    return [] if _Here.server is None else _Here.server.left()


class _Forking:
    """The loop of the process that all are forked from."""

    def __init__(self, control: socket.socket) -> None:
        self._control = control
        self._selector = selectors.DefaultSelector()
        self._selector.register(control, selectors.EVENT_READ)
        self._children: dict[int, tuple[int, int]] = {}  # pid: pidfd, where its end is told

    def run(self) -> None:
        """Fork what is asked for; returns in each that was forked."""
        while True:
            for key, _ in self._selector.select():
                if key.fileobj is not self._control:
                    self._tell_end(key.data)
                elif self._take():
                    return

    def _take(self) -> bool:
        text, descriptors, _, _ = socket.recv_fds(self._control, _LONGEST, 2)
        if not text:
            os._exit(0)
        order = json.loads(text)
        if "reap" in order:
            os.waitpid(order["reap"], 0)
            return False
        output, tell = descriptors
        pid = os.fork()
        if not pid:
            os.close(tell)
            self._become(order, output)
            return True
        os.close(output)
        pidfd = os.pidfd_open(pid)
        self._children[pid] = pidfd, tell
        self._selector.register(pidfd, selectors.EVENT_READ, pid)
        self._control.send(str(pid).encode())
        return False

    def _tell_end(self, pid: int) -> None:
        pidfd, tell = self._children.pop(pid)
        self._selector.unregister(pidfd)
        os.close(pidfd)
        # It stays until who asked for it has heard: its number is not given to another.
        ended = os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT)
        assert ended is not None
        code = ended.si_status if ended.si_code == os.CLD_EXITED else -ended.si_status
        with contextlib.suppress(BrokenPipeError), os.fdopen(tell, "wb") as told:
            told.write(str(code).encode())

    def _become(self, order: dict[str, object], output: int) -> None:
        """In the new process: let go of all that is the server's."""
        LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
        LIBC.prctl(PR_SET_CHILD_SUBREAPER, 0)
        os.setsid()
        self._selector.close()
        self._control.close()
        for pidfd, tell in self._children.values():
            os.close(pidfd)
            os.close(tell)
        os.dup2(output, 1)
        os.dup2(output, 2)
        os.close(output)
        environment = order["environment"]
        assert isinstance(environment, dict)
        os.environ.clear()
        os.environ.update(environment)
        os.chdir(str(order["cwd"]))
        tempfile.tempdir = None
        arguments = order["arguments"]
        assert isinstance(arguments, list)
        sys.argv = ["kompass-console", *arguments]


def main() -> None:
    """Import, fork what is asked for, and be it."""
    LIBC.prctl(PR_SET_CHILD_SUBREAPER, 1)
    with Path(os.devnull).open() as nothing:
        os.dup2(nothing.fileno(), 0)
    for name in IMPORTED:
        importlib.import_module(name)
    assert threading.active_count() == 1, f"threads of what is imported: {threading.enumerate()}"
    _Forking(socket.socket(fileno=int(sys.argv[1]))).run()
    from kompass_console.cli import main as command

    command()


if __name__ == "__main__":
    main()
