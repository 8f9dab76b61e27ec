"""Where the robot was, or is, when something was measured."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from kompass.components import DriveManager
from kompass.components.base.location_source import LONGEST_STEP, LocationSource
from tests.components.alive import Alive
from tests.components.test_by_hand import Scene

SPEED = 0.2  # m/s


@pytest.mark.parametrize(
    ("age", "moved"),
    [(0.1, 0.1 * SPEED), (0.28, 0.28 * SPEED), (-0.1, -0.1 * SPEED), (LONGEST_STEP + 0.1, 0.0)],
    ids=["quick scanner", "scanner of 4 Hz", "newer than the place", "too old to tell"],
)
def test_the_robot_has_moved_by_its_speed_since_something_was_measured(
    run: Callable[..., Alive], age: float, moved: float
) -> None:
    scene = Scene(run(DriveManager()))
    scene.driven()
    alive = scene.alive
    alive.rest(1.0)  # of the toy's time, until it has its speed
    source = LocationSource(alive.component)
    stamp = alive.component.input("location").message.header.stamp
    measured = stamp.sec + 1e-9 * stamp.nanosec - age
    assert source.moved_since(measured) == pytest.approx((moved, 0.0, 0.0), abs=0.002)
    source.close()
