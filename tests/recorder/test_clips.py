"""Which firings are kept, and for how long."""

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from kompass.recorder.clip_policy import (
    KEEP,
    KEPT,
    ClipKeeper,
    ClipPolicy,
    ClipRequest,
    least_severity,
)
from kompass.recorder.flight import FlightRecorder, NotRecording
from kompass.recorder.mcap.reader import Recording
from kompass.recorder.places import rotation_folder, saved_folder
from kompass.recorder.process import flight_recorder
from kompass.recorder.rotating_recording import RotatingRecording
from kompass.recorder.shm_queue import ShmQueue
from kompass.recorder.streams import message_stream
from kompass.rulebook.schema.journal import FiringRecord
from kompass.rules.schema.table import Severity

NS = 1_000_000_000
START = 1_700_000_000 * NS


def test_only_severe_firings_are_kept(tmp_path: Path) -> None:
    keeper = ClipPolicy(tmp_path, Severity.ERROR)

    assert keeper.fired("calm", "warning", START) is None
    kept = keeper.fired("stuck", "error", START)

    assert kept is not None
    assert Path(kept.path) == saved_folder(tmp_path) / "firing-20231114T221320Z-stuck.mcap"
    assert (kept.start, kept.end) == (START - 25 * NS, START + 5 * NS)
    assert ClipPolicy(tmp_path, None).fired("stuck", "critical", START) is None


def test_a_firing_that_follows_closely_lengthens_the_stretch_up_to_a_bound(tmp_path: Path) -> None:
    keeper = ClipPolicy(tmp_path, Severity.ERROR)
    first = keeper.fired("a", "error", START)
    assert first is not None

    later = keeper.fired("b", "critical", START + 4 * NS)

    assert later == first._replace(end=START + 9 * NS)
    at, ends = START + 4 * NS, set()
    while at < START + 300 * NS:
        at += 3 * NS
        kept = keeper.fired("a", "error", at)
        if kept is not None and kept.path == first.path:
            ends.add(kept.end)
    assert START + 85 * NS < max(ends) <= START + 95 * NS


def test_a_rule_that_fires_all_the_time_does_not_push_out_the_others(tmp_path: Path) -> None:
    keeper = ClipPolicy(tmp_path, Severity.ERROR)
    paths = {
        kept.path
        for minute in range(60)
        if (kept := keeper.fired("again", "error", START + minute * 60 * NS))
    }

    assert len(paths) == 12


@pytest.mark.parametrize(
    ("text", "least"),
    [("error", Severity.ERROR), ("INFO", Severity.INFO), ("never", None), ("off", None)],
)
def test_the_setting_names_a_severity(text: str, least: Severity | None) -> None:
    assert least_severity({"KOMPASS_KEEP_FIRINGS": text}) == least
    assert least_severity({}) == Severity.ERROR


def test_a_setting_that_names_none_is_refused_with_the_names() -> None:
    with pytest.raises(ValueError, match="'eror' is not a severity; choose one of info, warning"):
        least_severity({"KOMPASS_KEEP_FIRINGS": "eror"})


def test_orders_are_carried_out_when_their_time_has_come_and_the_oldest_go(tmp_path: Path) -> None:
    now = START
    rotating = RotatingRecording(rotation_folder(tmp_path), {"life": "1"}, lambda: now)
    stream = message_stream("/scan", "sensor_msgs/msg/LaserScan", "tap", "scan")
    for second in range(40):
        rotating.write(stream, START + second * NS, b"x")
    rotating.flush()
    keeper = ClipKeeper(tmp_path)
    folder = saved_folder(tmp_path)
    path = folder / "firing-x.mcap"
    keeper.order(ClipRequest(str(path), START + 10 * NS, START + 20 * NS))
    keeper.order(ClipRequest(str(path), START + 10 * NS, START + 30 * NS))

    keeper.carry_out(START + 31 * NS)
    assert not path.exists(), "what was just heard may not be on disk yet"
    keeper.carry_out(START + 32 * NS)

    with Recording([path]) as recording:
        assert recording.start_time == START + 10 * NS
        assert recording.end_time == START + 29 * NS
    for number in range(KEPT + 3):
        keeper.order(ClipRequest(str(folder / f"firing-{number}.mcap"), START, START + NS))
    (folder / "mine.mcap").write_bytes(path.read_bytes())
    keeper.carry_out(START + 100 * NS)
    assert len(list(folder.glob("firing-*"))) == KEPT
    assert (folder / "mine.mcap").exists(), "what a person has kept is never dropped"
    rotating.close()


