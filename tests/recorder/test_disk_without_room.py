"""A disk without room for recordings is told as what it is, and used again when it has some."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

from kompass.recorder import rotating_recording
from kompass.recorder.places import rotation_folder
from kompass.recorder.process import _record
from kompass.recorder.shm_queue import ShmQueue
from kompass.recorder.topics import SampledTopic
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros
TOPICS = [SampledTopic("spoken", "std_msgs/msg/String")]


@pytest.fixture
def node() -> Iterator[Node]:
    rclpy.init(args=[])
    node = rclpy.create_node("recording")
    yield node
    node.destroy_node()
    rclpy.shutdown()


@pytest.fixture
def speaker(node: Node) -> Iterator[None]:
    """Somebody who always has more to say than is taken in one turn."""
    publisher = node.create_publisher(String, "spoken", 100)
    ended = threading.Event()

    def speak() -> None:
        while not ended.wait(0.01):
            for _ in range(20):
                publisher.publish(String(data="x"))

    thread = threading.Thread(target=speak)
    thread.start()
    yield
    ended.set()
    thread.join()


def test_it_is_said_as_often_as_it_is_tried_and_with_room_it_is_recorded(
    node: Node, speaker: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    queue = ShmQueue()
    with monkeypatch.context() as small:
        small.setattr(rotating_recording, "RESERVE", 1 << 60)
        for _ in range(3):
            with pytest.raises(OSError, match="are free, which are left to others"):
                _record(queue, tmp_path, TOPICS, node, threading.Event())
            assert node.count_subscribers("spoken") == 0, "nobody is left who listens"
    ended = threading.Event()
    files = rotation_folder(tmp_path)
    recording = threading.Thread(target=_record, args=(queue, tmp_path, TOPICS, node, ended))
    recording.start()
    wait_until(lambda: any(files.glob("*.mcap")), 20.0, "a recording")
    ended.set()
    recording.join()
