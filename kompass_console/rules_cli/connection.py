"""The command line's way to a robot: a node of its own, and one question at a time."""

from __future__ import annotations

import importlib
import os
import time
from collections.abc import Callable
from types import TracebackType
from typing import TYPE_CHECKING, Self, TypeVar

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

from kompass.monitor.finding import find_monitors
from kompass.rclpy_ext.node import PlainNode
from kompass.rclpy_ext.reply import NoAnswer, Reply
from kompass_console.cli_error import CliError
from kompass_console.domain import look_elsewhere, where
from kompass_console.rules_cli.robot_refused import REFUSED, RobotRefused

# The client brings all that can be said of rules: it is imported while the monitor is looked for,
# which takes as long.
if TYPE_CHECKING:
    from kompass.backtest.report import BacktestReport
    from kompass.monitor.client import Json, TableState
    from kompass.rulebook.schema.status import RuleStatus

SEARCH = 5.0  # s for a monitor to be found
SETTLE = 0.3  # s for a second one to be found too
SPIN = 0.02  # s
CONFLICT = 4  # exit code, as the help tells it

T = TypeVar("T")


class MonitorConnection:
    """Speaks with the monitor of one robot.

    Parameters
    ----------
    namespace
        Of the robot; None for the only one there is.
    timeout
        Seconds that the monitor may take for an answer.

    Attributes
    ----------
    monitor
        Client of the monitor; `wait` and `get` wait for its replies.

    Raises
    ------
    CliError
        When there is no monitor, or more than one to choose from.
    """

    def __init__(self, namespace: str | None, timeout: float) -> None:
        self._timeout = timeout
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = PlainNode(
            f"rules_cli_{os.getpid()}",
            context=self._context,
            start_parameter_services=False,
            enable_rosout=False,
        )
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        try:
            name = self._find(namespace)
            from kompass.monitor.client import MonitorClient

            self.monitor = MonitorClient(self._node, name, limit=timeout)
        except BaseException:
            self._leave()
            raise

    def close(self) -> None:
        """Leave the domain."""
        self.monitor.close()
        self._leave()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def get(self, reply: Reply[Json[T]]) -> T:
        """Wait for a model. Raises as `wait` does."""
        return self.wait(reply).parsed()

    def wait(self, reply: Reply[T]) -> T:
        """Wait for an answer.

        Raises
        ------
        CliError
            When there is none in time.
        RobotRefused
            When the robot does not do it.
        """
        from kompass.monitor.client import Conflicting, Refused, TableRefused

        try:
            return reply.wait(self._spin_once)
        except NoAnswer as error:
            raise CliError(
                REFUSED,
                f"{error.why}; the monitor may have ended or be busy: try again, or give it more "
                "with --timeout",
            ) from None
        except Conflicting as error:
            raise RobotRefused(str(error), error.conflict.parsed(), CONFLICT) from None
        except TableRefused as error:
            report = None if error.report is None else error.report.parsed()
            raise RobotRefused(str(error), report) from None
        except Refused as error:
            raise RobotRefused(str(error)) from None

    def statuses(self, revision: int, timeout: float = 2.0) -> dict[str, RuleStatus]:
        """How the rules of a revision are doing, by id; empty when it is not told in time.

        What it said last may be of the table before: it answers a change before it tells of it.
        """
        heard: list[TableState] = []
        self.monitor.watch_state(heard.append)
        self._spin(lambda: bool(heard) and heard[-1].revision >= revision, timeout)
        statuses = heard[-1].statuses.parsed() if heard else ()
        return {status.rule_id: status for status in statuses}

    def backtest(
        self,
        table: str,
        *,
        recording: str,
        seconds: float,
        progress: Callable[[float, str], None],
    ) -> BacktestReport:
        """Try a table (JSON) on a recording; ``progress`` takes 0 to 1 and a text.

        Raises
        ------
        RobotRefused
            When it cannot be done.
        KeyboardInterrupt
            After the back-test was cancelled.
        """
        monitor = self.monitor
        if not self._spin(lambda: monitor.runs_backtests, self._timeout):
            raise RobotRefused(
                f"{monitor.name} offers no back-tests; its flight recorder is off (--no-record), "
                "or it is of an older release"
            )
        backtest = monitor.backtest(table, recording=recording, seconds=seconds, progress=progress)
        self.wait(backtest.accepted)
        try:
            return self.wait(backtest.ended).report.parsed()
        except KeyboardInterrupt:
            backtest.cancel()
            self._spin(backtest.ended.done, self._timeout)
            raise

    def _find(self, namespace: str | None) -> str:
        """Name of the monitor."""
        wanted = None if namespace is None else "/" + namespace.strip("/")
        found: list[str] = []

        def look() -> bool:
            found[:] = [
                name
                for name in find_monitors(self._node)
                if wanted is None or (name.rpartition("/")[0] or "/") == wanted
            ]
            return bool(found)

        if self._spin(look, SEARCH) and wanted is None:
            # One of a namespace is the one that was asked for. Of others there may be a second.
            settled = time.monotonic() + SETTLE
            importlib.import_module("kompass.monitor.client")
            self._spin(lambda: False, settled - time.monotonic())
            look()
        if not found:
            named = "" if wanted is None else f" in the namespace {wanted}"
            raise CliError(
                REFUSED,
                f"no monitor was found on {where()}{named} within {SEARCH:g} s; start a stack with "
                f"'kompass-console run', or give its --namespace; {look_elsewhere()}",
            )
        if len(found) > 1:
            raise CliError(
                2,
                f"there are {len(found)} monitors on {where()}: {', '.join(found)}; "
                "choose one with --namespace",
            )
        return found[0]

    def _spin(self, done: Callable[[], bool], timeout: float) -> bool:
        """Let the node work until ``done``; whether it was in time."""
        deadline = time.monotonic() + timeout
        while not done():
            if time.monotonic() >= deadline:
                return False
            self._spin_once()
        return True

    def _spin_once(self) -> None:
        self._executor.spin_once(timeout_sec=SPIN)

    def _leave(self) -> None:
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()
