"""Zero velocity on behalf of a drive manager that cannot send it any more.

A process of its own, tiny and always there: its publishers have been found by the base long before
they are needed. Nothing of what it sends can be chosen by anybody: every number in it is zero.
"""

from __future__ import annotations

import gc
import os
import select
import signal
import time
from collections.abc import Sequence

import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.signals import SignalHandlerOptions

from kompass.bus.node import Node
from kompass.rclpy_ext.node import PlainNode
from kompass.rclpy_ext.topic import QoSConfig, Topic
from kompass.supervisor.heartbeat import send_heartbeat
from kompass.supervisor.news import ProcessNews
from kompass.supervisor.process import Report

# The only node besides the drive manager that publishes on its command topics.
HALT_NODE = "halt"
PERIOD = 0.05  # s between two zero twists
HALTING = 1.0  # s of them at least, when no drive manager comes back
LOOK = 0.25  # s; how often it shows life while there is nothing to do


class HaltWatch:
    """Decides when zero is to be sent. Time is an argument [s].

    Parameters
    ----------
    gates
        Names of the drive managers.
    """

    def __init__(self, gates: Sequence[str]) -> None:
        self._lost: dict[str, bool] = dict.fromkeys(gates, False)
        self._until = -float("inf")

    def note(self, news: ProcessNews, now: float) -> None:
        """Take what is told of a process."""
        for gate in self._lost.keys() & set(news.nodes):
            if news.state == "given up":
                # Nobody will come: after a while the base is left to whoever drives it by hand.
                self._lost[gate], self._until = False, now + HALTING
            elif news.state != "starting":  # until it is active, nothing has changed
                self._lost[gate] = news.is_lost or news.state == "busy"

    def note_end(self, now: float, *, orderly: bool) -> None:
        """The stack ends. Drive managers halt the robot then, unless they are lost."""
        if not orderly or any(self._lost.values()):
            self._until = now + HALTING
        self._lost.clear()

    def halts(self, now: float) -> bool:
        """Whether zero is to be sent now: until a drive manager works, or for a second."""
        return any(self._lost.values()) or now < self._until


class _ZeroPublishers:
    """Publishes zero on the command topics of the drive managers, and cannot publish else."""

    def __init__(self, node: Node, topics: Sequence[Topic], frame: str) -> None:
        self._node, self._frame = node, frame
        self._publishers = [
            (
                topic.ros_msg_type,
                node.create_publisher(
                    topic.ros_msg_type, topic.name, (topic.qos_profile or QoSConfig()).to_ros()
                ),
            )
            for topic in topics
        ]

    def publish(self) -> None:
        for kind, publisher in self._publishers:
            message = kind()
            if isinstance(message, TwistStamped):
                message.header.stamp = self._node.get_clock().now().to_msg()
                message.header.frame_id = self._frame
            publisher.publish(message)


def run_halt(
    gates: Sequence[str],
    topics: Sequence[Topic],
    frame: str,
    report: Report,
    inbox: int,
    namespace: str = "",
) -> None:
    """Watch over the drive managers in this process until SIGTERM, or the supervisor's death.

    Parameters
    ----------
    gates
        Names of the drive managers.
    topics
        Where they send commands, as Twist or TwistStamped.
    frame
        Of the robot's base.
    report
        Tells the supervisor.
    inbox
        File descriptor on which the supervisor tells of processes, a JSON line each.
    namespace
        ROS namespace of the nodes.
    """
    wakeup, write = os.pipe()
    os.set_blocking(write, False)
    signal.set_wakeup_fd(write)
    ended: list[int] = []
    signal.signal(signal.SIGTERM, lambda number, _: ended.append(number))
    # A look of the collector at what came with the fork would copy all of it into this process.
    gc.freeze()
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = PlainNode(
        HALT_NODE, namespace=namespace or None, start_parameter_services=False, enable_rosout=False
    )
    zero = _ZeroPublishers(node, topics, frame)
    watch = HaltWatch(gates)
    inbox_open, ending, pending = True, False, b""
    poll = select.poll()
    poll.register(inbox, select.POLLIN)
    poll.register(wakeup, select.POLLIN)
    report(f"active {HALT_NODE}")
    try:
        while True:
            halting = watch.halts(time.monotonic())
            if halting:
                zero.publish()
            elif ending:
                return
            for descriptor, _ in poll.poll(1000 * (PERIOD if halting else LOOK)):
                data = os.read(descriptor, 65536)
                if descriptor == wakeup:
                    continue
                if not data:
                    inbox_open = False
                    poll.unregister(inbox)
                *lines, pending = (pending + data).split(b"\n")
                for line in lines:
                    watch.note(ProcessNews.of_line(line.decode()), time.monotonic())
            if not ending and (ended or not inbox_open):
                ending = True
                watch.note_end(time.monotonic(), orderly=inbox_open)
            send_heartbeat(HALT_NODE)
    finally:
        node.destroy_node()
        rclpy.shutdown()
