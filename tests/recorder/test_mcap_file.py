"""Files are read by the mcap package itself, whatever happened to their writer."""

import os
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.records import Channel, Message, Schema

from kompass.recorder.mcap.contents import NotMcap, read_contents
from kompass.recorder.mcap.definitions import definition
from kompass.recorder.mcap.reader import Recording, messages
from kompass.recorder.mcap.recover import recover
from kompass.recorder.mcap.writer import McapWriter
from tests.support.disk import no_larger_than

SCAN = ("sensor_msgs/msg/LaserScan", "ros2msg", b"float32[] ranges\n")
NOTE = ("note", "jsonschema", b'{"type": "object"}')


def written(path: Path, chunks: int = 4, *, finish: bool = True) -> list[tuple[str, int, bytes]]:
    """A file with two channels, and what is in it in the order of time."""
    writer = McapWriter(path)
    writer.add_metadata("kompass", {"life": "7", "offset_ns": "5"})
    scan = writer.add_channel("/scan", "cdr", SCAN, {"source": "engine", "rule_topic": "scan"})
    held = []
    for chunk in range(chunks):
        for index in range(10):
            at = chunk * 1000 + index
            data = bytes([chunk, index]) * 40
            writer.add_message(scan, at, data, at, at + 1)
            held.append(("/scan", at, data))
        if chunk == 1:  # one that is announced late
            note = writer.add_channel("/note", "json", NOTE, {"source": "events"})
        if chunk >= 1:
            writer.add_message(note, chunk * 1000 + 5, b"{}", 0)
            held.append(("/note", chunk * 1000 + 5, b"{}"))
        writer.flush()
    if finish:
        writer.finish()
    else:
        writer.abandon()
    return sorted(held, key=lambda item: item[1])


def by_package(path: Path) -> list[tuple[Schema | None, Channel, Message]]:
    """All messages, as the mcap package reads them."""
    with path.open("rb") as stream:
        return list(make_reader(stream, validate_crcs=True).iter_messages())


def ours(path: Path) -> list[tuple[str, int, bytes]]:
    """All messages, as our reader reads them."""
    with Recording([path]) as recording:
        return [
            (m.track.topic, m.log_time, m.data) for m in messages(recording.files, lambda _: True)
        ]


def test_a_finished_file_is_read_by_the_mcap_package(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    held = written(path)

    found = by_package(path)

    assert [(c.topic, m.log_time, m.data) for _, c, m in found] == held
    assert {s.name: s.encoding for s, _, _ in found if s} == {
        "sensor_msgs/msg/LaserScan": "ros2msg",
        "note": "jsonschema",
    }
    with path.open("rb") as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == "ros2"
        statistics = reader.get_summary().statistics  # type: ignore[union-attr]
        assert statistics is not None
        assert (statistics.message_count, statistics.chunk_count) == (43, 4)
        assert [m.metadata["life"] for m in reader.iter_metadata()] == ["7"]
        only = reader.iter_messages("/note", starting_at=1500, ending_before=2500)
        assert [message.log_time for _, _, message in only] == [2005]


@pytest.mark.parametrize("step", [17, pytest.param(1, marks=pytest.mark.slow)])
def test_a_file_cut_at_any_byte_is_read_up_to_its_last_whole_chunk(
    tmp_path: Path, step: int
) -> None:
    whole = tmp_path / "whole.mcap"
    held = written(whole, chunks=3, finish=False)
    data = whole.read_bytes()
    cut = tmp_path / "cut.mcap"
    with whole.open("rb") as stream:
        chunks = read_contents(stream, "whole").chunks
    ends = [chunk.chunk_start_offset + chunk.chunk_length for chunk in chunks]
    for size in range(chunks[0].chunk_start_offset, len(data), step):
        cut.write_bytes(data[:size])
        last = max((k + 1 for k, end in enumerate(ends) if end <= size), default=0)
        expected = [item for item in held if item[1] < last * 1000]

        assert ours(cut) == expected, f"cut at byte {size}"
        recover(cut)

        assert ours(cut) == expected
        assert [(c.topic, m.log_time, m.data) for _, c, m in by_package(cut)] == expected


def test_a_file_without_its_beginning_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "letter.mcap"
    path.write_text("Dear robot, ...")

    with pytest.raises(NotMcap, match=r"letter\.mcap is no MCAP file"), Recording([path]):
        pass


def test_a_damaged_chunk_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "bad.mcap"
    written(path)
    with path.open("rb") as stream:
        chunk = read_contents(stream, "").chunks[1]
    data = bytearray(path.read_bytes())
    data[chunk.chunk_start_offset + 70] ^= 0xFF
    path.write_bytes(data)

    with pytest.raises(NotMcap, match=r"bad\.mcap is damaged"):
        ours(path)


def test_a_full_disk_leaves_a_whole_file_and_the_messages_in_hand(tmp_path: Path) -> None:
    path = tmp_path / "full.mcap"
    writer = McapWriter(path)
    channel = writer.add_channel("/scan", "cdr", SCAN, {})
    writer.add_message(channel, 1, b"first", 1)
    writer.flush()
    writer.add_message(channel, 2, os.urandom(1000), 2)
    with no_larger_than(path.stat().st_size + 500), pytest.raises(OSError, match="too large"):
        writer.flush()  # half of it is written before the disk takes no more
    assert [message.log_time for _, message in _read(path)] == [1]

    writer.finish()

    assert [message.log_time for _, _, message in by_package(path)] == [1, 2]


def _read(path: Path) -> list[tuple[str, Message]]:
    with Recording([path]) as recording:
        return [
            (m.track.topic, Message(0, m.log_time, m.data, 0, 0))
            for m in messages(recording.files, lambda _: True)
        ]


def test_messages_of_overlapping_files_come_in_the_order_of_time(tmp_path: Path) -> None:
    paths = [tmp_path / "a.mcap", tmp_path / "b.mcap"]
    for number, path in enumerate(paths):
        writer = McapWriter(path)
        channel = writer.add_channel("/scan", "cdr", SCAN, {})
        for chunk in range(3):
            for index in (5, 1, 3):  # unsorted within a chunk
                at = chunk * 10 + index * 3 + number
                writer.add_message(channel, at, b"", at)
            writer.flush()
        writer.finish()

    with Recording(paths) as recording:
        times = [m.log_time for m in messages(recording.files, lambda _: True)]

    assert len(times) == 18
    assert times == sorted(times)


def test_a_definition_stands_alone() -> None:
    text = definition("nav_msgs/msg/Odometry")

    assert text.startswith("# This represents an estimate of a position and velocity")
    assert "PoseWithCovariance pose" in text
    separators = [line for line in text.splitlines() if line.startswith("MSG: ")]
    assert len(separators) == len(set(separators)) == 9
    assert "MSG: builtin_interfaces/Time" in separators
    assert "uint8 STATUS_HEALTHY=0" in definition("automatika_ros_sugar/msg/ComponentStatus")
    assert definition("nobody_msgs/msg/Nothing") == ""
