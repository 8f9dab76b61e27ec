"""A scenario is read as it is written, or refused with the place, the value and the remedy."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kompass.drills.draw import expand_faults, fits
from kompass.drills.scenario import (
    Goal,
    OperatorAct,
    Scenario,
    ScheduledFault,
    Start,
)
from kompass.drills.scenario_file import (
    BadScenario,
    parse_scenario,
    read_scenario,
    read_scenarios,
    scenario_text,
)
from kompass.simulation.worlds.registry import world, world_names

GOOD = """\
name: crate in the aisle
world: warehouse
seed: 3
start: {x: 1.2, y: 1.0}
goals:
  - {x: 12.0, y: 8.0, yaw: 1.57, tolerance: 0.2}
  - {x: 1.2, y: 1.0, at: 90}
faults:
  - {name: way_blocked, at: 8, duration: 20}
  - name: kill:controller
    at: 30.5
operators:
  - {at: 40, does: stop, by: ava, reason: a child}
  - {at: 45, does: release, by: ava}
limit: 180
"""

FAULTS = expand_faults(["all"], ("planner", "controller", "mapper", "drive_manager"))
NAMES = st.text(st.characters(codec="utf-8"), min_size=1, max_size=20).filter(
    lambda text: text.isprintable() and text == text.strip() and bool(text)
)
COORDINATES = st.floats(-1000, 1000)


@st.composite
def scenarios(draw: st.DrawFn) -> Scenario:
    place = world(draw(st.sampled_from(world_names())))
    at = st.floats(0, 99)
    faults = []
    usable = [name for name in FAULTS if fits(name, place)]
    for name in draw(st.lists(st.sampled_from(usable), unique=True, max_size=4)):
        lasts = draw(st.floats(0, 500)) if not name.startswith("kill:") else 0.0
        begins = draw(at) if name != "map_withheld" else 0.0
        faults.append(ScheduledFault(name=name, at=begins, duration=lasts))
    times = sorted(draw(st.lists(at, min_size=1, max_size=4)))
    goals = tuple(
        Goal(
            x=draw(COORDINATES),
            y=draw(COORDINATES),
            yaw=draw(st.floats(-math.pi, math.pi)),
            tolerance=draw(st.none() | st.floats(0.01, 5)),
            heading_tolerance=draw(st.none() | st.floats(0.01, 3)),
            at=draw(st.sampled_from([None, time])),
        )
        for time in times
    )
    x, y, yaw = place.start
    return Scenario(
        name=draw(NAMES),
        world=place.name,
        seed=draw(st.integers(0, 2**63 - 1)),
        start=draw(st.none() | st.just(Start(x=x, y=y, yaw=yaw))),
        goals=goals,
        faults=tuple(faults),
        operators=draw(
            st.lists(
                st.builds(
                    OperatorAct, at=at, does=st.sampled_from(["stop", "release"]), by=NAMES,
                    reason=NAMES,
                ),
                max_size=3,
            ).map(tuple)
        ),
        limit=draw(st.floats(100, 3600)),
    )  # fmt: skip


@given(scenarios())
def test_what_is_written_is_read_back_and_written_the_same_way(scenario: Scenario) -> None:
    text = scenario_text(scenario)
    again = parse_scenario(text)
    assert again == scenario
    assert scenario_text(again) == text


def test_a_file_says_all_of_it(tmp_path: Path) -> None:
    file = tmp_path / "crate.yaml"
    file.write_text(GOOD)
    read = read_scenario(file)
    assert read.first_pose == (1.2, 1.0, 0.0)
    assert [fault.name for fault in read.faults] == ["way_blocked", "kill:controller"]
    assert read.goals[1].at == 90.0
    assert [act.does for act in read.operators] == ["stop", "release"]
    assert (
        read_scenario(file).model_copy(update={"start": None}).first_pose
        == world("warehouse").start
    )


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("world: warehouse", "world: warehous",
         'crate.yaml:2: world = "warehous": there is no such world; choose one of: hexagon'),
        ("world: warehouse", "world: warehouse\nrobot: jackl",
         'crate.yaml:3: robot = "jackl": there is no such robot; choose one of: turtlebot3, '),
        ("start: {x: 1.2, y: 1.0}", "robot: jackal\nstart: {x: 1.2, y: 0.24}",
         "that is 0.02 m from something solid; keep a side of its body 0.05 m away"),
        ("name: way_blocked", "name: low_box",
         "faults[0].name = \"low_box\": fault 'low_box': the robot turtlebot3 has no camera"),
        ("name: way_blocked", "name: way_bloked",
         "crate.yaml:9: faults[0].name = \"way_bloked\": there is no fault 'way_bloked'; "
         "did you mean 'way_blocked'?"),
        ("name: kill:controller", "name: kill",
         'crate.yaml:10: faults[1].name = "kill": fault'),
        ("limit: 180", "limt: 180",
         "limt = 180: there is no such field; did you mean 'limit'? known are name, world"),
        ("tolerance: 0.2", "tolerence: 0.2",
         "crate.yaml:6: goals[0].tolerence = 0.2: there is no such field; did you mean "
         "'tolerance'?"),
        ("at: 30.5", "at: '30.5'",
         'crate.yaml:11: faults[1].at = "30.5": that is no number; give one, without'),
        ("at: 30.5", "at: 3e1",
         'crate.yaml:11: faults[1].at = "3e1": YAML takes that for text; give it a point and a'),
        ("name: crate in the aisle", "name: " + 300 * "x",
         "that has 300 characters; give at most 100"),
        ("limit: 180", "limit: 180\n---\nname: b",
         "expected a single document in the stream, but found another document; correct it"),
        ("at: 30.5", "at: 30.5\n    duration: 2",
         "crate.yaml:12: faults[1].duration = 2: this fault is over at once; leave it out"),
        ("name: way_blocked, at: 8", "name: map_withheld, at: 8",
         "faults[0].at = 8: a map that was given cannot be withheld; give 0"),
        ("at: 30.5", "at: 180",
         "crate.yaml:11: faults[1].at = 180: the drive is over at 180 s (limit)"),
        ("start: {x: 1.2, y: 1.0}", "start: {x: 0.05, y: 1.0}",
         "crate.yaml:4: start = {\"x\": 0.05, \"y\": 1.0}: that is 0.05 m from something solid"),
        ("start: {x: 1.2, y: 1.0}", "start: {x: 99, y: 1.0}", "off the floor of the warehouse"),
        ("yaw: 1.57, tolerance: 0.2", "heading_tolerance: 0.2", "the goal asks for no heading"),
        ("{x: 1.2, y: 1.0, at: 90}", "{x: 1, y: 1, at: 90}\n  - {x: 1, y: 1, at: 9}",
         "crate.yaml:8: goals[2].at = 9: a goal before it in the list comes later (90 s)"),
        ("does: release", "does: push", 'operators[1].does = "push": that is not allowed; give'),
        ("seed: 3", "seed: 3.5", "seed = 3.5: that is no whole number"),
        ("seed: 3", "seed: 3\nseed: 4", "crate.yaml:4: 'seed' is given twice; keep one"),
        ("name: crate in the aisle", "name: 2026-01-01",
         'crate.yaml:1: name = "2026-01-01": that is a date; put it in quotation'),
        ("seed: 3", "seed: 2001-01-01", 'seed = "2001-01-01": that is a date'),
        ("name: crate in the aisle\n", "", "name: it is missing; add it"),
        ("by: ava}", 'by: "a\\tb"}',
         'operators[1].by = "a\\tb": no name to be printed in one line'),
        ("limit: 180", "limit: .inf", "limit"),
        ("seed: 3", "seed: [", "crate.yaml:5: expected"),
    ],
)  # fmt: skip
def test_what_cannot_be_carried_out_is_refused_with_its_place(
    tmp_path: Path, old: str, new: str, said: str
) -> None:
    file = tmp_path / "crate.yaml"
    assert old in GOOD
    file.write_text(GOOD.replace(old, new, 1))
    with pytest.raises(BadScenario) as refused:
        read_scenario(file)
    assert said in str(refused.value)
    assert str(refused.value).startswith(str(file))


def test_a_fault_that_is_on_is_not_begun_again(tmp_path: Path) -> None:
    twice = "- {name: way_blocked, at: 8, duration: 20}\n  - {name: way_blocked, at: 27.9}\n"
    with pytest.raises(BadScenario, match=r"faults\[1\].at = 27.9: way_blocked is on already then"):
        parse_scenario(GOOD.replace("- {name: way_blocked, at: 8, duration: 20}\n", twice))
    parse_scenario(
        GOOD.replace("- {name: way_blocked, at: 8, duration: 20}\n", twice.replace("27.9", "28"))
    )


def test_all_that_is_wrong_is_told_at_once() -> None:
    with pytest.raises(BadScenario) as refused:
        parse_scenario("name: x\nworld: mars\ngoals: []\nsped: 1\n", "a.yaml")
    assert [str(problem).partition(" ")[0] for problem in refused.value.problems] == [
        "a.yaml:2:", "a.yaml:3:", "a.yaml:4:",
    ]  # fmt: skip
    assert "goals: there are too few; give at least 1" in str(refused.value)


@pytest.mark.parametrize("text", ["", "3", "- a", "name", "{}: 3", "a: &a [*a]", "? [1]\n: 2"])
def test_no_text_is_anything_but_a_scenario_or_refused(text: str) -> None:
    with pytest.raises(BadScenario):
        parse_scenario(text)


@given(st.text(max_size=200))
def test_any_text_is_a_scenario_or_refused(text: str) -> None:
    with pytest.raises(BadScenario):
        parse_scenario(text)


def test_a_folder_gives_all_its_scenarios_by_their_files_names(tmp_path: Path) -> None:
    (tmp_path / "b.yaml").write_text(GOOD.replace("crate in the aisle", "first"))
    (tmp_path / "c.yml").write_text(GOOD.replace("crate in the aisle", "second"))
    (tmp_path / "notes.txt").write_text("none")
    assert [one.name for one in read_scenarios(tmp_path)] == ["first", "second"]
    assert [one.name for one in read_scenarios(tmp_path / "c.yml")] == ["second"]


def test_two_scenarios_of_one_name_are_refused_for_reports_pair_by_name(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(GOOD)
    (tmp_path / "b.yaml").write_text(GOOD)
    with pytest.raises(BadScenario, match=r"b\.yaml: name = .*a\.yaml has the same name"):
        read_scenarios(tmp_path)


def test_a_folder_without_scenarios_and_a_file_that_is_not_there_are_told(tmp_path: Path) -> None:
    with pytest.raises(BadScenario, match="no scenario in this folder"):
        read_scenarios(tmp_path)
    with pytest.raises(BadScenario, match="No such file"):
        read_scenarios(tmp_path / "x.yaml")
    (tmp_path / "latin.yaml").write_bytes(b"name: caf\xe9")
    with pytest.raises(BadScenario, match="not UTF-8"):
        read_scenarios(tmp_path)


def test_a_goal_may_be_published_and_its_topic_is_a_full_name() -> None:
    text = "name: a\nworld: hexagon\ngoals: [{x: -1.5, y: 0.5, topic: %s}]\n"
    assert parse_scenario(text % "/clicked_point").goals[0].topic == "/clicked_point"
    with pytest.raises(BadScenario, match=r'goals\[0\]\.topic = "clicked point": no full name'):
        parse_scenario(text % "clicked point")
