"""What a check wants to hear is heard in virtual time, too, and nobody stands still for it."""

from __future__ import annotations

from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float32

from kompass.monitor.inputs.previews import PATIENCE, Previews
from kompass.rclpy_ext.main_thread import MainThread
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.node import VirtualNode
from kompass.virtual.process import World
from kompass.virtual.scheduler import SECOND

FLOAT = "std_msgs/msg/Float32"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def test_a_check_hears_what_comes_and_waits_no_longer_than_it_must() -> None:
    with World() as world:
        nodes = []
        for name in ("robot", "monitor"):
            process = world.process(name)
            nodes.append(VirtualNode(process, name))
            VirtualExecutor(process).add_node(nodes[-1])
        robot, monitor = nodes
        gear = robot.create_publisher(Float32, "gear", LATCHED)
        gear.publish(Float32(data=3.0))
        robot.create_publisher(Float32, "silent", 10)
        previews = Previews(monitor, MainThread(monitor.executor))

        began = world.clock.monotonic()
        heard = monitor.executor.create_task(previews.hear({"gear": FLOAT}))
        assert world.scheduler.run_while(lambda: not heard.done(), SECOND)
        assert world.clock.monotonic() - began < PATIENCE / 10
        assert previews.newest({"gear": FLOAT})["gear"].message.data == 3.0

        began = world.clock.monotonic()
        heard = monitor.executor.create_task(previews.hear({"gear": FLOAT, "silent": FLOAT}))
        assert world.scheduler.run_while(lambda: not heard.done(), SECOND)
        assert PATIENCE <= world.clock.monotonic() - began < 1.1 * PATIENCE
        assert set(previews.newest({"gear": FLOAT, "silent": FLOAT})) == {"gear"}
