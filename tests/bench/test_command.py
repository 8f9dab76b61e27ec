"""``kompass-console bench-nav``, as somebody types it."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from kompass.bench.barn_file import BadWorlds, read_barn
from tests.bench.worlds import world_file
from tests.support.commands import Commands, Done, ended_by
from tests.support.patience import patient

Bench = Callable[..., Done]
BENCH = (str(Path(sys.executable).with_name("kompass-console")), "bench-nav")


@pytest.fixture(scope="module")
def bench() -> Iterator[Bench]:
    """In a process that all of them share: its start takes longer than most drives."""
    with closing(Commands()) as commands:
        yield lambda *arguments: commands.run("bench-nav", *arguments, timeout=80)


def bench_of_its_own(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*BENCH, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=patient(75),
        check=False,
    )


@pytest.mark.slow
def test_it_drives_through_what_it_was_not_told_of_and_says_why_it_gave_up(
    bench: Bench, tmp_path: Path
) -> None:
    lines, page = tmp_path / "found.jsonl", tmp_path / "found.html"
    follower = ("--follower", "pure_pursuit")
    worlds = ("--worlds", world_file(tmp_path), *follower, "--json", lines, "--report", page)
    done = bench_of_its_own(*worlds)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1].startswith("1 of 2 arrived in ")
    assert "2 of 2 drives" in done.stderr
    first, second, means = map(json.loads, lines.read_text(encoding="utf-8").splitlines())
    assert (first["world"], first["outcome"], first["contacts"]) == ("barn_1", "arrived", 0)
    assert 0.0 < first["clearance"] < 0.5
    assert first["end_distance"] < 0.1
    assert first["score"] == pytest.approx(min(0.5, 2.68 / 0.22 / first["time"]), abs=1e-3), (
        "by BARN's metric"
    )
    assert (second["world"], second["outcome"], second["score"]) == ("barn_4", "gave_up", 0.0)
    assert "No way leads" in second["reason"]
    assert second["end_distance"] > 1.0
    assert (means["drives"], means["arrived"], means["touched"]) == (2, 1, 0)
    text = page.read_text(encoding="utf-8")
    assert text.count("<svg") == 1, "a picture of the drive that failed"
    assert "barn_4, seed 0" in text
    # The same again, byte for byte.
    once = lines.read_text(encoding="utf-8").splitlines()[0]
    assert bench(*worlds, "--only", "1").returncode == 0
    assert lines.read_text(encoding="utf-8").splitlines()[0] == once


@pytest.mark.slow
def test_what_was_driven_before_somebody_ended_it_is_written(tmp_path: Path) -> None:
    lines, page = tmp_path / "found.jsonl", tmp_path / "found.html"
    given = ["--worlds", str(world_file(tmp_path)), "--only", "1", "--seeds", "50", "--jobs", "1"]
    files = ["--json", str(lines), "--report", str(page)]

    def first_drive(running: subprocess.Popen[str]) -> Any:
        assert running.stdout is not None
        return json.loads(running.stdout.readline())

    first, code, told, errors = ended_by(signal.SIGINT, [*BENCH, *given, *files], first_drive)
    assert code == 130, errors
    made = len(told.splitlines())  # the first has been read, and the last is the sentence
    assert f"ended by hand after {made} of 50 drives" in errors
    assert "Traceback" not in errors, errors
    assert told.splitlines()[-1].startswith(f"{made} of {made} arrived in ")
    *drives, means = map(json.loads, lines.read_text(encoding="utf-8").splitlines())
    assert (len(drives), means["drives"]) == (made, made)
    assert drives[0]["time"] == first["time"]
    assert page.exists()


@pytest.mark.slow
def test_the_map_is_told_when_it_is_to_be(bench: Bench, tmp_path: Path) -> None:
    worlds = ("--worlds", world_file(tmp_path), "--only", "4", "--map", "known")
    done = bench(*worlds, "--robot", "jackal")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[0])
    # Who has the map knows at once that there is no way.
    assert (found["outcome"], found["robot"]) == ("gave_up", "jackal")
    assert found["driven"] < 0.05


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--only", "1,7"], "--only 7: .*worlds.json has no such world; it has 2, from 1 to 4"),
        (["--only", "one"], "--only one: that is no index; give numbers with commas, as 0,6,12"),
        (
            ["--robot", "husky"],
            "--robot husky: there is no such thing; choose one of turtlebot3, jackal",
        ),
        (
            ["--follower", "MPC"],
            "--follower MPC: there is no such thing; choose one of Stanley, PurePursuit, DWA",
        ),
        (
            ["--follower", "VisionRGBDFollower"],
            "--follower VisionRGBDFollower: it follows a target .*, and no path; choose one of Sta",
        ),
        (
            ["--real", "--jobs", "2"],
            "--jobs 2: with --real there is one drive at a time; leave it out",
        ),
        (["--map", "some"], "--map some: there is no such thing; choose one of known, walls, none"),
        (["--json", "nowhere/x.jsonl"], "--json nowhere/x.jsonl: there is no folder nowhere; make"),
    ],
)
def test_what_is_asked_for_wrongly_is_told_in_a_line(
    bench: Bench, tmp_path: Path, arguments: list[str], said: str
) -> None:
    done = bench("--worlds", world_file(tmp_path), *arguments)
    assert done.returncode == 2, done.stdout
    assert len(done.stderr.splitlines()) == 1

    assert re.search(said, done.stderr), done.stderr


def test_a_file_that_is_not_there_is_told_in_a_line(bench: Bench, tmp_path: Path) -> None:
    done = bench("--worlds", tmp_path / "none.json")
    assert done.returncode == 2
    assert done.stderr.endswith(
        "none.json: No such file or directory; give a file of BARN worlds (JSON)\n"
    )


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"goal": [2.4]}, r"worlds.json: goal.1"),
        ({"goal": [2.4, True]}, r"goal.1 = true: .*valid number"),
        ({"start": [0.0, 0.0, "east"]}, r'start.2 = "east": .*valid number'),
        ({"goal": [2.4, "0.1"]}, r'goal.1 = "0.1": .*valid number'),
        ({"worlds": []}, r"worlds = \[\]: .*at least 1 item"),
        ({"boxes": [[0, 0, 1, 1]]}, r"boxes = .*at most 0 items"),
    ],
)
def test_a_file_that_is_not_as_it_must_be_is_refused_by_field_and_value(
    tmp_path: Path, changes: dict[str, Any], said: str
) -> None:

    with pytest.raises(BadWorlds) as refused:
        read_barn(world_file(tmp_path, **changes))
    assert re.search(said, str(refused.value)), refused.value


def test_a_key_that_is_given_twice_is_refused(tmp_path: Path) -> None:
    file = world_file(tmp_path)
    text = file.read_text(encoding="utf-8")
    file.write_text(text[:-1] + ', "goal": [1.0, 0.0]}', encoding="utf-8")
    with pytest.raises(BadWorlds, match="'goal' is given twice; keep one"):
        read_barn(file)


def test_worlds_that_no_robot_can_start_in_are_refused_before_any_drive(
    bench: Bench, tmp_path: Path
) -> None:
    file = world_file(tmp_path)
    data = json.loads(file.read_text(encoding="utf-8"))
    x, y, _ = data["start"]
    data["worlds"][0]["cylinders"][0] = [x, y, 0.2]
    file.write_text(json.dumps(data), encoding="utf-8")
    done = bench("--worlds", file)
    assert done.returncode == 2
    assert "start" in done.stderr
    assert "keep it" in done.stderr
    assert "ValueError" not in done.stderr
    data["worlds"][0]["cylinders"][0] = [x + 2.0, y, -0.2]
    file.write_text(json.dumps(data), encoding="utf-8")
    done = bench("--worlds", file)
    assert done.returncode == 2
    assert "-0.2" in done.stderr
    assert "Error" not in done.stderr.replace("Error:", "", 1)


def test_a_file_of_worlds_that_is_nested_too_deeply_is_refused(
    bench: Bench, tmp_path: Path
) -> None:
    file = tmp_path / "deep.json"
    file.write_text("[" * 100_000, encoding="utf-8")
    done = bench("--worlds", file)
    assert done.returncode == 2
    assert "deep.json: it is nested too deeply" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["ackermann", "omni"])
def test_robots_that_steer_or_slide_get_through(bench: Bench, tmp_path: Path, robot: str) -> None:
    done = bench("--worlds", world_file(tmp_path), "--only", "1", "--robot", robot)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[0])
    assert (found["outcome"], found["robot"], found["contacts"]) == ("arrived", robot, 0)
    assert found["clearance"] > 0.0
