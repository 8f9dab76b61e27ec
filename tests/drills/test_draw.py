"""Drawn scenarios are the same everywhere, can be driven, and have faults that matter."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections import Counter

import numpy as np
import pytest

from kompass.algorithms.planning.planner import GlobalPlanner
from kompass.drills.draw import DrawOptions, check_targets, draw, expand_faults, fits, repeated
from kompass.drills.scenario_file import parse_scenario, scenario_text
from kompass.simulation.faults.fault_names import FAULTS, NEEDS_CAMERA, UnknownFault
from kompass.simulation.physics.robot_model import (
    TURTLEBOT3,
    robot_model,
    robot_names,
)
from kompass.simulation.worlds.rasterize import rasterize
from kompass.simulation.worlds.registry import world

NODES = ("planner", "controller", "mapper", "drive_manager")
ALL = DrawOptions(faults=expand_faults(["all"], NODES))
PROGRAM = f"""
from kompass.drills.draw import DrawOptions, draw, expand_faults
from kompass.drills.scenario_file import scenario_text
faults = expand_faults(["all"], {NODES})
options = DrawOptions(faults=faults, faults_per_drive=2, goals=2, lasting=0.3)
print("".join(scenario_text(draw(5, number, options)) for number in range(8)), end="")
"""


def drawn(hash_seed: str) -> str:
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, text=True, capture_output=True, check=True
    )
    return done.stdout


def test_another_process_with_another_hash_seed_draws_the_same() -> None:
    assert drawn("0") == drawn("4711")


def test_the_first_drive_of_a_seed_stays_the_one_it_is() -> None:
    """A report names drives by seed and number; a later release must mean the same ones."""
    options = DrawOptions(worlds=("warehouse",), faults=("way_blocked",))
    assert scenario_text(draw(7, 0, options)) == WRITTEN


WRITTEN = """\
name: 7-0
world: warehouse
robot: turtlebot3
seed: 1520939677
start:
  x: 10.075
  y: 3.625
  yaw: -1.006
goals:
- x: 0.775
  y: 2.525
  yaw: 0.616
  at: 2.0
faults:
- name: way_blocked
  at: 10.42
  duration: 16.57
