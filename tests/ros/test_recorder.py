"""The flight recorder of a running stack, and back-tests against what really happened."""

import contextlib
import os
import signal
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from action_msgs.msg import GoalStatus
from kompass_interfaces.action import BacktestRules
from kompass_interfaces.srv import GetFirings, SaveRecording
from mcap.reader import make_reader
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.serialization import deserialize_message

from kompass.recorder.rotating_recording import rotation_files
from kompass.rulebook.schema.journal import Journal
from kompass.rules.schema.table import Table
from tests.recorder.reality import (
    EDITED,
    NEAR,
    TRUE_BEFORE,
    Reality,
    applied_table,
    expected_near,
    last_applied,
    reality_table,
    recorded,
    same_times,
    since,
)
from tests.support.patience import patient
from tests.support.processes import children, wait_until
from tests.support.robot import Robot
from tests.support.stack import Stack

pytestmark = pytest.mark.ros

THRESHOLD = 0.45  # m
SECONDS = 12.0


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    """Recipe 01 with the embedded robot; firings of any severity are kept."""
    with closing(Stack.simulated(KOMPASS_KEEP_FIRINGS="critical")) as running:
        yield running


@pytest.fixture(scope="module")
def reality(robot: Robot) -> Iterator[Reality]:
    """The client that has the robot drive."""
    with closing(Reality(robot)) as made:
        yield made


@pytest.fixture(scope="module")
def recording(stack: Stack, reality: Reality) -> Path:
    """A faulted run, kept as `reality`."""
    reality.begin(stack, reality_table(THRESHOLD))
    reality.drive(SECONDS)
    return reality.save("reality")


def test_the_same_table_gives_the_same_firings(
    robot: Robot, reality: Reality, recording: Path
) -> None:
    record = recorded(recording)
    shares: list[float] = []
    # An action's client hears no progress any more once it has the answer, which may be first.
    robot.node.create_subscription(
        BacktestRules.Impl.FeedbackMessage,
        "/monitor/backtest_rules/_action/feedback",
        lambda message: shares.append(message.feedback.progress),
        10,
    )

    report = reality.backtest(reality_table(THRESHOLD), "reality")

    firings = since(report, record.in_force)
    assert {f.verdict for f in firings} == {"same"}
    assert [f.rule_id for f in firings] == [f.rule_id for f in record.firings]
    assert same_times([f.time for f in firings], [f.time for f in record.firings])
    assert {"silent", "turning", "status"} <= {f.rule_id for f in firings}
    assert [f.leaves for f in firings] == [f.leaves for f in record.firings], "values, ages, all"
    told = {(f.rule_id, tuple((leaf.text, leaf.verdict) for leaf in f.leaves)) for f in firings}
    assert {(live.rule_id, live.leaves) for live in reality.told} <= told
    wait_until(lambda: shares[-1:] == [1.0], 5.0, "the end of its progress")
    assert shares == sorted(shares)


def test_one_threshold_moved_changes_what_hangs_on_it_and_nothing_else(
    reality: Reality, recording: Path
) -> None:
    record = recorded(recording)
    edited = THRESHOLD - EDITED

    report = reality.backtest(reality_table(edited), "reality")

    firings = since(report, record.in_force)
    assert {f.rule_id for f in firings if f.verdict != "same"} <= {NEAR, "not-near"}
    near = [f.time for f in firings if f.rule_id == NEAR and f.verdict != "gone"]
    assert same_times(near, expected_near(recording, edited, record))


def test_the_file_stands_alone_for_any_tool(recording: Path) -> None:
    with recording.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        found = {
            channel.topic: (schema, channel, message)
            for schema, channel, message in reader.iter_messages()
        }
    assert {"/scan", "/odometry/filtered", "/tf", "/tf_static", "/map", "/drive_state"} <= set(
        found
    )
    assert {"/monitor/engine", "/monitor/firings", "/planner/status", "/clicked_point"} <= set(
        found
    )
    for topic, (schema, channel, _) in found.items():
        assert schema is not None
        if topic != "/monitor/engine":
            assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")
            assert schema.data, f"{topic} carries its definition"
    odometry = deserialize_message(found["/odometry/filtered"][2].data, Odometry)
    assert odometry.header.frame_id == "map"
    grid = deserialize_message(found["/map"][2].data, OccupancyGrid)
    assert len(grid.data) == grid.info.width * grid.info.height > 0


def test_the_ring_itself_can_be_replayed_while_it_is_written(reality: Reality) -> None:
    report = reality.backtest(reality_table(THRESHOLD), "", seconds=5.0)

    assert report.messages > 20
    assert 2.0 < report.end - report.start < 10.0


def caught(robot: Robot, reality: Reality, monitor: int, number: signal.Signals) -> Any:
    """A back-test whose process was sent a signal while it lived."""
    table = reality_table(THRESHOLD).model_dump_json()
    for _ in range(20):  # a machine with much to do may look only when it is done
        handle = reality.send(table, "reality")
        ended = robot.asked_result(handle)
        while not ended.done():
            for pid in children(monitor):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, number)
                    return handle
            time.sleep(0.001)
    raise AssertionError("each back-test was done before it was seen")


