"""A replay gives the engine what it took: no more, no less, and in its order."""

import errno
import json
import multiprocessing
import os
import shutil
import signal
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest
from geometry_msgs.msg import PointStamped
from rclpy.serialization import serialize_message
from std_msgs.msg import Float64

from kompass.backtest.event_log import (
    Began,
    Ended,
    Fired,
    Heard,
    LoggedEvent,
    Resumed,
    Swapped,
    to_data,
)
from kompass.monitor.engine_loop import EngineLoop
from kompass.recorder.clip_writer import ClipNotSaved, save_clip
from kompass.recorder.engine_memory import EngineMemory
from kompass.recorder.event_log import RecorderEventLog
from kompass.recorder.mcap.contents import NotMcap
from kompass.recorder.mcap.definitions import definition
from kompass.recorder.mcap.reader import Recording
from kompass.recorder.mcap.writer import McapWriter
from kompass.recorder.places import BadName, saved_path
from kompass.recorder.recorder import Recorder
from kompass.recorder.replay.backtest import NoRecording, backtest_files, recorded_files
from kompass.recorder.replay.replay import Replay
from kompass.recorder.rotating_recording import rotation_files
from kompass.recorder.shm_queue import ShmQueue
from kompass.recorder.topic_sampler import Taken
from kompass.recorder.topics import SampledTopic
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.firing import Firing
from kompass.rules.schema.table import Table, rule_hash
from tests.support.clock import SetClock
from tests.support.disk import no_larger_than
from tests.support.patience import patient

FLOAT = "std_msgs/msg/Float64"
NS = 1_000_000_000


def table(*bounds: float, topic: str = "level", once: bool = False) -> Table:
    """A rule for each bound: fires when the level rises above it."""
    signal = {"topic": topic, "type": FLOAT, "path": ["data"], "timeout": None}
    return Table.model_validate(
        {
            "rules": [
                {
                    "id": f"above-{bound:g}",
                    "event": {
                        "condition": {
                            "kind": "compare",
                            "signal": signal,
                            "operator": ">",
                            "value": bound,
                        },
                        "trigger": "edge",
                        "once": once,
                    },
                    "actions": [{"kind": "log", "text": "above"}],
                }
                for bound in bounds
            ]
        }
    )


def level(value: float) -> bytes:
    return bytes(serialize_message(Float64(data=value)))


class StackSession:
    """A stack's session: a monitor that writes its event log, and a recorder that takes it."""

    def __init__(self, recordings: Path) -> None:
        self.recordings = recordings
        self.queue = ShmQueue()
        self.event_log = RecorderEventLog(self.queue)
        self.now_ns = 100 * NS
        self.left_out: set[str] = set()
        self.recorder = self.start()

    def start(self) -> Recorder:
        """Another recorder's process."""
        return Recorder(self.queue, self.recordings, lambda name: f"/{name}", self._leave_out)

    def _leave_out(self, names: Iterable[str]) -> None:
        self.left_out = set(names)

    def event(self, event: LoggedEvent) -> None:
        kind, data = to_data(event)
        self.event_log.event(kind, data, self.now_ns)

    def begin(self, first: Table, epoch: str = "first", recipe: str = "") -> None:
        now = self.now_ns * 1e-9
        wall = (self.now_ns + self.queue.offset_ns) * 1e-9
        self.event(Began(now, wall, epoch, 1, first, (), recipe))

    def hear(self, value: float, topic: str = "level") -> None:
        self.now_ns += NS // 10 + 7
        self.event_log.message(topic, FLOAT, level(value), self.now_ns)

    def fire(self, rule: Any, run: int) -> None:
        now = self.now_ns * 1e-9
        self.event(Fired(now, rule.id, run, now, 1, rule_hash(rule), "level"))
        self.now_ns += 1000
        self.event(Ended(self.now_ns * 1e-9, rule.id, run))

    def tap(self, value: float, topic: str = "level", *, latched: bool = False) -> None:
        self.now_ns += NS // 10
        at = self.now_ns + self.queue.offset_ns
        self.recorder.take(
            Taken(SampledTopic(topic, FLOAT), f"/{topic}", latched, at, at, level(value))
        )


def replayed(paths: list[Path], of: Table, seconds: float = 0.0) -> list[LoggedEvent]:
    with Recording(paths) as recording:
        return list(Replay(recording, compile_table(of), seconds).events())


def heard(events: list[LoggedEvent]) -> list[tuple[float, str, float]]:
    return [(e.now, e.topic, e.message.data) for e in events if isinstance(e, Heard)]


