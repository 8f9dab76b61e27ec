"""Back-tests that the monitor runs for this console."""

from __future__ import annotations

import asyncio
import concurrent.futures
import secrets
import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from kompass_interfaces.action import BacktestRules
from pydantic import ValidationError
from rclpy.action import ActionClient
from rclpy.node import Node

from kompass.backtest.report import BacktestReport
from kompass_console.link.discovery import Graph, action_names
from kompass_console.link.services import NoAnswer
from kompass_console.schema.rule_models import BacktestProgress

_TYPE = "kompass_interfaces/action/BacktestRules"
_KEPT = 8  # reports
_AT_ONCE = 2
_ACCEPT_TIMEOUT = 10.0  # s
_CANCELED = 5  # action_msgs/GoalStatus
_SUCCEEDED = 4


class TooMany(Exception):
    """As many run already as the robot should be asked for."""


@dataclass(slots=True)
class _Job:
    progress: BacktestProgress
    handle: Any = None
    servers: frozenset[bytes] = frozenset()
    canceled: bool = False

    @property
    def ended(self) -> bool:
        return self.progress.state not in ("waiting", "running")


class Backtests:
    """The newest back-tests, by id. `run` hands a function to the link's thread."""

    def __init__(self, node: Node, run: Callable[[Callable[[], None]], None]) -> None:
        self._node = node
        self._run = run
        self._client: Any = None
        self._server: str | None = None
        self._jobs: OrderedDict[str, _Job] = OrderedDict()
        self._lock = threading.Lock()

    def refresh(self, published: Graph) -> None:
        """Follow the action server that is there now; jobs of one that has gone have failed."""
        names = action_names(published, f"{_TYPE}_FeedbackMessage")
        server = names[0] if names else None
        if server != self._server:
            old, self._client = self._client, None
            if server is not None:
                self._client = ActionClient(self._node, BacktestRules, server)
            self._server = server
            if old is not None:
                old.destroy()
        running = [job for job in self._listed() if not job.ended and job.handle is not None]
        # One that was started again has the old name, and knows nothing of what the old one ran.
        if running:
            there = self._servers()
            for job in running:
                if job.servers != there:
                    self._update(job, state="failed", error="The monitor has gone meanwhile.")

    async def start(self, table: str, recording: str, seconds: float) -> str:
        """Begin one; its id.

        Raises
        ------
        NoAnswer
            When nobody offers back-tests or the server does not take it.
        TooMany
            When as many run already as may.
        """
        if self._client is None:
            raise NoAnswer("no monitor that runs back-tests is there")
        if sum(not job.ended for job in self._listed()) >= _AT_ONCE:
            raise TooMany(f"{_AT_ONCE} back-tests run already.")
        job = _Job(_waiting(secrets.token_hex(8)))
        with self._lock:
            self._jobs[job.progress.id] = job
            self._forget_old()
        goal = BacktestRules.Goal(table=table, recording=recording, seconds=seconds)
        taken: concurrent.futures.Future[None] = concurrent.futures.Future()
        self._run(lambda: self._send(job, goal, taken))
        try:
            await asyncio.wait_for(asyncio.wrap_future(taken), _ACCEPT_TIMEOUT)
        except (TimeoutError, NoAnswer) as error:
            job.canceled = True  # should it be accepted all the same
            why = getattr(error, "why", f"it did not answer within {_ACCEPT_TIMEOUT:g} s")
            self._update(job, state="failed", error=f"It was not begun: {why}.")
            raise NoAnswer(why) from error
        return job.progress.id

    def progress(self, job_id: str) -> BacktestProgress | None:
        """How far it is; None when it is not known. Any thread."""
        job = self._jobs.get(job_id)
        return None if job is None else job.progress

    def cancel(self, job_id: str) -> bool:
        """Cancel it, or forget it when it has ended; False when it is not known. Any thread."""
        job = self._jobs.get(job_id)
        if job is None:
            return False
        if job.ended:
            with self._lock:
                self._jobs.pop(job_id, None)
            return True
        job.canceled = True
        self._run(lambda: self._cancel(job))
        return True

    # -- on the link's thread -----------------------------------------------------------------

    def _send(self, job: _Job, goal: Any, taken: concurrent.futures.Future[None]) -> None:
        client = self._client
        if client is None or not client.server_is_ready():
            _set(taken, NoAnswer("the monitor is not ready for back-tests"))
            return

        def heard(message: Any) -> None:
            feedback = message.feedback
            if not job.ended:
                fraction = min(max(float(feedback.progress), 0.0), 1.0)
                self._update(job, progress=fraction, text=str(feedback.text))

        def accepted(done: Any) -> None:
            if done.cancelled() or done.exception() is not None:
                _set(taken, NoAnswer("the monitor did not take the back-test"))
                return
            handle = done.result()
            if not handle.accepted:
                _set(taken, NoAnswer("the monitor refused the back-test; it may run one already"))
                return
            job.handle, job.servers = handle, self._servers()
            self._update(job, state="running")
            handle.get_result_async().add_done_callback(lambda done: self._ended(job, done))
            _set(taken, None)
            if job.canceled:
                self._cancel(job)

        client.send_goal_async(goal, feedback_callback=heard).add_done_callback(accepted)

    def _servers(self) -> frozenset[bytes]:
        """Who offers back-tests, by the ids that DDS gives."""
        if self._server is None:
            return frozenset()
        infos = self._node.get_publishers_info_by_topic(f"{self._server}/_action/feedback")
        return frozenset(bytes(info.endpoint_gid) for info in infos)

    def _cancel(self, job: _Job) -> None:
        if job.handle is not None and not job.ended:
            job.handle.cancel_goal_async()

    def _ended(self, job: _Job, done: Any) -> None:
        if job.ended:
            return
        if done.cancelled() or done.exception() is not None:
            self._update(job, state="failed", error="The monitor did not tell how it ended.")
            return
        status, result = int(done.result().status), done.result().result
        if status == _CANCELED:
            self._update(job, state="canceled", error="It was canceled.")
        elif status != _SUCCEEDED or not result.success:
            self._update(job, state="failed", error=str(result.message) or "It failed.")
        else:
            self._keep(job, result)

    def _keep(self, job: _Job, result: Any) -> None:
        try:
            report = BacktestReport.model_validate_json(result.answer)
        except ValidationError as error:
            text = f"The report cannot be read: {error.errors()[0]['msg']}."
            self._update(job, state="failed", error=text)
            return
        self._update(job, state="done", progress=1.0, text=str(result.message), report=report)

    def _update(self, job: _Job, **changes: object) -> None:
        job.progress = job.progress.model_copy(update=changes)

    def _listed(self) -> list[_Job]:
        with self._lock:
            return list(self._jobs.values())

    def _forget_old(self) -> None:
        for job_id in [i for i, job in self._jobs.items() if job.ended]:
            if len(self._jobs) <= _KEPT:
                break
            del self._jobs[job_id]


def _waiting(job_id: str) -> BacktestProgress:
    return BacktestProgress(
        id=job_id, state="waiting", progress=0.0, text="", report=None, error=None
    )


def _set(future: concurrent.futures.Future[None], error: Exception | None) -> None:
    if future.done():  # nobody waits any more
        return
    if error is None:
        future.set_result(None)
    else:
        future.set_exception(error)
