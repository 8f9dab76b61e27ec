"""What only rclpy's nodes have is named where it is missed."""

import pytest
from kompass_interfaces.action import PlanPath
from rclpy.action import ActionClient

from kompass.virtual.node import NotOnThisBus, VirtualNode
from kompass.virtual.process import World


def test_a_client_of_rclpys_own_is_refused_with_the_remedy() -> None:
    with World() as world:
        node = VirtualNode(world.process("one"), "asker")
        with pytest.raises(NotOnThisBus, match="create_action_client instead of rclpy"):
            ActionClient(node, PlanPath, "planner/plan_path")
        assert not hasattr(node, "something_else")
