"""A drive of a drill is made again as a recording, which is read like a robot's."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

import pytest
from kompass_interfaces.msg import DriveState
from rclpy.serialization import deserialize_message, serialize_message
from typer.testing import CliRunner

from kompass.backtest.event_log import Began, Fired
from kompass.drills.drive import DriveResult
from kompass.drills.report_json import read_report
from kompass.drills.runner.recorded_drive import NoScenario, scenario_of
from kompass.drills.scenario import Goal, OperatorAct, Scenario, ScheduledFault, Start
from kompass.drills.scenario_file import read_scenario, scenario_text
from kompass.recorder.mcap.reader import Recording, messages
from kompass.recorder.mcap.writer import McapWriter
from kompass.recorder.replay.backtest import NoRecording, backtest_files
from kompass.recorder.replay.explain import explain_recorded
from kompass.recorder.streams import EVENTS, read_event
from kompass_console.cli import app
from kompass_console.cli_error import CliError
from tests.recorder.test_foxglove import read_by_foxglove
from tests.support.commands import Commands, Done

pytestmark = pytest.mark.slow

RECIPE = Path(__file__).parent / "recipes" / "slow_functions.py"
SCENARIO = Scenario(
    name="there",
    world="hexagon",
    seed=5,
    start=Start(x=-1.5, y=0.5),
    goals=(Goal(x=-1.5, y=-0.5),),
    faults=(
        ScheduledFault(name="lidar_unplugged", at=2.0, duration=6.0),
        ScheduledFault(name="kill:mapper", at=11.0),
    ),
    operators=(
        OperatorAct(at=13.0, does="stop", by="ava", reason="a child"),
        OperatorAct(at=14.0, does="release", by="ava"),
    ),
    limit=20.0,
)


MAKE = """
import sys
from pathlib import Path
from kompass.drills.runner.worker import Order, make_drives
from kompass.drills.scenario_file import parse_scenario

recipe, scenario = Path(sys.argv[1]), parse_scenario(sys.argv[2])
files = [None, *map(Path, sys.argv[3:])]
differs = []
orders = [Order(recipe, scenario, recording=file) for file in files]
for _, result in sorted(make_drives(orders, 2, differs.append)):
    print(result)
