"""A process that the supervisor forks, and what runs inside it."""

import ctypes
import faulthandler
import logging
import os
import signal
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from kompass.supervisor.cpu_usage import CpuUsage
from kompass.supervisor.heartbeat import Heartbeat, start_heartbeat
from kompass.supervisor.oversight import Life

PR_SET_PDEATHSIG = 1
STDERR = 2

log = logging.getLogger("kompass.process")
Report = Callable[[str], None]


@dataclass
class ProcessSpec:
    """What to fork.

    ``main`` is called in the child with a function that sends a line to the supervisor:
    ``"active <names>"`` once it works, ``"failed <reason>"`` when it cannot, ``"restart <node>"``
    to have the process of a node that hangs killed and started anew. Returning ends the process
    with exit code 0.
    """

    name: str
    main: Callable[[Report], None]
    restart: bool = True
    stops_robot: bool = False  # asked to stop before the others, so that the robot halts first
    names: list[str] = field(default_factory=list)  # ROS nodes in it
    starts: int = 0  # times it was forked, this one included
    born: int = 0  # when that was, in clock ticks since boot
    listens: bool = False  # wants to be told how the other processes are doing
    inbox: int = -1  # in the child: where it is told, a JSON line each
    allowed: dict[str, float] = field(default_factory=dict)  # s that a step of a node may take
    outlives: bool = False  # learns of its supervisor's death from its inbox, and then ends itself
    # File descriptors that no other child has: of the channels to these nodes (kompass.channel).
    channels: dict[str, int] = field(default_factory=dict)
    heartbeat: Heartbeat = field(init=False)  # of it and of each node

    def __post_init__(self) -> None:
        self.heartbeat = Heartbeat(self.members)

    @property
    def members(self) -> list[str]:
        """Whose conditions are assessed and told one by one: its nodes, or itself."""
        return self.names or [self.name]


@dataclass
class Child:
    """A running child, as the supervisor sees it."""

    spec: ProcessSpec
    life: Life
    pidfd: int
    reports: int  # read end of the pipe
    outbox: int = -1  # write end, for one that listens
    pending: bytes = b""
    # While it shows no life at all, and while one of its executors does not come round.
    silence: CpuUsage = field(default_factory=CpuUsage)
    lateness: CpuUsage = field(default_factory=CpuUsage)

    @property
    def pid(self) -> int:
        """Its process id."""
        return self.life.pid

    def read(self) -> list[str] | None:
        """Complete lines that arrived; None at the end of the pipe."""
        try:
            data = os.read(self.reports, 65536)
        except BlockingIOError:
            return []
        if not data:
            return None
        *lines, self.pending = (self.pending + data).split(b"\n")
        return [line.decode(errors="replace") for line in lines]

    def close(self) -> None:
        """Give the file descriptors back."""
        os.close(self.pidfd)
        os.close(self.reports)
        if self.outbox >= 0:
            os.close(self.outbox)

    def tell(self, line: str) -> None:
        """Send a line; one that does not read its lines misses some, and holds up nobody."""
        try:
            os.write(self.outbox, line.encode() + b"\n")
        except (BlockingIOError, BrokenPipeError):
            log.warning("%s does not listen", self.spec.name)


def born(pid: int) -> int:
    """When a process began, in clock ticks since boot; 0 when there is none."""
    try:
        after_name = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2]
    except OSError:
        return 0
    return int(after_name.split()[19])


def fork(spec: ProcessSpec, close: list[int]) -> Child:
    """Fork a child that runs ``spec.main``.

    The caller must have one Python thread only, and must not have initialised rclpy.

    Parameters
    ----------
    close
        File descriptors of the parent that the child must not keep open.
    """
    spec.starts += 1
    spec.heartbeat.reset()
    sys.stdout.flush()
    sys.stderr.flush()
    read_end, write_end = os.pipe()
    inbox, outbox = os.pipe() if spec.listens else (-1, -1)
    parent = os.getpid()
    pid = os.fork()
    if pid == 0:
        spec.inbox = inbox
        _run(spec, parent, write_end, [*close, read_end, *([outbox] if spec.listens else [])])
    spec.born = born(pid)
    os.close(write_end)
    os.set_blocking(read_end, False)
    if spec.listens:
        os.close(inbox)
        os.set_blocking(outbox, False)
    life = Life(spec.name, spec.names, pid, spec.born, spec.starts - 1, time.monotonic())
    return Child(spec, life, os.pidfd_open(pid), read_end, outbox)


def _run(spec: ProcessSpec, parent: int, reports: int, close: list[int]) -> None:
    """The child, up to its end; never returns."""
    code = 1
    try:
        for descriptor in close:
            os.close(descriptor)
        # Whatever happens to the supervisor, its children do not outlive it. Who has something to
        # do first is only woken, should a signal (SIGSTOP) hold it: SIGTERM would have to wait.
        farewell = signal.SIGCONT if spec.outlives else signal.SIGTERM
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, farewell)
        if os.getppid() != parent:
            os._exit(1)
        signal.set_wakeup_fd(-1)
        # Ctrl-C, and the end of a terminal, reach the whole group; the supervisor decides in which
        # order things stop.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGHUP, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        start_heartbeat(spec.heartbeat)
        # A crash in somebody's C++ leaves nothing else behind to find it by.
        faulthandler.enable(STDERR)

        def report(line: str) -> None:
            os.write(reports, line.replace("\n", " ").encode() + b"\n")

        try:
            spec.main(report)
            code = 0
        except Exception as error:  # noqa: BLE001 - reported to the supervisor, which decides
            report(f"failed {type(error).__name__}: {error}")
    finally:
        try:
            sys.stdout.flush()
            sys.stderr.flush()
        finally:
            # Also when the terminal is gone: what is forked must never go on as its supervisor.
            os._exit(code)