def test_a_backtest_can_be_cancelled_and_bad_ones_say_what_is_wrong(
    stack: Stack, robot: Robot, reality: Reality, recording: Path
) -> None:
    monitor = stack.pid_of("monitor")
    for _ in range(5):  # it may have answered before it was held
        handle = caught(robot, reality, monitor, signal.SIGSTOP)
        robot.cancel(handle)
        ended = robot.result(handle, 10)
        if ended.status == GoalStatus.STATUS_CANCELED:
            break
    assert ended.status == GoalStatus.STATUS_CANCELED
    assert not children(monitor)

    for bad, name, complaint in (
        ("{", "reality", "table"),
        ('{"rules": [{"id": "A B"}]}', "reality", "rules.0.id"),
        (Table().model_dump_json(), "/etc/passwd", "none of the robot's"),
        (Table().model_dump_json(), "../../rules", "none of the robot's"),
    ):
        result = reality.result(reality.send(bad, name))
        assert not result.success
        assert complaint in result.message


def test_kill_9_of_a_backtest_fails_it_with_a_reason_and_harms_nobody(
    stack: Stack, robot: Robot, reality: Reality, recording: Path
) -> None:
    monitor = stack.pid_of("monitor")
    for _ in range(5):  # it may have answered before it was killed
        result = reality.result(caught(robot, reality, monitor, signal.SIGKILL))
        if not result.success:
            break
    assert not result.success
    assert "was killed" in result.message
    assert reality.backtest(reality_table(THRESHOLD), "reality").messages > 20
    assert stack.pid_of("monitor") == monitor
    assert not children(monitor)


def test_a_name_is_never_used_twice_and_never_leaves_the_folder(
    robot: Robot, recording: Path
) -> None:
    before = recording.read_bytes()
    for name, complaint in (("reality", "already"), ("../reality", "cannot be the name")):
        request = SaveRecording.Request(seconds=1.0, name=name)
        answer = robot.call(SaveRecording, "/monitor/save_recording", request, timeout=30)
        assert not answer.success
        assert complaint in answer.message
    assert recording.read_bytes() == before


def test_kill_9_of_the_recorder_loses_nothing_of_what_the_rules_took(
    stack: Stack, reality: Reality
) -> None:
    old = stack.pid_of("recorder")
    os.kill(old, signal.SIGKILL)
    wait_until(lambda: stack.pid_of("recorder") != old, 10, "another recorder")
    pid = stack.pid_of("recorder")
    (ring,) = stack.data_dir.glob("*/recordings/ring")
    wait_until(lambda: len(rotation_files(ring)) >= 2, 10, "a file of the new recorder")

    path = reality.save("after-kill")

    assert stack.pid_of("recorder") == pid
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        taken = sorted(
            message.sequence
            for _, channel, message in reader.iter_messages()
            if channel.metadata["source"] in ("engine", "events") and message.sequence
        )
    assert len(taken) == len(set(taken)), "nothing twice"
    assert set(range(1, taken[-1])) - set(taken) == set(), "nothing missing"
    report = reality.backtest(reality_table(THRESHOLD), "after-kill")
    record = recorded(path)
    assert {f.verdict for f in since(report, record.in_force)} == {"same"}


def test_what_surrounds_a_severe_firing_is_kept(robot: Robot, reality: Reality) -> None:
    data = reality_table(THRESHOLD).model_dump(mode="json")
    data["rules"].append({**data["rules"][6], "id": "severe", "severity": "critical"})
    data["rules"][-1]["event"]["cooldown"] = 600.0
    reality.apply(Table.model_validate(data))

    def entry() -> str:
        request = GetFirings.Request(rule_id="severe")
        answer = robot.call(GetFirings, "/monitor/get_firings", request)
        firings = Journal.model_validate_json(answer.answer).firings
        return firings[0].recording if firings else ""

    wait_until(entry, 10, "a recording in the journal")
    path = Path(entry())
    wait_until(path.exists, 15, "the file")

    firing = next(f for f in recorded(path).firings if f.rule_id == "severe")
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    end = summary.statistics.message_end_time * 1e-9
    assert 4.0 < end - firing.time < 6.0
    assert time.time() - firing.time < patient(30)


def test_a_table_applied_while_it_drives_fires_as_a_back_test_from_then_says(
    reality: Reality,
) -> None:
    table = applied_table(THRESHOLD)
    reality.apply(reality_table(THRESHOLD))
    reality.drive(6.0)
    reality.apply(table)
    reality.drive(8.0)
    applied = last_applied(reality.save("applied"))

    report = reality.backtest(table, "applied", seconds=applied.seconds)

    assert report.start == pytest.approx(applied.time, abs=1e-3)
    assert {f.verdict for f in report.firings} == {"same"}
    assert [f.rule_id for f in report.firings] == [f.rule_id for f in applied.firings]
    assert same_times([f.time for f in report.firings], [f.time for f in applied.firings])
    (held,) = [f for f in report.firings if f.rule_id == TRUE_BEFORE]
    assert held.at == pytest.approx(2.0, abs=0.5), "it was true already, and its hold began then"
