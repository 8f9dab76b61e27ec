"""The newest minutes are on disk, bounded, whole, and each file stands alone."""

import errno
import os
import shutil
import signal
import time
from pathlib import Path
from typing import NamedTuple

import pytest
from mcap.reader import make_reader

from kompass.recorder.mcap.reader import Recording, messages
from kompass.recorder.mcap.writer import McapWriter
from kompass.recorder.rotating_recording import (
    RecordingInUse,
    RotatingRecording,
    RotationBounds,
    rotation_files,
)
from kompass.recorder.streams import Stream

SCAN = Stream("/scan", "cdr", ("sensor_msgs/msg/LaserScan", "ros2msg", b"float32[] ranges"), "tap")
MAP = Stream("/map", "cdr", ("nav_msgs/msg/OccupancyGrid", "ros2msg", b"int8[] data"), "tap")
SECOND = 1_000_000_000


class Clock:
    """Nanoseconds that pass when they are told to."""

    def __init__(self) -> None:
        self.now = 1_700_000_000 * SECOND

    def __call__(self) -> int:
        return self.now


class Read(NamedTuple):
    topic: str
    source: str
    log_time: int
    data: bytes


USUAL = RotationBounds()


def opened(folder: Path, clock: Clock, bounds: RotationBounds = USUAL) -> RotatingRecording:
    return RotatingRecording(folder, {"life": "1", "offset_ns": "0"}, clock, bounds)


def read(*paths: Path) -> list[Read]:
    with Recording(paths) as recording:
        return [
            Read(m.track.topic, m.track.source, m.log_time, m.data)
            for m in messages(recording.files, lambda _: True)
        ]


def test_a_file_ends_by_its_age_and_the_next_begins_with_what_is_still_valid(
    tmp_path: Path,
) -> None:
    clock = Clock()
    recording = opened(tmp_path, clock, RotationBounds(file_age=30.0))
    recording.write(MAP, clock.now, b"the map", repeat=True)
    said = clock.now
    for _ in range(65):
        clock.now += SECOND
        recording.write(SCAN, clock.now, b"scan")
        recording.flush()
    recording.close()

    files = rotation_files(tmp_path)

    assert len(files) == 3
    for path in files[1:]:
        first, *rest = read(path)
        assert (first.topic, first.source, first.data) == ("/map", "tap repeat", b"the map")
        assert first.log_time == rest[0].log_time
        with path.open("rb") as stream:
            found = list(make_reader(stream).iter_messages("/map"))
        assert [message.publish_time for _, _, message in found] == [said]
    assert len([r for r in read(*files) if r.topic == "/scan"]) == 65


def test_the_disk_it_takes_stays_below_its_bound(tmp_path: Path) -> None:
    clock = Clock()
    bounds = RotationBounds(size=400_000, file_size=50_000)
    recording = opened(tmp_path, clock, bounds)
    largest = 0
    for number in range(300):
        clock.now += SECOND // 10
        recording.write(SCAN, clock.now, os.urandom(5000), number)
        recording.flush()
        largest = max(largest, sum(path.stat().st_size for path in rotation_files(tmp_path)))
    recording.close()

    assert 300_000 < largest <= bounds.size + 6000
    kept = read(*rotation_files(tmp_path))
    assert kept[-1].log_time == clock.now, "the newest are there"
    assert len(kept) == len({r.log_time for r in kept}) > 50


def test_files_older_than_the_bound_go(tmp_path: Path) -> None:
    clock = Clock()
    recording = opened(tmp_path, clock, RotationBounds(age=60.0, file_age=1.0))
    for _ in range(6):
        clock.now += 2 * SECOND
        recording.write(SCAN, clock.now, b"x")
        recording.flush()
    oldest, *others = rotation_files(tmp_path)
    os.utime(oldest, (time.time() - 100, time.time() - 100))

    recording.prune()
    recording.close()

    assert len(others) == 2
    assert rotation_files(tmp_path) == others


def test_all_that_was_flushed_survives_kill_9_and_the_file_is_mended(tmp_path: Path) -> None:
    pipe_read, pipe_write = os.pipe()
    pid = os.fork()
    if pid == 0:
        clock = Clock()
        # However far it gets before it is killed, it stays with its first file.
        recording = opened(
            tmp_path, clock, RotationBounds(size=1 << 40, file_size=1 << 40, file_age=1e9)
        )
        while True:
            clock.now += SECOND
            recording.write(SCAN, clock.now, os.urandom(3000))
            recording.flush()
            os.write(pipe_write, clock.now.to_bytes(8, "little"))
    acknowledged = b"".join(os.read(pipe_read, 8) for _ in range(20))
    os.kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    os.close(pipe_write)
    acknowledged += os.read(pipe_read, 1 << 16)
    os.close(pipe_read)
    times = [
        int.from_bytes(acknowledged[i : i + 8], "little") for i in range(0, len(acknowledged), 8)
    ]
    (torn,) = rotation_files(tmp_path)
    before = [r.log_time for r in read(torn)]
    assert before[: len(times)] == times
    assert len(before) <= len(times) + 1

    recording = opened(tmp_path, Clock())

    with torn.open("rb") as stream:
        found = [m.log_time for _, _, m in make_reader(stream, validate_crcs=True).iter_messages()]
    assert found == before
    recording.write(SCAN, times[-1] + SECOND, b"next")
    recording.close()
    assert len(rotation_files(tmp_path)) == 2


def test_a_second_recorder_is_told_what_to_do(tmp_path: Path) -> None:
    recording = opened(tmp_path, Clock())

    with pytest.raises(RecordingInUse, match="KOMPASS_ROBOT_NAME"):
        opened(tmp_path, Clock())
    recording.close()

    opened(tmp_path, Clock()).close()


def test_a_full_disk_costs_the_oldest_and_not_the_newest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = Clock()
    recording = opened(tmp_path, clock, RotationBounds(file_age=1.0))
    for _ in range(3):
        clock.now += 2 * SECOND
        recording.write(SCAN, clock.now, b"x")
        recording.flush()
    recording.write(SCAN, clock.now + 1, b"newest")
    before = rotation_files(tmp_path)
    flush = McapWriter.flush
    failures = [OSError(errno.ENOSPC, "No space left on device")]

    def full(writer: McapWriter) -> None:
        if failures:
            raise failures.pop()
        flush(writer)

    monkeypatch.setattr(McapWriter, "flush", full)
    recording.flush()
    recording.close()

    assert rotation_files(tmp_path) == before[1:]
    assert read(*rotation_files(tmp_path))[-1].data == b"newest"


def test_what_is_left_to_others_is_not_touched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    free = 10 << 20
    usage = shutil.disk_usage(tmp_path)._replace(free=free)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage)
    recording = opened(tmp_path, Clock())

    with pytest.raises(OSError, match="left to others"):
        recording.write(SCAN, 1, b"x")
    recording.close()
