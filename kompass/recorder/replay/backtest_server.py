"""The action ``~/backtest_rules``: in processes of their own, with progress and cancel."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from kompass_interfaces.action import BacktestRules
from rclpy.action import CancelResponse, GoalResponse
from rclpy.executors import Executor
from rclpy.node import Node

from kompass.access.gatekeeper import Gatekeeper, NotAdmitted
from kompass.rclpy_ext.action_server import ForgetfulActionServer
from kompass.recorder.replay.worker import Worker, WorkerFailed

AT_ONCE = 2
FETCHED = 60  # s in which whoever waits for a report has asked for it; rclpy keeps it for 15 min
LARGEST_TABLE = 16 << 20  # characters


class BacktestServer:
    """Serves the action on a node; the executor's thread does nothing but pass words on.

    Parameters
    ----------
    recordings
        Folder of all recordings; others are refused.
    gatekeeper
        Lets goals in.
    """

    def __init__(
        self, node: Node, executor: Executor, recordings: Path, gatekeeper: Gatekeeper
    ) -> None:
        self._executor, self._recordings, self._gatekeeper = executor, recordings, gatekeeper
        self._name = f"{node.get_name()}/backtest_rules"
        self._jobs: dict[bytes, _Job] = {}
        self._server = ForgetfulActionServer(
            node,
            BacktestRules,
            self._name,
            # Awaiting would keep the events executor busy (rclpy 7.1.6), so a goal is executed
            # when it is done: see _Job.
            execute_callback=lambda handle: BacktestRules.Result(),
            goal_callback=self._consider,
            handle_accepted_callback=self._begin,
            cancel_callback=self._cancel,
            result_timeout=FETCHED,
        )

    def close(self) -> None:
        """End what is under way."""
        for job in list(self._jobs.values()):
            job.cancel()
        self._server.destroy()

    def _consider(self, goal: Any) -> GoalResponse:
        if len(self._jobs) >= AT_ONCE or len(goal.table) > LARGEST_TABLE:
            return GoalResponse.REJECT
        try:
            self._gatekeeper.admit(self._name, goal, changes=False)
        except NotAdmitted:  # told in the log; a rejection has no words
            return GoalResponse.REJECT
        sensible = math.isfinite(goal.seconds) and goal.seconds >= 0
        return GoalResponse.ACCEPT if sensible else GoalResponse.REJECT

    def _begin(self, handle: Any) -> None:
        # Reports are large: those that were fetched long ago make room.
        self._executor.create_task(self._server.expire_goals)
        key = bytes(handle.goal_id.uuid)
        self._jobs[key] = _Job(handle, self._recordings, self._post, lambda: self._jobs.pop(key))

    def _cancel(self, handle: Any) -> CancelResponse:
        job = self._jobs.get(bytes(handle.goal_id.uuid))
        if job is not None:
            job.cancel()
        return CancelResponse.ACCEPT

    def _post(self, function: Callable[[], Any]) -> None:
        self._executor.create_task(function)


class _Job:
    """One back-test, followed by a thread that only waits."""

    def __init__(
        self,
        handle: Any,
        recordings: Path,
        post: Callable[[Callable[[], Any]], None],
        ended: Callable[[], Any],
    ) -> None:
        self._handle, self._post, self._ended = handle, post, ended
        self._recordings = recordings
        self._worker: Worker | None = None
        self._cancelled = threading.Event()
        threading.Thread(target=self._run, name="backtest", daemon=True).start()

    def cancel(self) -> None:
        """End it; the goal is told so by the thread."""
        self._cancelled.set()
        if self._worker is not None:
            self._worker.kill()

    def _run(self) -> None:
        goal = self._handle.request
        result = BacktestRules.Result()
        job = {
            "kind": "backtest",
            "table": goal.table,
            "recordings": str(self._recordings),
            "recording": goal.recording,
            "seconds": goal.seconds,
        }
        try:
            with Worker(**job) as worker:
                self._worker = worker
                if self._cancelled.is_set():
                    worker.kill()
                answer = worker.answer(self._tell)
                result.answer, result.message = answer["report"], answer["remark"]
                result.success = True
        except Exception as error:  # noqa: BLE001 - becomes the answer; a goal must come to an end
            expected = isinstance(error, WorkerFailed | OSError)
            text = str(error) if expected else f"{type(error).__name__}: {error}"
            result.message = "cancelled" if self._cancelled.is_set() else text
        self._post(lambda: self._finish(result))

    def _tell(self, share: float) -> None:
        feedback = BacktestRules.Feedback(progress=share, text=f"{share:.0%} replayed")
        self._post(lambda: self._handle.is_active and self._handle.publish_feedback(feedback))

    def _finish(self, result: Any) -> None:
        self._ended()

        def conclude(handle: Any) -> Any:
            if handle.is_cancel_requested:
                handle.canceled()
            elif result.success:
                handle.succeed()
            else:
                handle.abort()
            return result

        self._handle.execute(conclude)
