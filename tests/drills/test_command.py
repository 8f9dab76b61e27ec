"""``kompass-console drill``, as somebody types it."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import pytest

from kompass.drills.report_json import TableName, read_report
from kompass.drills.scenario_file import read_scenarios
from kompass.rules.schema.table import Table
from tests.drills.test_runner import WITHOUT_PLANNER
from tests.support.commands import Commands, Done, ended_by
from tests.support.patience import patient
from tests.support.processes import wait_until

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
GUARDED = ROOT / "recipes/03_events_and_actions.py"
SCENARIO = """\
name: mapper
world: hexagon
start: {x: -2.0, y: -0.5}
goals: [{x: 0.7, y: -0.5, at: 2.0}]
faults: [{name: "kill:mapper", at: 6.0}]
"""


CAR = f"""\
import os
import runpy

os.environ |= {{"ROBOT": "ackermann", "FOLLOWER": "MPPI"}}
runpy.run_path({str(ROOT / "benchmarks/recipes/followed.py")!r}, run_name="__main__")
"""


Drill = Callable[..., Done]
DRILL = (str(Path(sys.executable).with_name("kompass-console")), "drill")


def drill_of_its_own(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*DRILL, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=patient(60),  # drives give way to whatever else runs
        check=False,
    )


@pytest.fixture(scope="module")
def drill() -> Iterator[Drill]:
    """In a process that all of them share: its start takes longer than most drives."""
    with closing(Commands()) as commands:
        yield lambda *arguments: commands.run("drill", *arguments)


def test_it_says_what_became_of_the_drives_and_writes_it_down(tmp_path: Path) -> None:
    found, page = tmp_path / "drill.json", tmp_path / "drill.html"
    done = drill_of_its_own(
        *(GUARDED, "--seeds", "2", "--faults", "kill:mapper", "--json", found, "--report", page),
        *("--require", "recovered >= 0.9, contacts == 0"),
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("Recovers in 2 of 2 disturbed drives.")
    assert "2 of 2 drives" in done.stderr
    report = read_report(found.read_text(encoding="utf-8"))
    assert [drive.outcome for drive in report.drives] == ["recovered", "recovered"]
    assert "Recovers in 2 of 2" in page.read_text(encoding="utf-8")


def test_two_runs_of_one_seed_write_the_same_bytes(drill: Drill, tmp_path: Path) -> None:
    written = []
    for jobs, run in (("1", drill), ("2", drill_of_its_own)):
        file = tmp_path / f"{jobs}.json"
        done = run(GUARDED, "--seeds", "2", "--faults", "all", "--jobs", jobs, "--json", file)
        assert done.returncode == 0, done.stderr
        written.append(file.read_bytes())
    assert written[0] == written[1]


def test_what_is_required_and_not_met_ends_with_1(drill: Drill, tmp_path: Path) -> None:
    (tmp_path / "one.yaml").write_text(SCENARIO, encoding="utf-8")
    done = drill(GUARDED, "--scenarios", tmp_path, "--require", "recovered == 0")
    assert done.returncode == 1
    assert "recovered == 0: not met" in done.stdout


def test_a_table_is_compared_with_another_drive_by_drive(drill: Drill, tmp_path: Path) -> None:
    scenario = SCENARIO.replace(
        '{name: "kill:mapper", at: 6.0}', "{name: boxed_in, at: 6, duration: 40}"
    )
    (tmp_path / "one.yaml").write_text(scenario, encoding="utf-8")
    (tmp_path / "none.json").write_text(json.dumps({"rules": []}), encoding="utf-8")
    done = drill(
        *(GUARDED, "--scenarios", tmp_path, "--rules", tmp_path / "none.json"),
        *("--against", "recipe"),
    )
    assert done.returncode == 0, done.stderr
    assert "mapper: “Controller stuck → unblock” fired never instead of once" in done.stdout


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_what_was_driven_under_both_tables_before_somebody_ended_it_is_compared_and_written(
    tmp_path: Path, sent: signal.Signals
) -> None:
    found, page, none = tmp_path / "drill.json", tmp_path / "drill.html", tmp_path / "none.json"
    none.write_text(json.dumps({"rules": []}), encoding="utf-8")
    given = ["--rules", str(none), "--against", "recipe", "--seeds", "50", "--jobs", "1"]
    files = ["--json", str(found), "--report", str(page)]

    def four_drives(running: subprocess.Popen[str]) -> None:
        assert running.stderr is not None
        while int(running.stderr.readline().split(" of ")[0]) < 4:
            pass

    _, code, told, errors = ended_by(
        sent, [*DRILL, str(GUARDED), *given, *files, "--faults", "kill:mapper"], four_drives
    )
    assert code == 130, errors
    assert "Traceback" not in errors, errors
    report = read_report(found.read_text(encoding="utf-8"))
    assert 1 <= len(report.drives) < 50
    assert [d.scenario.name for d in report.drives] == [
        d.scenario.name for d in report.drives_against
    ]
    assert "ended by hand: comparing what was driven" in errors
    (note,) = report.notes  # and none that the first drive was not made twice
    assert note.startswith("ended by hand after ")
    assert note.endswith(" of 100 drives")
    assert note in errors
    assert told.splitlines()[0] == f"! {note}"
    assert note in page.read_text(encoding="utf-8")


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_a_drill_that_is_ended_while_the_recipe_is_read_says_so(
    tmp_path: Path, sent: signal.Signals
) -> None:
    recipe, begun = tmp_path / "endless.py", tmp_path / "begun"
    recipe.write_text(f"open({str(begun)!r}, 'w').close()\nwhile True:\n    pass\n")
    _, code, told, errors = ended_by(
        sent,
        [*DRILL, str(recipe)],
        lambda _: wait_until(begun.exists, 60, "that the recipe is read"),
    )
    assert (code, told) == (130, "")
    assert errors.strip().endswith("ended by hand before a drive was made")
    assert len(errors.splitlines()) == 1


def test_a_drill_that_is_ended_before_its_first_drive_was_made_twice_says_so(
    tmp_path: Path,
) -> None:
    recipe, found = tmp_path / "slow.py", tmp_path / "drill.json"
    # From its third start on, which is that of the second making, it does not come to an end.
    recipe.write_text(
        "import pathlib, threading\n"
        "runs = pathlib.Path(__file__).with_name('runs')\n"
        "with runs.open('a') as file:\n"
        "    print('another', file=file)\n"
        "if len(runs.read_text().splitlines()) > 2:\n"
        "    threading.Event().wait()\n" + GUARDED.read_text(encoding="utf-8"),
        encoding="utf-8",
    )

    def one_drive(running: subprocess.Popen[str]) -> None:
        assert running.stderr is not None
        assert running.stderr.readline().startswith("1 of 1")

    _, code, told, errors = ended_by(
        signal.SIGINT,
        [*DRILL, str(recipe), "--seeds", "1", "--faults", "", "--jobs", "1", "--json", str(found)],
        one_drive,
    )
    assert code == 130, errors
    notes = read_report(found.read_text(encoding="utf-8")).notes
    assert notes[0] == "ended by hand after 1 of 1 drives"
    assert "whether the recipe is the same twice was not found out" in notes[1]
    assert f"! {notes[1]}" in told


def test_a_report_that_cannot_be_written_is_told_of_and_the_other_is_written(
    drill: Drill, tmp_path: Path
) -> None:
    page = tmp_path / "drill.html"
    one = (GUARDED, "--seeds", "1", "--faults", "", "--report", page)
    done = drill(*one, "--json", "/dev/full")
    assert done.returncode == 2
    (line,) = (one for one in done.stderr.splitlines() if "--json" in one)
    assert line.endswith(
        "--json /dev/full: it cannot be written (No space left on device); give another file"
    )
    assert "No fault disturbed any drive." in done.stdout
    assert page.exists()


def test_what_was_driven_before_a_drive_could_not_be_made_is_told_and_written(
    drill: Drill, tmp_path: Path
) -> None:
    recipe, found = tmp_path / "ends.py", tmp_path / "drill.json"
    # It ends its process, but not at first.
    recipe.write_text(
        "import os, pathlib\n"
        "runs = pathlib.Path(__file__).with_name('runs')\n"
        "with runs.open('a') as file:\n"
        "    print('another', file=file)\n"
        "if len(runs.read_text().splitlines()) > 4:\n"
        "    os._exit(1)\n" + GUARDED.read_text(encoding="utf-8"),
        encoding="utf-8",
    )
    done = drill(recipe, "--seeds", "9", "--faults", "", "--jobs", "1", "--json", found)
    assert done.returncode == 3
    assert "its process ended" in done.stderr
    report = read_report(found.read_text(encoding="utf-8"))
    assert 1 <= len(report.drives) < 9
    assert "its process ended" in report.notes[-1]
    assert "No fault disturbed any drive." in done.stdout


def test_a_scenario_is_driven_several_times_with_other_noise_and_replayed_by_name(
    drill: Drill, tmp_path: Path
) -> None:
    (tmp_path / "one.yaml").write_text(SCENARIO, encoding="utf-8")
    found, page = tmp_path / "drill.json", tmp_path / "drill.html"
    twice = ("--scenarios", tmp_path, "--seeds", "2")
    made = drill(GUARDED, *twice, "--json", found, "--report", page)
    assert made.returncode == 0, made.stderr
    first, second = read_report(found.read_text(encoding="utf-8")).drives
    assert first.scenario.name == "mapper-0"
    assert first.scenario.seed != second.scenario.seed
    for called in ("mapper-1", "1"):
        again = tmp_path / f"{called}.mcap"
        done = drill("replay", called, "--recipe", GUARDED, "--scenario", tmp_path, "-o", again)
        assert done.returncode == 0, done.stderr
        assert f"mapper-1: {second.why}" in done.stdout
    command = f"replay mapper-0 --recipe {GUARDED.name} --seed 1 --scenario SCENARIO.yaml -o"
    assert command in page.read_text(encoding="utf-8")


def test_faults_that_never_end_are_drawn_and_the_report_says_how(
    drill: Drill, tmp_path: Path
) -> None:
    found, page = tmp_path / "drill.json", tmp_path / "drill.html"
    options = ("--faults", "person_ahead", "--seeds", "1", "--lasting", "1")
    made = drill(GUARDED, *options, "--json", found, "--report", page)
    assert made.returncode == 0, made.stderr
    (drive,) = read_report(found.read_text(encoding="utf-8")).drives
    assert [fault.duration for fault in drive.scenario.faults] == [0.0]
    assert "--lasting 1" in page.read_text(encoding="utf-8")


def test_several_faults_strike_in_one_drive_and_it_is_made_again_with_them(
    drill: Drill, tmp_path: Path
) -> None:
    found, again = tmp_path / "drill.json", tmp_path / "again.mcap"
    both = ("--faults", "way_blocked,kill:mapper", "--faults-per-drive", "2")
    made = drill(GUARDED, *both, "--seeds", "1", "--rules", "recipe", "--json", found)
    assert made.returncode == 0, made.stderr
    report = read_report(found.read_text(encoding="utf-8"))
    (drive,) = report.drives
    assert {fault.name for fault in drive.scenario.faults} == {"way_blocked", "kill:mapper"}
    done = drill("replay", drive.scenario.name, "--recipe", GUARDED, *both, "-o", again)
    assert done.returncode == 0, done.stderr
    assert drive.why in done.stdout
    kept, rules = tmp_path / "again.yaml", tmp_path / "then.json"
    assert drill("scenario", again, "-o", kept, "--rules", rules).returncode == 0
    (scenario,) = read_scenarios(kept)
    assert scenario.faults == drive.scenario.faults
    then = Table.model_validate_json(rules.read_text(encoding="utf-8"))
    assert TableName.of("recipe", then) == report.table


def test_a_recipe_of_a_car_is_driven_by_a_car_and_its_drive_is_made_again_with_one(
    drill: Drill, tmp_path: Path
) -> None:
    recipe, found = tmp_path / "car.py", tmp_path / "drill.json"
    recipe.write_text(CAR, encoding="utf-8")
    options = ("--faults", "")
    made = drill(recipe, *options, "--seeds", "1", "--json", found)
    assert made.returncode == 0, made.stderr
    (drive,) = read_report(found.read_text(encoding="utf-8")).drives
    assert (drive.scenario.robot, drive.outcome) == ("ackermann", "arrived")
    assert not made.stdout.startswith("!")
    again, kept = tmp_path / "again.mcap", tmp_path / "again.yaml"
    done = drill("replay", drive.scenario.name, "--recipe", recipe, *options, "-o", again)
    assert drive.why in done.stdout
    assert drill("scenario", again, "--from", "0", "-o", kept).returncode == 0
    (scenario,) = read_scenarios(kept)
    assert scenario.robot == "ackermann"


def test_a_robot_that_is_too_large_for_the_usual_world_drives_in_another(
    drill: Drill, tmp_path: Path
) -> None:
    recipe = tmp_path / "large.py"
    small = "geometry_params=np.array([0.1, 0.3])"
    text = GUARDED.read_text(encoding="utf-8")
    assert small in text
    recipe.write_text(text.replace(small, "geometry_params=np.array([0.7, 0.3])"))
    options = ("--faults", "", "--seeds", "1", "--jobs", "1")
    made = drill(recipe, *options)
    assert made.stdout.startswith("! The hexagon has no room for turtlebot3: these drives are in ")
    refused = drill(recipe, *options, "--worlds", "hexagon")
    assert refused.returncode == 2
    assert "which needs 0.80 m on every side; take one that has: " in refused.stderr


def test_a_robot_that_is_not_like_the_one_of_the_recipe_is_told_of(
    drill: Drill, tmp_path: Path
) -> None:
    short = ("--faults", "", "--seeds", "1", "--jobs", "1", "--json", tmp_path / "drill.json")
    done = drill(GUARDED, *short, "--robot", "omni")
    assert done.stdout.startswith("! The recipe describes a robot that moves as DIFFERENTIAL_DRIVE")
    done = drill(GUARDED, *short, "--robot", "jackal")
    assert done.stdout.startswith("! jackal reaches 0.33 m from its middle, and the recipe descri")
    (note,) = read_report((tmp_path / "drill.json").read_text(encoding="utf-8")).notes
    assert "describes 0.10 m" in note
    assert not drill(GUARDED, *short).stdout.startswith("!")


def test_a_recipe_of_several_sensors_is_driven_by_a_robot_that_has_them(
    drill: Drill, tmp_path: Path
) -> None:
    several = ROOT / "recipes/09_several_sensors.py"
    short = ("--faults", "", "--seeds", "1", "--jobs", "1")
    done = drill(several, *short)
    assert done.stdout.startswith("No fault disturbed any drive.\n")
    done = drill(several, *short, "--robot", "turtlebot3")
    assert done.stdout.startswith("! The recipe listens to /camera/points and /rear_scan, which")
    assert "No fault disturbed any drive; reaches its goals in 0 of 1." in done.stdout


def test_another_robot_drives_where_somebody_names_it(drill: Drill, tmp_path: Path) -> None:
    found, page = tmp_path / "drill.json", tmp_path / "drill.html"
    plus = ("--robot", "turtlebot3-plus", "--faults", "low_box", "--seeds", "1")
    done = drill(GUARDED, *plus, "--json", found, "--report", page)
    assert done.returncode in (0, 1), done.stderr
    (drive,) = read_report(found.read_text(encoding="utf-8")).drives
    assert drive.scenario.robot == "turtlebot3-plus"
    assert not drive.refused
    assert "03_events_and_actions.py, driven by turtlebot3-plus" in page.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["nowhere.py"], "there is no recipe nowhere.py"),
        ([GUARDED, "--faults", "flood"], "--faults: there is no fault 'flood'"),
        (
            [GUARDED, "--faults", "kill:plannr"],
            "'plannr'; did you mean 'planner'?",
        ),
        ([GUARDED, "--faults", "hang:simulator"], "no process or node 'simulator'"),
        ([GUARDED, "--worlds", "mars"], "--worlds: world is 'mars', which does not exist"),
        ([GUARDED, "--robot", "jackl"], "--robot jackl: there is no such robot; known are turtleb"),
        ([GUARDED, "--faults", "low_box"], "--faults: fault 'low_box': the robot turtlebot3 has"),
        ([GUARDED, "--robot", "omni", "--scenarios", "."], "--robot: the scenarios of"),
        ([GUARDED, "--rules", "none.json"], "--rules none.json: there is no such file"),
        ([GUARDED, "--require", "speed > 1"], "--require: "),
        ([GUARDED, "--require", ""], "--require: nothing is required; give for example"),
        ([GUARDED, "--json", "one", "--report", "./one"], "--report one: --json goes to the same"),
        (
            [GUARDED, "--seeds", "9", "--require", "contacts == 0, recovered >= 10"],
            "--require: 'recovered >= 10' cannot be met: there are 9 drives",
        ),
        ([GUARDED, "--json", "no/where.json"], "--json no/where.json: there is no folder no"),
        ([GUARDED, "--report", "/proc/x.html"], "--report /proc/x.html: it cannot be written ("),
        ([GUARDED, "--scenarios", "no"], "--scenarios: "),
        (
            [GUARDED, "--scenarios", ".", "--lasting", "0.5"],
            "--lasting: the scenarios of --scenarios say it themselves; leave it out",
        ),
        ([GUARDED, "--scenarios", ".", "--faults", "kill"], "--faults: the scenarios of"),
    ],
)
def test_what_is_wrong_is_told_before_anything_drives(
    drill: Drill, arguments: list[str | Path], said: str
) -> None:
    done = drill(*arguments)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert said in line


def test_a_scenario_of_a_process_that_the_recipe_does_not_have_is_refused(
    drill: Drill, tmp_path: Path
) -> None:
    file = tmp_path / "one.yaml"
    file.write_text(SCENARIO.replace("kill:mapper", "kill:maper"), encoding="utf-8")
    done = drill(GUARDED, "--scenarios", file)
    assert done.returncode == 2
    assert "scenario mapper: fault 'kill:maper': the recipe has no process" in done.stderr


def test_a_fault_that_did_not_begin_is_told(drill: Drill, tmp_path: Path) -> None:
    file = tmp_path / "one.yaml"
    both = '{name: "kill:mapper", at: 6.0}, {name: "stop:mapper", at: 6.02}'
    file.write_text(SCENARIO.replace('{name: "kill:mapper", at: 6.0}', both), encoding="utf-8")
    done = drill(GUARDED, "--scenarios", file)
    assert done.returncode == 0, done.stderr
    assert "mapper: stop:mapper did not begin at 6.05 s: mapper is dead" in done.stdout


def test_a_recipe_that_cannot_be_drilled_says_why(drill: Drill, tmp_path: Path) -> None:
    recipe = tmp_path / "halting.py"
    recipe.write_text(WITHOUT_PLANNER, encoding="utf-8")
    done = drill(recipe, "--seeds", "1")
    assert done.returncode == 3
    (line,) = done.stderr.splitlines()
    assert "halting.py: no component" in line


def test_what_a_recipe_starts_ends_with_its_drive(drill: Drill, tmp_path: Path) -> None:
    recipe, started = tmp_path / "starting.py", tmp_path / "started"
    recipe.write_text(
        "import subprocess\n"
        # One of its own, and one that has left everybody.
        "own = subprocess.Popen(['sleep', '120'])\n"
        "left = subprocess.run(['sh', '-c', 'setsid sleep 120 >&- 2>&- & echo $!'],\n"
        "    capture_output=True, text=True).stdout\n"
        f"with open({str(started)!r}, 'a') as file:\n"
        "    print(own.pid, left, file=file)\n" + GUARDED.read_text(encoding="utf-8"),
        encoding="utf-8",
    )
    done = drill(recipe, "--seeds", "1", "--faults", "")
    assert done.returncode == 0, done.stderr
    pids = started.read_text().split()
    assert len(pids) == 6  # the recipe was read, driven, and driven again
    wait_until(
        lambda: not any(Path("/proc", pid).exists() for pid in pids), 20, "that all have ended"
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("import sys; sys.exit(0)", "calls sys.exit(0); leave that out"),
        ("import os; os._exit(0)", "its process ended with code 0; look whether the recipe"),
        (
            "import os; os.kill(os.getpid(), 9)",
            "its process was killed (SIGKILL); look whether",
        ),
        (
            "import ctypes; ctypes.string_at(0)",
            "its process ended by SIGSEGV, an error in",
        ),
        ("raise KeyboardInterrupt", "RuntimeError: KeyboardInterrupt is raised"),
        ("raise RuntimeError('red: \\x1b[31m\\nnext')", r"RuntimeError: red: \x1b[31m\nnext"),
    ],
)
def test_a_recipe_that_ends_itself_has_not_passed(
    drill: Drill, tmp_path: Path, text: str, said: str
) -> None:
    recipe = tmp_path / "ending.py"
    recipe.write_text(text, encoding="utf-8")
    done = drill(recipe, "--seeds", "1", "--require", "contacts == 0")
    assert done.returncode == 3
    assert "ending.py: " in done.stderr
    assert said in done.stderr
