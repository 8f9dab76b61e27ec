"""The same message is written down as the same bytes, and nothing of it is lost."""

from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from geometry_msgs.msg import PointStamped, PoseStamped, TransformStamped
from kompass_interfaces.msg import ProcessState, StackState
from nav_msgs.msg import OccupancyGrid, Path
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import Imu, LaserScan
from std_msgs.msg import Empty, String
from tf2_msgs.msg import TFMessage

from kompass.message_types import type_name
from kompass.recorder.mcap.padding import without_padding


def described() -> Iterator[Any]:
    """Messages with texts and rows of all lengths, after which there are gaps of all sizes."""
    for length in range(9):
        text = "x" * length
        scan = LaserScan(ranges=[1.0] * length, intensities=[2.0])
        scan.header.frame_id = text
        yield scan
        transform = TransformStamped(child_frame_id=text)
        transform.transform.rotation.w = 0.5
        yield TFMessage(transforms=[transform] * 2)
        path = Path(poses=[PoseStamped()] * 2)
        path.poses[0].header.frame_id = text
        yield path
        grid = OccupancyGrid(data=[1] * length)
        grid.header.frame_id = text
        yield grid
        processes = [ProcessState(name=text, nodes=[text, "y"], pid=7, restarts=3)] * 2
        yield StackState(processes=processes)
    yield from (ComponentStatus(), PointStamped(), Imu(), String(data="abc"), Empty())


@pytest.mark.parametrize("message", list(described()), ids=lambda m: type(m).__name__)
def test_exactly_what_nobody_reads_is_cleared(message: Any) -> None:
    kind: Any = type(message)
    name = type_name(kind)
    data = serialize_message(message)
    cleared = without_padding(name, data)
    assert deserialize_message(cleared, kind) == message
    assert len(cleared) == len(data)
    told, differ = 0, list[int]()
    for at in range(4, len(data)):
        other = bytearray(data)
        other[at] ^= 0x55
        # A length that is none is refused by both, in whatever words.
        with suppress(Exception):
            told += 1
            unread = deserialize_message(bytes(other), kind) == message
            same = without_padding(name, bytes(other)) == cleared
            differ += [at] * (same != unread)
    assert told == len(data) - 4
    assert differ == []
