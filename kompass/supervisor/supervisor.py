"""Fork processes, watch them, start them again, and end them in the right order.

One thread, no rclpy, no web: the supervisor itself does nothing that can hang, and a fork of it is
always clean. Death is learned from pidfds and stopping (SIGSTOP) from SIGCHLD, never by polling;
hangs show in heartbeats that are missing.
"""

import gc
import logging
import os
import selectors
import signal
import time
from collections.abc import Sequence
from dataclasses import dataclass

from kompass.supervisor.cpu_usage import CpuUsage, Work
from kompass.supervisor.guard import guard_process
from kompass.supervisor.heartbeat import Heartbeat
from kompass.supervisor.liveness import LivenessLimits
from kompass.supervisor.news import ProcessNews
from kompass.supervisor.oversight import Oversight, StartupError
from kompass.supervisor.process import Child, ProcessSpec, fork
from kompass.supervisor.restarts import Restarts

STOP_ROBOT_TIME = 0.7  # s for the last gate before the wheels to halt the robot
END_TIME = 1.5  # s for all others to end by themselves
LIVENESS_PERIOD = 0.2  # s between two looks at the heartbeats

log = logging.getLogger("kompass.supervisor")


@dataclass
class _PendingStart:
    spec: ProcessSpec
    at: float  # monotonic s