sys.exit("".join(differs) or 0)
"""


class Made(NamedTuple):
    """A drive without a recording, and twice with one."""

    result: DriveResult
    recorded: DriveResult
    first: Path
    second: Path


def make(scenario: Scenario, *files: Path) -> list[DriveResult]:
    """Make a drive without a recording, and once with each."""
    # In a process of its own: what forks the drives lives as long as who asked for them.
    done = subprocess.run(
        [sys.executable, "-c", MAKE, str(RECIPE), scenario_text(scenario), *map(str, files)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return [DriveResult.model_validate_json(line) for line in done.stdout.splitlines()]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    folder = tmp_path_factory.mktemp("recordings")
    files = folder / "first.mcap", folder / "second.mcap"
    plain, first, second = make(SCENARIO, *files)
    assert first == second
    return Made(plain, first, *files)


def events(file: Path) -> list[object]:
    """What the engine did."""
    with Recording([file]) as recording:
        wanted = messages(recording.files, lambda track: track.source == EVENTS.source)
        return [read_event(message.data).event for message in wanted]


def test_a_recorded_drive_goes_the_same_way_and_its_file_is_the_same_every_time(made: Made) -> None:
    assert made.recorded == made.result
    assert made.first.read_bytes() == made.second.read_bytes()


def test_a_robot_whose_disk_is_full_is_recorded_to_the_end_of_its_drive(tmp_path: Path) -> None:
    full = ScheduledFault(name="disk_full", at=1.0)  # before there is a path, and its channel
    goals = (Goal(x=0.7, y=-0.5, at=2.0),)
    drive = Scenario(name="full", world="hexagon", goals=goals, faults=(full,), limit=8.0)
    file = tmp_path / "full.mcap"
    plain, recorded = make(drive, file)
    assert recorded == plain
    with Recording([file]) as recording:
        planned = list(messages(recording.files, lambda track: track.topic == "/plan"))
        assert planned
        assert recording.end_time - planned[0].log_time > 4e9


def test_functions_that_sleep_and_wait_take_virtual_time(made: Made) -> None:
    firing = next(each for each in made.result.firings if each.rule_id == "blind")
    assert [each.text for each in firing.actions] == ["pondered for 2.000 s", "mused for 3.000 s"]
    assert firing.ended is not None
    assert firing.ended - firing.at == pytest.approx(5.0, abs=0.1)


def test_the_back_test_of_the_same_rules_gives_the_same_firings(made: Made) -> None:
    began = events(made.first)[0]
    assert isinstance(began, Began)
    report, remark = backtest_files(began.table, [made.first])
    assert remark == ""
    assert {each.verdict for each in report.firings} == {"same"}
    told = [(each.rule_id, round(each.time - began.wall + began.now, 3)) for each in report.firings]
    fired = [event for event in events(made.first) if isinstance(event, Fired)]
    assert told == [(event.rule_id, round(event.now, 3)) for event in fired]
    assert {rule_id for rule_id, _ in told} == {"blind"}
    # Its seconds are those of the drive, as in the drill's report.
    assert [each.at for each in report.firings] == pytest.approx(
        [each.at for each in made.result.firings], abs=0.05
    )


def test_a_file_is_back_tested_where_there_is_no_robot(made: Made, tmp_path: Path) -> None:
    began = events(made.first)[0]
    assert isinstance(began, Began)
    rules = tmp_path / "then.json"
    rules.write_text(began.table.model_dump_json())
    asked = ["rules", "backtest", "--recording", str(made.first)]
    tried = CliRunner().invoke(app, [*asked, str(rules)])
    assert f"{len(made.result.firings)} firings the same" in tried.output
    refused = CliRunner().invoke(app, asked).exception
    assert isinstance(refused, CliError)
    assert "it is a file here; give the table to try, too" in str(refused)


def test_foxglove_reads_it_with_all_that_a_robot_records(made: Made) -> None:
    found = read_by_foxglove(made.first)
    topics = {each["topic"] for each in found}
    assert topics >= {
        *("/scan", "/odometry/filtered", "/tf", "/tf_static", "/map", "/cmd_vel", "/plan"),
        *("/planner/status", "/drive_state", "/monitor/stack_state", "/monitor/firings"),
        *("/monitor/engine", "/simulator/faults"),
    }
    stopped = [each["message"]["stopped_by"] for each in found if each["topic"] == "/drive_state"]
    assert "ava" in stopped


def test_it_explains_why_a_rule_fired_and_why_not(made: Made) -> None:
    fired = next(event for event in events(made.first) if isinstance(event, Fired))
    told = next(each for each in made.result.firings if each.rule_id == "blind")
    then, at = explain_recorded(made.first, "blind", run=fired.run_id)
    assert at == pytest.approx(told.at, abs=0.05)
    assert then.firing is not None
    assert then.firing.ok
    assert [leaf.verdict for leaf in then.leaves] == [True]
    before, at = explain_recorded(made.first, "blind", at=told.at - 0.5)
    assert at == pytest.approx(told.at - 0.5, abs=0.001)
    assert before.text.startswith("false: controller/status.status == 3")
    assert before.time == pytest.approx(then.time - 0.5, abs=0.05)
    with pytest.raises(NoRecording, match=r"at = 999 s is after its end, at \d+\.\d s"):
        explain_recorded(made.first, "blind", at=999.0)
    with pytest.raises(NoRecording, match="its runs are"):
        explain_recorded(made.first, "blind", run=77)
    with pytest.raises(NoRecording, match="there were: blind, clicked"):
        explain_recorded(made.first, "other")
    with pytest.raises(NoRecording, match="no rule 'blnd' was in force in it; did you mean 'bli"):
        explain_recorded(made.first, "blnd", run=fired.run_id)


def test_the_recording_of_a_drill_gives_back_its_scenario(made: Made) -> None:
    found = scenario_of(made.first, "there", None, None)
    assert found.scenario == SCENARIO


def test_a_stretch_becomes_a_scenario_as_it_was_seen(made: Made, tmp_path: Path) -> None:
    found = scenario_of(made.first, "seen", 0.0, None)
    (lidar, killed), scenario = found.scenario.faults, found.scenario
    assert scenario.world == "hexagon"
    assert (scenario.start or Start(x=0.0, y=0.0)).x == pytest.approx(-1.5, abs=0.1)
    assert (lidar.name, killed.name) == ("lidar_unplugged", "kill:mapper")
    assert lidar.at == pytest.approx(2.0, abs=0.15)
    assert lidar.duration == pytest.approx(6.0, abs=0.15)
    assert killed.at == pytest.approx(11.0, abs=0.15)
    assert [(act.does, act.by) for act in scenario.operators] == [
        ("stop", "ava"),
        ("release", "ava"),
    ]
    assert scenario.goals[0].y == pytest.approx(-0.5)
    assert any("sent as an action" in remark for remark in found.remarks)
    assert found.table is not None
    (tmp_path / "seen.yaml").write_text(scenario_text(scenario))
    assert read_scenario(tmp_path / "seen.yaml") == scenario


def rewritten(
    recorded: Path, written: Path, change: Callable[[str, float, bytes], bytes | None]
) -> Path:
    """A recording with other messages: what is made of topic, time [s] and data; None for none."""
    with Recording([recorded]) as recording:
        writer = McapWriter(written)
        writer.add_metadata("kompass", recording.files[0].contents.metadata["kompass"])
        channels: dict[str, int] = {}
        first: int | None = None
        for message in messages(recording.files, lambda _: True):
            first = message.log_time if first is None else first
            track = message.track
            data = change(track.topic, (message.log_time - first) * 1e-9, message.data)
            if data is None:
                continue
            if track.topic not in channels:
                metadata = {**track.channel.metadata, "source": track.source}
                channels[track.topic] = writer.add_channel(
                    track.topic, track.encoding, track.schema, metadata
                )
            writer.add_message(channels[track.topic], message.log_time, data, message.publish_time)
        writer.finish()
    return written


def test_a_hand_that_drove_is_told_of_and_left_out(made: Made, tmp_path: Path) -> None:
    def by_hand(topic: str, at: float, data: bytes) -> bytes:
        if topic == "/drive_state" and 6.0 < at < 9.0:
            state = deserialize_message(data, DriveState)
            state.driven_by = "ava"
            return bytes(serialize_message(state))
        return data

    driven = rewritten(made.first, tmp_path / "driven.mcap", by_hand)
    (told,) = [
        said for said in scenario_of(driven, "driven", 0.0, None).remarks if "by hand" in said
    ]
    found = re.search(r"ava drove by hand from (\S+) s to (\S+) s", told)
    assert found, told
    assert float(found[2]) - float(found[1]) == pytest.approx(3.0, abs=0.5)
    assert not any("by hand" in said for said in scenario_of(made.first, "x", 0.0, None).remarks)


def test_faults_are_taken_from_silence_where_nobody_told_of_them(
    made: Made, tmp_path: Path
) -> None:
    silent = rewritten(
        made.first,
        tmp_path / "silent.mcap",
        lambda topic, _, data: None if topic == "/simulator/faults" else data,
    )
    found = scenario_of(silent, "silent", 2.0, None)
    assert [fault.name for fault in found.scenario.faults] == ["lidar_unplugged", "kill:mapper"]
    assert found.scenario.faults[0].duration == pytest.approx(6.0, abs=0.4)
    assert any("silence of sensors" in remark for remark in found.remarks)


def test_what_is_missing_in_a_recording_is_told(made: Made, tmp_path: Path) -> None:
    with pytest.raises(NoScenario, match="there is nothing: the recording lasts"):
        scenario_of(made.first, "late", 90.0, None)
    empty = tmp_path / "empty.mcap"
    writer = McapWriter(empty)
    schema = ("nav_msgs/msg/Odometry", "", b"")
    channel = writer.add_channel("/odometry/filtered", "cdr", schema, {})
    data = b""
    with Recording([made.first]) as recording:
        for message in messages(recording.files, lambda t: t.topic == "/odometry/filtered"):
            data = message.data
    for at in (1_000_000_000, 3_000_000_000):
        writer.add_message(channel, at, data, at)
    writer.finish()
    with pytest.raises(NoScenario, match="it has no /map: nobody knows where that was"):
        scenario_of(empty, "empty", None, None)


Cli = Callable[..., Done]


@pytest.fixture(scope="module")
def cli() -> Iterator[Cli]:
    """``kompass-console drill …``."""
    with closing(Commands()) as commands:
        yield lambda *arguments: commands.run("drill", *arguments)


def whimsical(*arguments: str) -> subprocess.CompletedProcess[str]:
    """``kompass-console drill …``, of a recipe that has whims."""
    command = [str(Path(sys.executable).with_name("kompass-console")), "drill", *arguments]
    environment = {**os.environ, "WHIMS": "1"}
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)


def test_the_command_line_replays_a_drive_by_its_name(made: Made, cli: Cli, tmp_path: Path) -> None:
    scenario, output = tmp_path / "there.yaml", tmp_path / "there.mcap"
    scenario.write_text(scenario_text(SCENARIO))
    options = ("--recipe", str(RECIPE), "--scenario", str(scenario), "-o", str(output))
    unknown = cli("replay", "elsewhere", *options)
    assert unknown.returncode == 2
    assert "has no such scenario; it has there" in unknown.stderr
    done = cli("replay", "there", *options)
    assert done.returncode == 0, done.stderr
    assert made.result.why in done.stdout
    assert output.read_bytes() == made.first.read_bytes()
    again = cli("replay", "there", *options)
    assert again.returncode == 2
    assert "there is such a file; give another name" in again.stderr
    assert list(tmp_path.glob(".*")) == []


def test_a_recipe_that_is_not_the_same_twice_is_told_of_and_named(tmp_path: Path) -> None:
    scenario, report = tmp_path / "there.yaml", tmp_path / "report.json"
    page = tmp_path / "report.html"
    short = SCENARIO.model_copy(update={"faults": (), "operators": (), "limit": 5.0})
    scenario.write_text(scenario_text(short))
    done = whimsical(
        *(str(RECIPE), "--scenarios", str(scenario), "--json", str(report)),
        *("--report", str(page)),
    )
    assert done.returncode == 4, done.stdout + done.stderr
    first = done.stdout.splitlines()[0]
    assert first.startswith("! The recipe is not the same twice: drive there, made twice, differs")
    assert "whim" in first
    assert "at=" not in first, "what differs is told as people read it"
    assert "no seed decides" in first
    (note,) = read_report(report.read_text()).notes
    assert first == f"! {note}"
    assert "The recipe is not the same twice" in page.read_text()


RECIPES = sorted((Path(__file__).parents[2] / "recipes").glob("0[5-8]_*.py"))


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda path: path.stem)
def test_recipes_of_every_kind_are_drilled_and_are_the_same_twice(
    cli: Cli, recipe: Path, tmp_path: Path
) -> None:
    scenario, report = tmp_path / "there.yaml", tmp_path / "report.json"
    plain = SCENARIO.model_copy(update={"faults": (), "operators": (), "limit": 30.0})
    scenario.write_text(scenario_text(plain))
    done = cli("run", str(recipe), "--scenarios", str(scenario), "--json", str(report))
    assert done.returncode == 0, done.stdout + done.stderr
    (drive,) = read_report(report.read_text()).drives
    assert drive.outcome == "arrived"
