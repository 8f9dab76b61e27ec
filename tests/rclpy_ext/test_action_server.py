"""An action server forgets what nobody can want any more."""

from typing import Any

import pytest
from kompass_interfaces.action import MotionRecording
from rclpy.action import ActionClient

from kompass.rclpy_ext.action_server import ForgetfulActionServer
from tests.support.spinning import Spinning

pytestmark = pytest.mark.ros


def test_goals_that_have_ended_are_forgotten_after_their_time(spinning: Spinning) -> None:
    def execute(handle: Any) -> MotionRecording.Result:
        handle.succeed()
        return MotionRecording.Result()

    server = ForgetfulActionServer(
        spinning.node, MotionRecording, "brief", execute, result_timeout=1
    )
    client = ActionClient(spinning.node, MotionRecording, "brief")
    spinning.until(client.server_is_ready)
    for _ in range(3):
        sent = client.send_goal_async(MotionRecording.Goal())
        spinning.until(sent.done)
        ended = sent.result().get_result_async()
        spinning.until(ended.done)
    assert len(server._goal_handles) == 3

    def forgotten() -> bool:
        spinning.executor.create_task(server.expire_goals)
        spinning.rest(0.1)
        return not server._goal_handles and not server._result_futures

    spinning.until(forgotten)
    client.destroy()
    server.destroy()
