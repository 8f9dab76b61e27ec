"""A node of somebody else: what rules call that is no component of the stack."""

import time
from typing import Any

from kompass_interfaces.action import MotionRecording
from rclpy.action import ActionServer

from tests.support.robot import Robot


class Stranger:
    """``/stranger/record`` takes as long as its goal says. Lives on the tester's node."""

    def __init__(self, robot: Robot) -> None:
        self.goals: list[MotionRecording.Goal] = []
        self._server = ActionServer(robot.node, MotionRecording, "/stranger/record", self._record)

    def close(self) -> None:
        """Leave the graph."""
        self._server.destroy()

    def _record(self, handle: Any) -> MotionRecording.Result:
        self.goals.append(handle.request)
        time.sleep(handle.request.recording_period_secs)
        handle.succeed()
        return MotionRecording.Result(recording_done=True, message="recorded")