class Supervisor:
    """Runs a list of processes until SIGINT, SIGTERM, or SIGHUP where it is not ignored (nohup).

    Beside them runs a guard, which ends them when the supervisor itself is killed.

    Parameters
    ----------
    specs
        What to run, in the order of starting.
    announced
        Names of those whose common activity is announced.
    limits
        When a process counts as busy or stuck, and when one that is stuck is killed.
    restarts
        How often, and after what delay, one that died is started again.
    activation_timeout
        Within which all that are announced must be active [s]; None to wait for ever.
    inactive
        Of whom it is known beforehand that they come up without becoming active.
    heartbeat
        Of the supervisor itself: shows life each time that it has looked at all processes.
    """

    def __init__(
        self,
        specs: list[ProcessSpec],
        announced: list[str],
        *,
        limits: LivenessLimits | None = None,
        restarts: Restarts | None = None,
        activation_timeout: float | None = None,
        inactive: Sequence[str] = (),
        heartbeat: Heartbeat | None = None,
    ) -> None:
        self._guard = guard_process(END_TIME)
        self._specs = [self._guard, *specs]
        self._oversight = Oversight(limits, restarts, self._tell)
        self._activation_timeout = activation_timeout
        self._children: dict[int, Child] = {}
        self._selector = selectors.DefaultSelector()
        self._wakeup = -1
        self._stop: signal.Signals | None = None
        self._pending: list[_PendingStart] = []
        self._awaited = set(announced)
        self._inactive = inactive
        self._heartbeat = heartbeat or Heartbeat(())
        self._started = 0.0
        self._assessed = 0.0

    def run(self) -> None:
        """Start everything, block until a signal ends it, end everything.

        Raises
        ------
        StartupError
            When a process cannot start at all.
        """
        self._started = time.monotonic()
        self._heartbeat.send()
        numbers = [signal.SIGINT, signal.SIGTERM, signal.SIGCHLD]
        # A terminal that is closed, or a connection that is lost, must not end the gate unhalted.
        if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
            numbers.append(signal.SIGHUP)
        before = {number: signal.getsignal(number) for number in numbers}
        self._wakeup, write = os.pipe()
        os.set_blocking(self._wakeup, False)
        os.set_blocking(write, False)
        for number in before:
            signal.signal(number, self._on_signal)
        signal.set_wakeup_fd(write, warn_on_full_buffer=False)
        self._selector.register(self._wakeup, selectors.EVENT_READ, None)
        # What was imported stays for good; children whose collectors leave it alone share pages.
        gc.freeze()
        try:
            for spec in self._specs:
                self._start(spec)
            while self._stop is None:
                self._run_once()
        finally:
            self._end_all()
            # What is frozen is not collected at the interpreter's end, and extensions that count
            # what is left of theirs, as OMPL's, call all of it leaked.
            gc.unfreeze()
            signal.set_wakeup_fd(-1)
            for number, handler in before.items():
                signal.signal(number, handler)
            self._selector.close()
            os.close(write)
            os.close(self._wakeup)

    def _on_signal(self, number: int, _frame: object) -> None:
        # SIGCHLD has no other purpose than to wake up: a child may have been stopped.
        if number != signal.SIGCHLD:
            self._stop = signal.Signals(number)

    def _run_once(self) -> None:
        next_start = min((due.at for due in self._pending), default=float("inf"))
        timeout = max(0.0, min(LIVENESS_PERIOD, next_start - time.monotonic()))
        for key, _ in self._selector.select(timeout):
            if key.data is None:
                os.read(self._wakeup, 64)
                self._note_stopped()
                continue
            child = key.data
            if key.fd == child.reports:
                self._read(child)
            elif child.pid in self._children:
                self._read(child)
                self._handle_exit(child)
        for due in [due for due in self._pending if due.at <= time.monotonic()]:
            self._pending.remove(due)
            self._start(due.spec)
        now = time.monotonic()
        if now - self._assessed >= 0.8 * LIVENESS_PERIOD:
            self._assessed = now
            for child in list(self._children.values()):
                self._assess(child, now)
            self._check_activation(now)
            self._heartbeat.send()

    # -- liveness -----------------------------------------------------------------------------

    def _note_stopped(self) -> None:
        """Note which children a signal has stopped, or lets go on."""
        kinds = os.WSTOPPED | os.WCONTINUED | os.WNOHANG
        for child in self._children.values():
            try:
                changed = os.waitid(os.P_PIDFD, child.pidfd, kinds)
            except ChildProcessError:
                continue  # it is dead, which its pidfd tells
            if changed is not None:
                stopped = changed.si_code == os.CLD_STOPPED
                child.life.stopped = time.monotonic() if stopped else None
                if stopped:
                    # The robot may have to be halted: that waits for no look at the heartbeats.
                    self._assess(child, time.monotonic())

    def _assess(self, child: Child, now: float) -> None:
        life, heartbeat = child.life, child.spec.heartbeat
        if not life.active:
            assessed = self._oversight.assess_start(life, now)
            if assessed.kill:
                self._kill(child, assessed.kill)
            return
        silent = now - heartbeat.last_sent()
        lags: dict[str, float | None] = {}
        for member in life.members:
            last = heartbeat.last_sent(member)
            lags[member] = now - last if last else None
        longest = max((lag for lag in lags.values() if lag is not None), default=0.0)
        computing = self._work(child, child.silence, silent, now).computing
        waited = self._work(child, child.lateness, longest, now).waited
        assessed = self._oversight.assess(
            life,
            now,
            silent,
            lags,
            computing=computing,
            waited=waited,
            allowed=child.spec.allowed,
        )
        for change in assessed.changes:
            if change.now == "stuck":
                log.warning("%s is stuck: %s", change.member, change.reason)
            elif change.before == "stuck":
                log.info("%s is no longer stuck", change.member)
        if assessed.kill:
            self._kill(child, assessed.kill)

    def _work(self, child: Child, usage: CpuUsage, silent: float, now: float) -> Work:
        """What a process did while it was silent, or a part of it was."""
        if self._oversight.may_be_computing(child.life, silent):
            return usage.look(child.pid, now)
        usage.clear()
        return Work(computing=False, waited=0.0)

    def _kill(self, child: Child, why: str) -> None:
        if not child.life.killed:
            child.life.killed = why
            log.error("%s is killed: %s", child.spec.name, why)
            signal.pidfd_send_signal(child.pidfd, signal.SIGKILL)

    def _check_activation(self, now: float) -> None:
        limit = self._activation_timeout
        if limit is not None and self._awaited and now - self._started > limit:
            raise StartupError(
                f"{', '.join(sorted(self._awaited))} did not become active within "
                f"{limit:g} s (activation_timeout)"
            )

    # -- lives --------------------------------------------------------------------------------

    def _start(self, spec: ProcessSpec) -> None:
        inherited = [self._wakeup]
        for child in self._children.values():
            inherited += [child.pidfd, child.reports]
            if child.outbox >= 0:
                inherited.append(child.outbox)
        # Whoever has one can speak in another's name; it stays open here for their next lives.
        channels = {each for other in self._specs for each in other.channels.values()}
        inherited += channels.difference(spec.channels.values())
        child = fork(spec, inherited)
        self._children[child.pid] = child
        log.info("%s is process %d", spec.name, child.pid)
        if spec.listens:
            for news in self._oversight.newest:
                child.tell(news.to_line())
        self._oversight.tell(child.life, "starting")
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
                self._oversight.activate(child.life)
                self._report_active(child)
            elif word == "failed":
                log.error("%s: %s", child.spec.name, rest)
            elif word == "fatal":
                raise StartupError(rest)
            elif word == "notice":
                log.info("%s", rest)
            elif word == "restart":
                self._restart(rest)

    def _restart(self, member: str) -> None:
        """Start the process of a node anew, because a rule wants it; what was given up stays so."""
        for child in list(self._children.values()):
            if member in (child.spec.name, *child.spec.members):
                self._kill(child, "a restart was asked for")

    def _report_active(self, child: Child) -> None:
        log.info("%s is up (%.2f s)", child.spec.name, time.monotonic() - child.life.began)
        if child.spec.name in self._awaited:
            self._awaited.discard(child.spec.name)
            if not self._awaited:
                took = time.monotonic() - self._started
                if self._inactive:
                    names = ", ".join(self._inactive)
                    log.info("all components up in %.2f s, but not active: %s", took, names)
                else:
                    log.info("all components active in %.2f s", took)

    def _forget_pipe(self, child: Child) -> None:
        if child.reports in self._selector.get_map():
            self._selector.unregister(child.reports)

    def _handle_exit(self, child: Child) -> None:
        _, status = os.waitpid(child.pid, 0)
        code = os.waitstatus_to_exitcode(status)
        now = time.monotonic()
        self._release(child)
        how = f"killed by {signal.Signals(-code).name}" if code < 0 else f"ended with {code}"
        name = child.spec.name
        # Before anything is written to a terminal, which may not take it: the robot may be moving.
        self._oversight.bury(child.life, f"the process was {how}" if code < 0 else how)
        log.warning("%s %s after %.1f s", name, how, now - child.life.began)
        wanted = child.spec.restart and self._stop is None
        death = self._oversight.after_death(child.life, now, failed=code != 0, restart=wanted)
        if death.delay is not None:
            log.warning("%s starts again in %.1f s", name, death.delay)
            self._pending.append(_PendingStart(child.spec, time.monotonic() + death.delay))
        elif death.text:
            log.error("%s %s: given up", name, death.text)

    def _tell(self, news: ProcessNews) -> None:
        """Tell those who listen."""
        line = news.to_line()
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
        """Halt the robot first, then end all; what does not end is killed. Nothing is left."""
        # A second Ctrl-C while ending must not leave half of them running.
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        gates = [child for child in self._children.values() if child.spec.stops_robot]
        self._end(gates, STOP_ROBOT_TIME)
        # The guard goes last: until then the supervisor itself may be killed.
        self._end([c for c in self._children.values() if c.spec is not self._guard], END_TIME)
        self._end(list(self._children.values()), END_TIME)

    def _end(self, children: list[Child], timeout: float) -> None:
        for child in children:
            signal.pidfd_send_signal(child.pidfd, signal.SIGTERM)
        deadline = time.monotonic() + timeout
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
            log.warning("%s did not end in %.1f s: killed", child.spec.name, timeout)
            signal.pidfd_send_signal(child.pidfd, signal.SIGKILL)
            # A stopped process (SIGSTOP) dies of SIGKILL all the same, so this returns.
            os.waitpid(child.pid, 0)
            self._release(child)
            # Those who are still there must know that it could not do what it does at its end.
            self._oversight.tell(child.life, "dead", "it did not end, and was killed")
