"""Fork processes, watch them, start them again, and end them in the right order.

One thread, no rclpy, no web: the supervisor itself does nothing that can hang, and a fork of it is
always clean. Death is learned from pidfds, never by polling.
"""

import json
import logging
import os
import selectors
import signal
import time
from dataclasses import dataclass

from kompass.launch.process import Child, ProcessSpec, fork

STOP_ROBOT_TIME = 0.7  # s for the last gate before the wheels to halt the robot
END_TIME = 1.5  # s for all others to end by themselves
RESTART_DELAYS = (
    0.1,
    0.5,
    1.0,
    2.0,
    5.0,
)  # s; a process that lived longer than HEALTHY starts over
HEALTHY = 30.0
TICK = 0.25

log = logging.getLogger("kompass.supervisor")


class StartupError(RuntimeError):
    """A process could not start; the message is meant for the terminal."""


@dataclass
class _Due:
    spec: ProcessSpec
    at: float


class Supervisor:
    """Runs a list of processes until SIGINT or SIGTERM.

    Parameters
    ----------
    specs
        What to run, in the order of starting.
    announced
        Names of those whose common activity is announced.
    """

    def __init__(self, specs: list[ProcessSpec], announced: list[str]) -> None:
        self._specs = specs
        self._children: dict[int, Child] = {}
        self._selector = selectors.DefaultSelector()
        self._wakeup = -1
        self._stop: signal.Signals | None = None
        self._due: list[_Due] = []
        self._deaths: dict[str, int] = {}
        self._waiting = set(announced)
        self._began = 0.0
        self._known: dict[str, str] = {}  # the last line told of each process
        self.restarts = 0

    def run(self) -> None:
        """Start everything, block until a signal ends it, end everything.

        Raises
        ------
        StartupError
            When a process cannot start at all.
        """
        self._began = time.monotonic()
        before = {s: signal.getsignal(s) for s in (signal.SIGINT, signal.SIGTERM)}
        self._wakeup, write = os.pipe()
        os.set_blocking(self._wakeup, False)
        os.set_blocking(write, False)
        for number in before:
            signal.signal(number, self._on_signal)
        signal.set_wakeup_fd(write, warn_on_full_buffer=False)
        self._selector.register(self._wakeup, selectors.EVENT_READ, None)
        try:
            for spec in self._specs:
                self._start(spec)
            while self._stop is None:
                self._turn()
        finally:
            self._end_all()
            signal.set_wakeup_fd(-1)
            for number, handler in before.items():
                signal.signal(number, handler)
            self._selector.close()
            os.close(write)
            os.close(self._wakeup)

    def _on_signal(self, number: int, _frame: object) -> None:
        self._stop = signal.Signals(number)

    def _turn(self) -> None:
        soonest = min((due.at for due in self._due), default=time.monotonic() + TICK)
        for key, _ in self._selector.select(max(0.0, min(TICK, soonest - time.monotonic()))):
            if key.data is None:
                os.read(self._wakeup, 64)
                continue
            child = key.data
            if key.fd == child.reports:
                self._read(child)
            elif child.pid in self._children:
                self._read(child)
                self._bury(child)
        for due in [due for due in self._due if due.at <= time.monotonic()]:
            self._due.remove(due)
            self._start(due.spec)

    def _start(self, spec: ProcessSpec) -> None:
        inherited = [self._wakeup]
        for child in self._children.values():
            inherited += [child.pidfd, child.reports]
            if child.outbox >= 0:
                inherited.append(child.outbox)
        child = fork(spec, inherited)
        self._children[child.pid] = child
        log.info("%s is process %d", spec.name, child.pid)
        if spec.listens:
            for line in self._known.values():
                child.tell(line)
        self._tell(spec, "starting", child.pid)
        self._selector.register(child.reports, selectors.EVENT_READ, child)
        self._selector.register(child.pidfd, selectors.EVENT_READ, child)

    def _read(self, child: Child) -> None:
        lines = child.read()
        if lines is None:
            self._forget_pipe(child)
            return
        for line in lines:
            word, _, rest = line.partition(" ")
            if word == "active":
                child.active = True
                self._tell(child.spec, "active", child.pid)
                self._report_active(child)
            elif word == "failed":
                log.error("%s: %s", child.spec.name, rest)
            elif word == "fatal":
                raise StartupError(rest)
            elif word == "notice":
                log.info("%s", rest)

    def _report_active(self, child: Child) -> None:
        log.info("%s is up (%.2f s)", child.spec.name, time.monotonic() - child.started)
        if child.spec.name in self._waiting:
            self._waiting.discard(child.spec.name)
            if not self._waiting:
                log.info("all components active in %.2f s", time.monotonic() - self._began)

    def _forget_pipe(self, child: Child) -> None:
        if child.reports in self._selector.get_map():
            self._selector.unregister(child.reports)

    def _bury(self, child: Child) -> None:
        _, status = os.waitpid(child.pid, 0)
        code = os.waitstatus_to_exitcode(status)
        lived = time.monotonic() - child.started
        self._release(child)
        how = f"killed by {signal.Signals(-code).name}" if code < 0 else f"ended with {code}"
        log.warning("%s %s after %.1f s", child.spec.name, how, lived)
        self._tell(child.spec, "dead", child.pid, how)
        if not child.active and not self._deaths.get(child.spec.name) and code != 0:
            raise StartupError(f"{child.spec.name} could not start; its reason is above")
        if not child.spec.restart or self._stop is not None:
            return
        deaths = 0 if lived > HEALTHY else self._deaths.get(child.spec.name, 0)
        self._deaths[child.spec.name] = deaths + 1
        if deaths >= len(RESTART_DELAYS):
            log.error("%s died %d times in a row: given up", child.spec.name, deaths + 1)
            self._tell(child.spec, "given up", child.pid, f"died {deaths + 1} times in a row")
            return
        self.restarts += 1
        delay = RESTART_DELAYS[deaths]
        log.warning("%s starts again in %.1f s", child.spec.name, delay)
        self._due.append(_Due(child.spec, time.monotonic() + delay))

    def _tell(self, spec: ProcessSpec, state: str, pid: int, reason: str = "") -> None:
        """Tell those who listen how a process is doing."""
        line = json.dumps(
            {
                "name": spec.name,
                "nodes": spec.names,
                "state": state,
                "pid": pid,
                "restarts": spec.starts - 1,
                "reason": f"the process was {reason}" if reason.startswith("killed") else reason,
            }
        )
        self._known[spec.name] = line
        for child in self._children.values():
            if child.outbox >= 0:
                child.tell(line)

    def _release(self, child: Child) -> None:
        self._forget_pipe(child)
        if child.pidfd in self._selector.get_map():
            self._selector.unregister(child.pidfd)
        child.close()
        del self._children[child.pid]

    def _end_all(self) -> None:
        """The robot halts first, then all end; who does not, is killed. Nobody is left behind."""
        # A second Ctrl-C while ending must not leave half of them running.
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)
        gates = [child for child in self._children.values() if child.spec.stops_robot]
        self._end(gates, STOP_ROBOT_TIME)
        self._end(list(self._children.values()), END_TIME)

    def _end(self, children: list[Child], patience: float) -> None:
        for child in children:
            signal.pidfd_send_signal(child.pidfd, signal.SIGTERM)
        deadline = time.monotonic() + patience
        waiting = {child.pid: child for child in children}
        while waiting:
            for pid in list(waiting):
                if os.waitpid(pid, os.WNOHANG)[0]:
                    self._release(waiting.pop(pid))
            if not waiting:
                return
            if time.monotonic() >= deadline:
                break
            with selectors.DefaultSelector() as selector:
                for child in waiting.values():
                    selector.register(child.pidfd, selectors.EVENT_READ)
                selector.select(max(0.0, deadline - time.monotonic()))
        for child in waiting.values():
            log.warning("%s did not end in %.1f s: killed", child.spec.name, patience)
            signal.pidfd_send_signal(child.pidfd, signal.SIGKILL)
            # A stopped process (SIGSTOP) dies of SIGKILL all the same, so this returns.
            os.waitpid(child.pid, 0)
            self._release(child)