operators: []
limit: 209.0
"""


@pytest.mark.parametrize("place", ["hexagon", "apartment", "warehouse", "depot"])
@pytest.mark.parametrize("robot", robot_names())
def test_every_embedded_robot_begins_and_ends_where_it_has_room(robot: str, place: str) -> None:
    options = DrawOptions(worlds=(place,), robot=robot)
    model, solid = robot_model(robot), world(place)
    for number in range(4):
        scenario = draw(11, number, options)  # refuses a start without room
        assert scenario.robot == robot
        (goal,) = scenario.goals
        around = np.linspace(0.0, math.tau, 36)
        reach = [model.outline((goal.x, goal.y, yaw)) for yaw in around]
        assert min(float(solid.distance(points).min()) for points in reach) >= 0.04


def test_few_drives_already_meet_every_world_and_every_fault_once() -> None:
    worlds = ("apartment", "warehouse", "hexagon")
    options = DrawOptions(worlds=worlds, faults=(*ALL.faults, "door_closed:kitchen"))
    count = len(options.faults)
    found = [draw(4, number, options) for number in range(count)]
    assert sorted(drive.faults[0].name for drive in found) == sorted(options.faults)
    for three in range(0, 18, 3):
        assert len({drive.world for drive in found[three : three + 3]}) >= 2
    assert {drive.world for drive in found[:9]} == set(worlds)
    plain = [draw(4, number, DrawOptions(worlds=worlds)).world for number in range(9)]
    assert [plain.count(name) for name in worlds] == [3, 3, 3]


def test_where_the_recipe_describes_a_larger_robot_places_are_drawn_for_that() -> None:
    large = DrawOptions(worlds=("apartment",), robot="omni", half_width=0.3, radius=0.5)
    for number in range(4):
        x, y, _ = draw(2, number, large).first_pose
        assert float(world("apartment").distance(np.array([[x, y]]))[0]) >= 0.5
    with pytest.raises(ValueError, match="no room for the robot omni, which needs"):
        draw(2, 0, large.model_copy(update={"radius": 3.0}))


def test_what_only_a_camera_sees_is_drawn_for_robots_that_have_one() -> None:
    seeing = expand_faults(["all"], NODES, "turtlebot3-plus")
    assert set(seeing) - set(expand_faults(["all"], NODES)) == set(NEEDS_CAMERA)
    with pytest.raises(UnknownFault, match="robot omni has no camera"):
        expand_faults(["low_box"], NODES, "omni")
    with pytest.raises(ValueError, match="turtlebot3 has no camera"):
        DrawOptions(faults=("low_box",))


@pytest.fixture(scope="module")
def planners() -> dict[str, GlobalPlanner]:
    return {
        name: GlobalPlanner(rasterize(world(name)), robot_radius=0.10, clearance=0.10)
        for name in ALL.worlds
    }


@pytest.mark.parametrize("number", range(len(ALL.faults) * 3))
def test_the_robot_can_get_to_every_goal_and_a_fault_begins_on_the_way(
    number: int, planners: dict[str, GlobalPlanner]
) -> None:
    options = ALL.model_copy(update={"goals": 2})
    scenario = draw(3, number, options)
    x, y, _ = scenario.first_pose
    assert float(world(scenario.world).distance(np.array([[x, y]]))[0]) >= 0.2
    begin = 2.0
    ways: list[tuple[float, float]] = []
    for goal in scenario.goals:
        plan = planners[scenario.world].plan((x, y, 0.0), (goal.x, goal.y, goal.yaw))
        assert plan.length >= 1.5
        ways.append((begin, begin + plan.length / TURTLEBOT3.usual_speed))
        begin, x, y = ways[-1][1], goal.x, goal.y
    for fault in scenario.faults:
        ends = fault.at + fault.duration
        if fault.name == "map_withheld":
            assert fault.at == 0.0
            assert ends > 2.0, "the map is still missing when the first plan is asked for"
        elif fault.name.startswith("wrong:"):
            assert fault.at < ways[0][0] < ends, "who answers once is asked while he is wrong"
        else:
            assert any(first < fault.at < last for first, last in ways)
        assert scenario.limit > ends + 30.0, "time is left to recover in"
    assert parse_scenario(scenario_text(scenario)) == scenario


def test_every_fault_and_every_world_comes_up_equally_often() -> None:
    number = len(ALL.faults) * len(ALL.worlds)
    found = [draw(1, index, ALL) for index in range(number)]
    faults = Counter(one.faults[0].name for one in found)
    assert faults == dict.fromkeys(ALL.faults, len(ALL.worlds))
    # The closing of a door takes place where it is.
    doors = [one.world for one in found if one.faults[0].name.startswith("door_closed:")]
    worlds = Counter(one.world for one in found)
    assert max(worlds.values()) - min(worlds.values()) <= len(doors) + len(worlds)


def test_as_many_drives_as_fit_a_world_have_each_fault_in_an_order_of_the_seed() -> None:
    options = DrawOptions(worlds=("hexagon",), faults=ALL.faults)
    fitting = [name for name in ALL.faults if fits(name, world("hexagon"))]
    assert len(fitting) < len(ALL.faults)

    def first(seed: int) -> list[str]:
        return [draw(seed, number, options).faults[0].name for number in range(len(fitting))]

    assert sorted(first(1)) == sorted(first(2)) == sorted(fitting)
    assert first(1) != first(2)
    assert first(1)[:20] != fitting[:20]


def test_numbers_and_seeds_draw_different_drives() -> None:
    found = [draw(seed, number, ALL) for seed in range(3) for number in range(20)]
    assert len({scenario_text(one) for one in found}) == 60
    assert len({one.seed for one in found}) == 60
    assert len({one.name for one in found}) == 60


def test_several_faults_of_a_drive_differ() -> None:
    options = ALL.model_copy(update={"faults_per_drive": 4})
    for number in range(20):
        names = [fault.name for fault in draw(2, number, options).faults]
        assert len(names) == len(set(names)) == 4


def test_lasting_faults_last() -> None:
    def forever(share: float) -> int:
        options = DrawOptions(faults=("way_blocked",), lasting=share)
        return sum(draw(1, n, options).faults[0].duration == 0.0 for n in range(40))

    assert forever(0.0) == 0
    assert 5 < forever(0.5) < 35
    assert forever(1.0) == 40


def test_drives_without_faults_can_be_drawn() -> None:
    assert draw(1, 0, DrawOptions()).faults == ()


def test_all_faults_are_written_out_for_each_process() -> None:
    everything = expand_faults(["all"], ["planner", "own"])
    plain = {name for name in FAULTS if ":" not in name} - set(NEEDS_CAMERA)
    assert plain <= set(everything)
    assert not set(NEEDS_CAMERA) & set(everything)  # the robot of drills has none
    assert {"kill:planner", "kill:own", "stop:planner", "stop:own"} <= set(everything)
    some = expand_faults(["kill", "kill:own", "way_blocked"], ["own"])
    assert some == ("kill:own", "way_blocked")
    with pytest.raises(UnknownFault, match="did you mean 'way_blocked'"):
        expand_faults(["way_bloked"], ())


def test_a_fault_of_a_process_that_the_recipe_does_not_have_is_refused() -> None:
    check_targets(["kill:planner", "hang:monitor", "scan_late:0.3"], ["planner", "monitor"])
    with pytest.raises(UnknownFault, match="no process or node 'plannr'; did you mean 'planner'"):
        check_targets(["wrong:plannr"], ["planner", "monitor"])


def test_what_cannot_be_drawn_is_refused() -> None:
    with pytest.raises(ValueError, match="world is 'mars'"):
        DrawOptions(worlds=("mars",))
    with pytest.raises(ValueError, match="there is no fault 'flood'"):
        DrawOptions(faults=("flood",))
    with pytest.raises(ValueError, match="number: -1; give 0 or more"):
        draw(1, -1, ALL)
    with pytest.raises(ValueError, match="give fewer goals"):
        draw(1, 0, DrawOptions(worlds=("depot",), goals=20))
    with pytest.raises(ValueError, match=r"no room for the robot turtlebot3, which needs 1.10 m"):
        draw(1, 0, DrawOptions(clearance=1.0))


def test_drives_of_two_scenarios_with_long_names_are_told_apart() -> None:
    beginning = (
        "yesterday evening in the hall behind the second gate, when both lights had failed and "
    )
    scenarios = [
        draw(1, 1, ALL).model_copy(update={"name": f"{beginning}it was {what}"})
        for what in ("raining", "snowing")
    ]
    names = [drive.name for each in scenarios for drive in repeated(each, 1, 3)]
    assert len(set(names)) == 6
    assert all(name.startswith(beginning[:81]) and len(name) <= 100 for name in names)
