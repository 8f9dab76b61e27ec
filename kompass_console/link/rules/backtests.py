"""Back-tests that the monitor runs for this console."""

from __future__ import annotations

import secrets
import threading
from collections import OrderedDict
from concurrent.futures import Future
from dataclasses import dataclass, field

from pydantic import ValidationError

from kompass.invalid import first_invalid
from kompass.monitor.client import Backtest, BacktestCanceled, BacktestEnd, NoMonitor, Refused
from kompass.rclpy_ext.reply import NoAnswer
from kompass_console.link.rules.monitor import MonitorLink
from kompass_console.schema.rule_models import BacktestProgress

_KEPT = 8  # reports
_AT_ONCE = 2


class TooMany(Exception):
    """As many run already as the robot should be asked for."""


@dataclass(slots=True)
class _Run:
    progress: BacktestProgress
    backtest: Backtest | None = None
    servers: frozenset[bytes] = frozenset()
    lock: threading.Lock = field(default_factory=threading.Lock)

    @property
    def ended(self) -> bool:
        return self.progress.state not in ("waiting", "running")

    def update(self, **changes: object) -> None:
        """Change what is told of it, until it has ended. Any thread."""
        with self.lock:
            if not self.ended:
                self.progress = self.progress.model_copy(update=changes)


class Backtests:
    """The newest back-tests, by id."""

    def __init__(self, monitor: MonitorLink) -> None:
        self._monitor = monitor
        self._runs: OrderedDict[str, _Run] = OrderedDict()
        self._lock = threading.Lock()

    def refresh(self) -> None:
        """Those of a monitor that has gone have failed. On the link's thread."""
        running = [run for run in self._listed() if run.progress.state == "running"]
        if running:
            servers = self._servers()
            for run in running:
                if run.servers != servers:
                    run.update(state="failed", error="The monitor has gone meanwhile.")

    async def start(self, table: str, recording: str, seconds: float) -> str:
        """Begin one; its id.

        Raises
        ------
        NoAnswer
            When nobody offers back-tests or the monitor does not take it.
        TooMany
            When as many run already as may.
        """
        monitor = self._monitor.client
        if not monitor.runs_backtests:
            raise NoAnswer("the monitor is not ready for back-tests")
        if sum(not run.ended for run in self._listed()) >= _AT_ONCE:
            raise TooMany(f"{_AT_ONCE} back-tests run already.")
        run = _Run(_waiting(secrets.token_hex(8)))
        with self._lock:
            self._runs[run.progress.id] = run
            self._forget_old()

        def heard(share: float, text: str) -> None:
            run.update(progress=share, text=text)

        backtest = monitor.backtest(table, recording=recording, seconds=seconds, progress=heard)
        run.backtest = backtest
        backtest.ended.add_done_callback(lambda done: _end(run, done))
        try:
            await backtest.accepted.answer()
        except (NoAnswer, Refused) as error:
            run.update(state="failed", error=f"It was not begun: {error}.")
            raise NoAnswer(str(error)) from error
        run.servers = self._servers()
        run.update(state="running")
        return run.progress.id

    def progress(self, run_id: str) -> BacktestProgress | None:
        """How far it is; None when it is not known. Any thread."""
        run = self._runs.get(run_id)
        return None if run is None else run.progress

    def cancel(self, run_id: str) -> bool:
        """Cancel it, or forget it when it has ended; False when it is not known. Any thread."""
        run = self._runs.get(run_id)
        if run is None:
            return False
        if run.ended:
            with self._lock:
                self._runs.pop(run_id, None)
        elif run.backtest is not None:
            run.backtest.cancel()
        return True

    def _servers(self) -> frozenset[bytes]:
        try:
            return self._monitor.client.backtest_servers
        except NoMonitor:
            return frozenset()

    def _listed(self) -> list[_Run]:
        with self._lock:
            return list(self._runs.values())

    def _forget_old(self) -> None:
        for run_id in [i for i, run in self._runs.items() if run.ended]:
            if len(self._runs) <= _KEPT:
                break
            del self._runs[run_id]


def _waiting(run_id: str) -> BacktestProgress:
    return BacktestProgress(
        id=run_id, state="waiting", progress=0.0, text="", report=None, error=None
    )


def _end(run: _Run, done: Future[BacktestEnd]) -> None:
    try:
        end = done.result()
        report = end.report.parsed()
    except BacktestCanceled:
        run.update(state="canceled", error="It was cancelled.")
    except Refused as error:
        run.update(state="failed", error=str(error) or "It failed.")
    except ValidationError as error:
        text = f"The report cannot be read: {first_invalid(error).text}."
        run.update(state="failed", error=text)
    except NoAnswer:
        run.update(state="failed", error="The monitor did not tell how it ended.")
    else:
        run.update(state="done", progress=1.0, text=end.remark, report=report)
