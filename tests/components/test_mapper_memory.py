"""The local map remembers what is hidden, and lets go of what is seen gone or lies elsewhere."""

import math
from collections.abc import Callable
from typing import Any

import pytest
from nav_msgs.msg import OccupancyGrid

from kompass.algorithms.grid import FREE, OCCUPIED, UNKNOWN
from kompass.components import LocalMapper, LocalMapperConfig, MapConfig
from kompass.components.base.convert import grid_of
from kompass.control import ScanModelConfig
from tests.components.alive import Alive
from tests.components.toy_robot import ToyRobot

Run = Callable[..., Alive]
FAR, NEAR = (1.0, 0.0, 0.1), (0.4, 0.0, 0.2)
HIDDEN = (0.91, 0.0)  # the side of the far one that was seen


class Hall:
    """A robot that maps posts around it."""

    def __init__(self, run: Run, **config: Any) -> None:
        self.alive = run(LocalMapper(config=LocalMapperConfig(**config)))
        self.robot = ToyRobot(self.alive, [FAR])
        self.maps = self.alive.hear(OccupancyGrid, "/local_map/occupancy_layer")

    def at(self, x: float, y: float) -> int:
        """What the newest map says of a place in the world."""
        grid = grid_of(self.maps[-1])
        ((col, row),) = grid.world_to_cell([[x, y]])
        return int(grid.cells[row, col])

    def comes_to(self, what: int, *place: float) -> None:
        self.alive.wait_until(lambda: self.maps and self.at(*place) == what, 10, "the map of it")


def hide(hall: Hall) -> None:
    hall.comes_to(OCCUPIED, *HIDDEN)
    hall.robot.posts = [NEAR, FAR]
    hall.comes_to(OCCUPIED, 0.21, 0.0)


def test_each_map_is_of_one_scan_unless_told_otherwise(run: Run) -> None:
    hall = Hall(run)
    hide(hall)
    hall.comes_to(UNKNOWN, *HIDDEN)


def test_what_hides_behind_another_is_remembered_and_cleared_when_it_is_seen_gone(run: Run) -> None:
    hall = Hall(run, map_params=MapConfig(bayesian_update=True))
    hide(hall)
    hall.alive.rest(1.0)
    assert hall.at(*HIDDEN) == OCCUPIED
    hall.robot.posts = []
    hall.comes_to(FREE, *HIDDEN)


def test_what_is_believed_at_once_is_what_is_seen_now(run: Run) -> None:
    careful = ScanModelConfig(p_prior=0.5, p_occupied=0.55, p_empty=0.1)
    hall = Hall(run, map_params=MapConfig(bayesian_update=True), scan_model=careful)
    hall.robot.posts = []
    hall.comes_to(FREE, *HIDDEN)
    hall.alive.rest(1.0)
    hall.robot.posts = [FAR]
    hall.comes_to(OCCUPIED, *HIDDEN)
    hall.robot.posts = [NEAR, FAR]
    hall.comes_to(FREE, *HIDDEN)  # of one glance nothing stays


def test_who_is_put_elsewhere_takes_nothing_along(run: Run) -> None:
    hall = Hall(run, map_params=MapConfig(bayesian_update=True))
    hide(hall)
    step = 0.55
    hall.robot.posts = [(NEAR[0] - step, *NEAR[1:])]  # hides the same again
    hall.robot.x -= step
    hall.alive.wait_until(lambda: hall.maps[-1].info.origin.position.x < -2.0, 10, "the jump")
    hall.comes_to(UNKNOWN, *HIDDEN)


def test_the_older_name_is_read_too() -> None:
    assert MapConfig(baysian_update=True).bayesian_update  # type: ignore[call-arg]


def test_probabilities_out_of_order_are_refused_with_their_names() -> None:
    with pytest.raises(ValueError, match=r"p_empty = 0\.7, p_prior = 0\.6"):
        ScanModelConfig(p_empty=0.7)
    config = LocalMapperConfig()
    with pytest.raises(ValueError, match=r"p_occupied = 0\.5"):
        config.scan_model.p_occupied = 0.5
    assert math.isclose(config.scan_model.p_occupied, 0.9)
