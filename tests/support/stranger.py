"""A node of somebody else: what rules call that is no component of the stack."""

import time
from typing import Any

from kompass_interfaces.action import MotionRecording
from rclpy.action import ActionServer

from tests.support.robot import Robot


class Stranger:
    """``/stranger/record`` takes as long as its goal says. Lives on the tester's node."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self.goals: list[MotionRecording.Goal] = []
        self._server = ActionServer(robot.node, MotionRecording, "/stranger/record", self._record)

    def close(self) -> None:
        """Leave the graph; on the executor's own thread, which may be looking at the server."""
        gone = self._robot._executor.create_task(self._server.destroy)
        self._robot.await_future(gone, 5, "the end of the server")

    def _record(self, handle: Any) -> MotionRecording.Result:
        self.goals.append(handle.request)
        time.sleep(handle.request.recording_period_secs)
        handle.succeed()
        return MotionRecording.Result(recording_done=True, message="recorded")