@pytest.fixture
def session(tmp_path: Path) -> StackSession:
    return StackSession(tmp_path)


def test_what_the_engine_took_comes_back_to_the_nanosecond(session: StackSession) -> None:
    rules = table(5.0)
    session.begin(rules)
    sent = []
    for value in (1.0, 7.0, 3.0):
        session.hear(value)
        sent.append((session.now_ns * 1e-9, "level", value))
    session.fire(rules.rules[0], 1)
    session.event(Heard(session.now_ns * 1e-9, "callable/ask", "", True))
    session.event(Swapped(session.now_ns * 1e-9, 2, table(6.0), ("above-6",)))
    session.recorder.close()

    events = replayed(rotation_files(session.recordings / "ring"), rules)

    assert heard(events) == sent, "exact equality of times"
    kinds = [type(event).__name__ for event in events]
    assert kinds == ["Began", "Heard", "Heard", "Heard", "Fired", "Ended", "Swapped"]
    assert isinstance(events[0], Began)
    assert events[0].table == rules
    assert isinstance(events[-1], Swapped)
    assert (events[-1].table, events[-1].reset) == (table(6.0), ("above-6",))


def test_the_recorders_own_ears_serve_only_where_the_engine_did_not_listen(
    session: StackSession,
) -> None:
    session.tap(1.0)  # before the engine began
    session.now_ns += NS // 100
    session.begin(table(5.0, topic="other"))
    session.tap(2.0)
    session.hear(20.0, "other")
    session.recorder.tick()
    assert session.left_out == {"/other"}
    session.event(Swapped(session.now_ns * 1e-9, 2, table(5.0)))
    session.hear(3.0)
    session.recorder.tick()
    assert session.left_out == {"/level"}
    session.tap(3.5)  # was on its way while the engine began to listen
    session.hear(4.0)
    session.recorder.close()

    events = replayed(rotation_files(session.recordings / "ring"), table(5.0))

    assert [value for _, _, value in heard(events)] == [2.0, 3.0, 4.0]


