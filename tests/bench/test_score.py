"""Drives are worth what BARN says, and gaps are those of the body."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from kompass.bench.barn_file import BadWorlds, read_barn
from kompass.bench.score import arrival, least_gap, score, time_limit
from kompass.simulation.physics.robot_model import JACKAL, TURTLEBOT3
from tests.bench.worlds import world_file


@pytest.mark.parametrize(
    ("time", "worth"),
    # 10 m at 2 m/s are 5 s at best.
    [(5.0, 0.5), (10.0, 0.5), (20.0, 0.25), (40.0, 0.125), (90.0, 0.125), (None, 0.0)],
)
def test_a_drive_is_worth_its_optimal_time_over_what_it_took(
    time: float | None, worth: float
) -> None:
    assert score(10.0, 2.0, time) == pytest.approx(worth)


def test_a_slower_robot_may_take_longer() -> None:
    assert time_limit(2.0) == 100.0
    assert time_limit(0.2) == pytest.approx(1000.0)


def test_time_counts_from_setting_out_until_near_the_goal() -> None:
    poses = np.array([[0, 0], [0, 0], [0.05, 0], [0.2, 0], [3.5, 0], [4.1, 0], [5.0, 0]])
    assert arrival([0, 1, 2, 3, 4, 5, 6], poses, (5.0, 0.0)) == 2.0
    assert arrival([0, 1, 2, 3, 4, 5, 6], poses, (9.0, 0.0)) is None
    assert arrival([], np.empty((0, 3)), (9.0, 0.0)) is None


def test_the_gap_of_a_round_body_and_of_a_box_is_to_its_nearest_side() -> None:
    posts = np.array([[0.0, 1.0, 0.075]])
    way = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    gap, at = least_gap(TURTLEBOT3, way, posts)
    assert gap == pytest.approx(1.0 - 0.075 - 0.10, abs=1e-3)
    assert at == pytest.approx((0.0, 0.0), abs=0.02)
    assert least_gap(JACKAL, way, posts)[0] == pytest.approx(1.0 - 0.075 - 0.215, abs=1e-3)
    turned = np.array([[0.0, 0.0, math.pi / 2], [0.0, 0.1, math.pi / 2]])
    assert least_gap(JACKAL, turned, posts)[0] == pytest.approx(0.9 - 0.075 - 0.254, abs=1e-3)


def test_a_file_of_worlds_is_read_as_it_is(tmp_path: Path) -> None:
    file = read_barn(world_file(tmp_path))
    assert [world.name for world in file.worlds] == ["barn_1", "barn_4"]
    place = file.worlds[0].place(file.start, file.goal)
    assert len(place.obstacles) == 7
    assert place.on_floor(np.array([file.goal])).all()
    assert not file.worlds[0].place(file.start, file.goal, obstacles=False).obstacles


def test_two_worlds_of_one_number_and_text_that_is_no_json_are_refused(tmp_path: Path) -> None:
    file = world_file(tmp_path)
    whole = json.loads(file.read_text(encoding="utf-8"))
    whole["worlds"][1]["index"] = 1
    file.write_text(json.dumps(whole), encoding="utf-8")
    with pytest.raises(BadWorlds, match="two worlds have the index 1; give each its own"):
        read_barn(file)
    file.write_text("{worlds", encoding="utf-8")
    with pytest.raises(BadWorlds, match=r"worlds.json:1: it is no JSON"):
        read_barn(file)