class Store:
    def __init__(self) -> None:
        self.noted: list[tuple[int, str]] = []

    def keep_recording(self, number: int, path: str) -> None:
        self.noted.append((number, path))


def entry(kind: str, severity: str) -> FiringRecord:
    return FiringRecord.model_validate(
        {
            "number": 7,
            "epoch": "e",
            "run_id": 1,
            "rule_id": "stuck",
            "name": "",
            "kind": kind,
            "time": 0.0,
            "revision": 1,
            "rule_hash": "",
            "severity": severity,
        }
    )


def test_the_journal_learns_where_a_firing_is_kept(tmp_path: Path) -> None:
    queue, store = ShmQueue(), Store()
    flight = FlightRecorder(tmp_path, queue, Severity.ERROR)
    flight._store = store
    flight.fired(entry("near miss", "critical"))
    flight.fired(entry("firing", "info"))
    assert queue.read() == []

    flight.fired(entry("firing", "error"))

    (frame,) = queue.read()
    assert (frame.is_event, frame.topic) == (True, KEEP)
    keep = ClipRequest(**json.loads(frame.raw))
    assert store.noted == [(7, keep.path)]
    assert abs(keep.end - keep.start - 30 * NS) < NS


def test_with_recording_switched_off_there_is_no_process_and_saving_says_why(
    tmp_path: Path,
) -> None:
    environment = {"KOMPASS_DATA_DIR": str(tmp_path), "KOMPASS_RECORD": "0"}

    flight, processes = flight_recorder([], environment=environment)

    assert processes == []
    assert flight is not None
    assert flight.event_log is None
    flight.fired(entry("firing", "critical"))
    with pytest.raises(NotRecording, match="--no-record"):
        flight.save(10.0, "", 0)
    assert list(tmp_path.iterdir()) == []


def test_a_robot_with_no_place_to_record_drives_all_the_same(
    caplog: pytest.LogCaptureFixture,
) -> None:
    assert flight_recorder([], environment={}) == (None, [])
    assert "nothing is recorded: there is no home folder" in caplog.text


def test_what_came_after_the_moment_of_asking_is_not_kept(tmp_path: Path) -> None:
    queue = ShmQueue()
    asked = 40 * NS
    rotating = RotatingRecording(rotation_folder(tmp_path), {"life": "1"}, lambda: START)
    stream = message_stream("/scan", "sensor_msgs/msg/LaserScan", "tap", "scan")
    for second in range(60):
        rotating.write(stream, queue.offset_ns + second * NS, b"x")
    rotating.close()

    kept = FlightRecorder(tmp_path, queue, None).save(10.0, "asked", asked)

    with Recording([Path(kept)]) as recording:
        assert recording.start_time == queue.offset_ns + asked - 10 * NS
        assert asked - NS <= recording.end_time - queue.offset_ns <= asked


@pytest.mark.parametrize("seconds", [-1.0, float("nan"), float("inf")])
def test_a_length_that_is_none_is_refused(tmp_path: Path, seconds: float) -> None:
    with pytest.raises(ValueError, match="is no length of time"):
        FlightRecorder(tmp_path, ShmQueue(), None).save(seconds, "x", 0)


def test_what_a_killed_process_left_half_written_goes(tmp_path: Path) -> None:
    folder = saved_folder(tmp_path)
    folder.mkdir(parents=True)
    dead, living = folder / ".a.mcap.99999999.partial", folder / f".b.mcap.{os.getpid()}.partial"
    for path in (dead, living, folder / "kept.mcap"):
        path.touch()

    ClipKeeper(tmp_path)

    assert sorted(path.name for path in folder.iterdir()) == [living.name, "kept.mcap"]


def test_keeping_holds_nobody_up(tmp_path: Path) -> None:
    jobs: list[Callable[[], None]] = []
    keeper = ClipKeeper(tmp_path, jobs.append)
    keeper.order(ClipRequest(str(saved_folder(tmp_path) / "firing-x.mcap"), START, START + NS))

    keeper.carry_out(START + 10 * NS)

    assert len(jobs) == 1, "done elsewhere"
    keeper.carry_out(START + 20 * NS)
    assert len(jobs) == 1, "once"