def test_a_recorder_that_is_killed_neither_loses_nor_doubles_what_the_engine_took(
    session: StackSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    session.recorder.close()
    session.begin(table(5.0))
    values = [float(number) for number in range(40)]

    def only_read() -> None:
        session.start().tick()

    def flushed_and_said_so() -> None:
        recorder = session.start()
        recorder.tick()
        recorder.flush()

    def flushed_but_killed_before_it_could_say_so() -> None:
        monkeypatch.setattr(ShmQueue, "commit", lambda queue: os.kill(os.getpid(), signal.SIGKILL))
        flushed_and_said_so()

    ends = (only_read, flushed_but_killed_before_it_could_say_so, flushed_and_said_so)
    for number, value in enumerate(values):
        session.hear(value)
        if number % 3 == 0:
            assert _killed(ends[number // 3 % 3]) == signal.SIGKILL
    session.recorder = session.start()
    session.recorder.close()

    events = replayed(rotation_files(session.recordings / "ring"), table(5.0))

    assert [value for _, _, value in heard(events)] == values
    assert [type(e).__name__ for e in events].count("Began") == 1


def _killed(work: Callable[[], None]) -> int:
    """Do something in a process that is killed then; the signal that ended it."""
    process = multiprocessing.get_context("fork").Process(target=_until_killed, args=(work,))
    process.start()
    process.join(patient(20))
    assert process.exitcode is not None
    return -process.exitcode


def _until_killed(work: Callable[[], None]) -> None:
    work()
    os.kill(os.getpid(), signal.SIGKILL)


def test_what_did_not_fit_is_told(session: StackSession) -> None:
    session.begin(table(5.0))
    session.recorder.tick()
    for _ in range(3):
        session.event_log.message("level", FLOAT, bytes(5 << 20), session.now_ns)
    session.hear(1.0)
    session.recorder.close()

    events = replayed(rotation_files(session.recordings / "ring"), table(5.0))

    (lost,) = [event for event in events if type(event).__name__ == "Lost"]
    assert lost.number == 3  # type: ignore[union-attr]
    _, remark = backtest_files(table(5.0), rotation_files(session.recordings / "ring"))
    assert "lost 3 inputs" in remark


def test_a_disk_that_fails_for_a_moment_costs_that_moment_and_is_told(
    session: StackSession, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    session.now_ns = time.monotonic_ns()
    session.begin(table(5.0))
    session.hear(1.0)
    session.recorder.tick()
    flush = McapWriter.flush
    failures = [OSError(errno.EIO, "Input/output error")]

    def fail(writer: McapWriter) -> None:
        if failures:
            raise failures.pop()
        flush(writer)

    monkeypatch.setattr(McapWriter, "flush", fail)
    session.recorder.flush()
    session.hear(2.0)
    session.recorder.close()

    assert "nothing is recorded now: [Errno 5]" in caplog.text
    events = replayed(rotation_files(session.recordings / "ring"), table(5.0))
    assert [type(e).__name__ for e in events] == ["Resumed", "Heard", "Lost", "Heard"]
    assert [value for _, _, value in heard(events)] == [1.0, 2.0], "the last of before is valid"


def test_a_disk_that_fails_for_good_leaves_the_folder_to_the_next(
    session: StackSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    session.begin(table(5.0))
    session.recorder.tick()

    usage = shutil.disk_usage(session.recordings)._replace(free=0)
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: usage)
    with no_larger_than(0), pytest.raises(OSError, match="left to others"):
        session.recorder.close()
    monkeypatch.undo()

    session.recorder = session.start()
    session.recorder.close()


def test_a_kept_stretch_begins_with_the_table_in_force_and_what_was_valid(
    session: StackSession,
) -> None:
    first = table(5.0, once=True)
    session.begin(first)
    session.tap(9.0, "map", latched=True)
    session.hear(7.0)
    session.fire(first.rules[0], 1)
    second = table(5.0, 6.0, once=True)
    session.event(Swapped(session.now_ns * 1e-9, 2, second))
    session.hear(8.0)
    session.now_ns += 60 * NS
    start = session.now_ns + session.queue.offset_ns
    session.hear(1.0)
    session.recorder.tick()
    session.recorder.flush()

    path = save_clip(session.recordings, saved_path(session.recordings, "stretch"), start)
    session.recorder.close()
    events = replayed([path], table(0.5))

    resumed, valid, fresh = events
    assert isinstance(resumed, Resumed)
    assert (resumed.table, resumed.revision, resumed.used) == (second, 2, ("above-5",))
    assert isinstance(valid, Heard)
    assert valid.message.data == 8.0
    assert isinstance(fresh, Heard)
    assert (fresh.now, fresh.message.data) == (session.now_ns * 1e-9, 1.0)
    assert [value for _, _, value in heard(replayed([path], table(0.5, topic="map")))] == [9.0]
    with pytest.raises(ClipNotSaved, match=r"stretch\.mcap already; choose another name"):
        save_clip(session.recordings, path, start)
    assert [p.name for p in path.parent.iterdir()] == ["stretch.mcap"]


def test_a_stretch_that_a_full_disk_has_kept_from_being_recorded_is_refused_for_that(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(ClipNotSaved, match="is it running"):
        save_clip(tmp_path, tmp_path / "saved" / "stretch.mcap", 0)
    # All that this disk has is left to others.
    monkeypatch.setattr("kompass.recorder.clip_writer.RESERVE", shutil.disk_usage(tmp_path).total)
    with pytest.raises(ClipNotSaved, match=r"less than \d+ MB are free"):
        save_clip(tmp_path, tmp_path / "saved" / "stretch.mcap", 0)


def test_a_backtest_over_two_lives_of_the_stack_finds_the_firings_of_both(tmp_path: Path) -> None:
    rules = table(5.0)
    for epoch in ("one", "two"):
        session = StackSession(tmp_path)
        session.begin(rules, epoch)
        for run, value in enumerate((1.0, 7.0, 2.0, 9.0)):
            session.hear(value)
            if value > 5.0:
                session.fire(rules.rules[0], run)
        session.recorder.close()
    files = recorded_files(tmp_path, "")

    same, remark = backtest_files(rules, files)
    other, _ = backtest_files(table(8.0), files)

    assert (same.same, same.new, same.gone) == (4, 0, 0)
    assert (other.same, other.new, other.gone) == (0, 2, 4)
    assert same.messages == 8
    assert remark == ""


def test_a_stretch_that_reaches_into_another_recipes_time_says_so(tmp_path: Path) -> None:
    rules = table(5.0)
    for recipe in ("indoors", "outdoors"):
        session = StackSession(tmp_path)
        session.now_ns += {"indoors": 0, "outdoors": 60}[recipe] * NS
        session.begin(rules, recipe, recipe)
        session.hear(1.0)
        session.recorder.close()
    files = recorded_files(tmp_path, "")

    _, remark = backtest_files(rules, files)
    _, of_the_end = backtest_files(rules, files, 1.0)

    assert remark.startswith("up to 60 s into it another recipe was running")
    assert of_the_end == ""


def test_what_was_applied_meanwhile_is_said(session: StackSession) -> None:
    session.begin(table(5.0))
    session.hear(1.0)
    session.now_ns += 20 * NS
    session.event(Swapped(session.now_ns * 1e-9, 2, table(6.0)))
    session.hear(1.0)
    session.event(Swapped(session.now_ns * 1e-9, 2, table(6.0), ("above-6",)))
    session.recorder.close()

    _, remark = backtest_files(table(7.0), rotation_files(session.recordings / "ring"))

    assert remark == (
        "other rules were applied meanwhile (revision 2 20 s into it): these are taken to be in "
        "force from its start to its end all the same"
    )


def test_a_rule_that_was_changed_is_not_used_up_any_more() -> None:
    """It fired once, and once more after it was changed: so it would have, applied in between."""
    first, second = table(5.0, once=True), table(5.0)
    memory = EngineMemory()
    rule = first.rules[0]
    memory.take(Began(0.0, 0.0, "first", 1, first))
    memory.take(Fired(1.0, rule.id, 1, 1.0, 1, rule_hash(rule)))
    kept = memory.resumed(2.0)
    assert kept is not None
    assert kept.used == (rule.id,)
    memory.take(Swapped(2.0, 2, second))
    memory.take(Swapped(3.0, 3, first))
    anew = memory.resumed(4.0)
    assert anew is not None
    assert anew.used == ()


def test_a_stretch_from_the_middle_knows_what_cools_down_runs_and_was_true_before(
    session: StackSession,
) -> None:
    rules = Table.model_validate(
        {
            "rules": [
                {**rule, "event": {**rule["event"], "trigger": "level", "cooldown": 1.05}}
                for rule in table(5.0).model_dump(mode="json")["rules"]
            ]
            + table(6.0).model_dump(mode="json")["rules"]
        }
    )
    engine = EngineLoop(
        compile_table(rules),
        1,
        "first",
        handle=lambda outputs, *_: due.extend(o for o in outputs if isinstance(o, Firing)),
        wake=lambda _: None,
        event_log=session.event_log,
        clock=SetClock(lambda: session.now_ns, session.queue.offset_ns * 1e-9),
    )
    due: list[Firing] = []
    for count in range(300):
        session.now_ns += NS // 10 + 7
        raw = level(7.0 if count > 3 else 0.0)
        engine.heard("level", FLOAT, Float64(data=7.0 if count > 3 else 0.0), raw)
        if due and count % 5 == 0:  # each run lasts for a while
            ended = due.pop(0)
            engine.ended(ended.rule_id, ended.run_id, True, "")
    session.recorder.close()

    report, _ = backtest_files(rules, rotation_files(session.recordings / "ring"), 10.0)

    assert report.same > 5
    assert (report.new, report.gone) == (0, 0)


def held(seconds: float, rule_id: str) -> dict[str, Any]:
    """A rule that fires once the level was above 5 for so long."""
    (made,) = table(5.0).model_dump(mode="json")["rules"]
    return {**made, "id": rule_id, "event": {**made["event"], "hold": seconds}}


def test_a_table_applied_in_the_middle_finds_what_the_engine_knew_then(
    session: StackSession,
) -> None:
    """The level is above 5 from 1 s on; the stretch begins at 20 s and ends at 30 s."""
    in_force = Table.model_validate({"rules": [held(25.0, "kept"), held(28.0, "changed")]})
    proposed = [held(25.0, "kept"), held(3.0, "changed"), held(2.0, "new")]
    fired: list[Firing] = []
    engine = EngineLoop(
        compile_table(in_force),
        1,
        "first",
        handle=lambda outputs, *_: fired.extend(o for o in outputs if isinstance(o, Firing)),
        wake=lambda _: None,
        event_log=session.event_log,
        clock=SetClock(lambda: session.now_ns, session.queue.offset_ns * 1e-9),
    )
    for count in range(300):
        session.now_ns += NS // 10
        value = 7.0 if count >= 10 else 0.0
        engine.heard("level", FLOAT, Float64(data=value), level(value))
        if fired and fired[-1].rule_id == "changed":
            engine.ended(fired[-1].rule_id, fired.pop().run_id, True, "")
    session.recorder.close()
    files = rotation_files(session.recordings / "ring")

    report, _ = backtest_files(Table.model_validate({"rules": proposed}), files, 10.0)

    found = [(f.rule_id, f.verdict, round(f.at, 1), f.assumed) for f in report.firings]
    # What is new or changed begins with the first message that the table takes.
    assert found == [
        ("new", "new", 2.0, False),
        ("changed", "new", 3.0, False),
        ("kept", "same", 6.1, False),
        ("changed", "gone", 9.1, False),
    ]
    assert report.warm_up == 0.0


def test_only_the_end_is_replayed_when_only_the_end_is_asked_for(session: StackSession) -> None:
    session.begin(table(5.0))
    for value in range(50):
        session.hear(float(value))
    session.recorder.close()

    events = replayed(rotation_files(session.recordings / "ring"), table(5.0), seconds=1.0)

    assert isinstance(events[0], Resumed)
    values = [value for _, _, value in heard(events)]
    # The last before the clip is valid at its beginning.
    assert values == [float(value) for value in range(50 - len(values), 50)]
    assert 9 <= len(values) <= 12


@pytest.mark.parametrize("chunked", [True, False])
def test_a_recording_of_another_tool_is_replayed(tmp_path: Path, chunked: bool) -> None:
    from mcap.writer import CompressionType, Writer

    path = tmp_path / "foreign.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.LZ4, use_chunking=chunked)
        writer.start("ros2", "another tool")
        schema = writer.register_schema(FLOAT, "ros2msg", definition(FLOAT).encode())
        channel = writer.register_channel("/level", "cdr", schema)
        other = writer.register_schema("foo", "ros1msg", b"string data")
        noise = writer.register_channel("/noise", "ros1", other)
        for number, value in enumerate((1.0, 7.0, 2.0, 9.0)):
            at = (1_700_000_000 + number) * NS
            writer.add_message(noise, at, b"?", at)
            writer.add_message(channel, at, level(value), at)
        writer.finish()  # type: ignore[no-untyped-call]

    report, remark = backtest_files(table(5.0), [path])

    assert "no firings to compare with" in remark
    assert [(f.rule_id, f.time, f.verdict) for f in report.firings] == [
        ("above-5", 1_700_000_001.0, "new"),
        ("above-5", 1_700_000_003.0, "new"),
    ]
    assert report.messages == 4
    data = path.read_bytes()
    path.write_bytes(data[:150] if chunked else data[: data.rindex(level(9.0))])
    assert backtest_files(table(5.0), [path]).report.messages == (0 if chunked else 3)


def test_a_topic_of_another_type_is_missing_and_not_misread(tmp_path: Path) -> None:
    path = tmp_path / "other.mcap"
    writer = McapWriter(path)
    kind = "geometry_msgs/msg/PointStamped"
    schema = (kind, "ros2msg", definition(kind).encode())
    channel = writer.add_channel("/level", "cdr", schema, {})
    writer.add_message(channel, NS, bytes(serialize_message(PointStamped())), NS)
    writer.finish()

    report, _ = backtest_files(table(5.0), [path])

    assert report.missing_topics == ("level",)
    assert report.messages == 0


def test_bytes_that_are_no_message_are_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "bad.mcap"
    writer = McapWriter(path)
    channel = writer.add_channel("/level", "cdr", (FLOAT, "ros2msg", b"float64 data"), {})
    writer.add_message(channel, NS, b"\0\1", NS)
    writer.finish()

    with pytest.raises(NotMcap, match="a message on /level is no std_msgs/msg/Float64"):
        backtest_files(table(5.0), [path])


def test_nothing_recorded_is_said(tmp_path: Path) -> None:
    with pytest.raises(NoRecording, match="is the flight recorder running"):
        backtest_files(table(5.0), recorded_files(tmp_path, ""))


@pytest.mark.parametrize("name", ["../out", "/etc/passwd", "saved/../../x", ".hidden", "a/b", ""])
def test_names_cannot_leave_the_folder(tmp_path: Path, name: str) -> None:
    (tmp_path / "out.mcap").write_bytes(b"")
    with pytest.raises(BadName):
        saved_path(tmp_path / "recordings", name)
    if name:
        with pytest.raises(BadName, match="none of the robot's"):
            recorded_files(tmp_path / "recordings", name)


def test_the_engines_channel_is_json_with_a_schema(session: StackSession) -> None:
    session.begin(table(5.0))
    session.hear(1.0)
    session.recorder.close()

    with Recording(rotation_files(session.recordings / "ring")) as recording:
        (file,) = recording.files
        tracks = {track.topic: track for track in file.tracks.values()}

    engine = tracks["/monitor/engine"]
    assert (engine.encoding, engine.schema[1]) == ("json", "jsonschema")
    assert json.loads(engine.schema[2])["type"] == "object"
    assert tracks["/level"].schema == (FLOAT, "ros2msg", definition(FLOAT).encode())
    assert tracks["/level"].channel.metadata["offered_qos_profiles"] == ""
