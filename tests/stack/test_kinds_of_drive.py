"""A car and a robot on omni wheels get where they are sent, by motions that their wheels can do."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import numpy as np
import pytest
from geometry_msgs.msg import TwistStamped

from kompass.bench.stack import described
from kompass.launch.virtual_stack import Embedded
from kompass.simulation.physics.robot_model import ACKERMANN, OMNI, RobotModel
from tests.support.hand import Hand
from tests.support.virtual_robot import VirtualRobot
from tests.support.virtual_time import node_in

FOLLOWED = Path(__file__).parents[2] / "benchmarks" / "recipes" / "followed.py"
SUCCEEDED = 4
RADIUS = described(ACKERMANN).turning_radius
# Where a car has room to turn, in three of the apartment's rooms; the heading of some is asked for.
GOALS = ((2.7, 5.5, None), (3.0, 1.5, 0.0), (7.0, 3.6, 3.0))


class Driven(VirtualRobot):
    """Notes all that the wheels are told."""

    def __init__(self, kind: RobotModel, follower: str = "MPPI", place: str = "apartment") -> None:
        self.told: list[tuple[float, float, float]] = []
        super().__init__(
            FOLLOWED, place=place, embedded=Embedded(kind), FOLLOWER=follower, ROBOT=kind.name
        )
        # The tester's own node hears the same topic as the other type.
        self._listener = node_in(self.world, "listener")
        self._listener.create_subscription(TwistStamped, "/cmd_vel", self._on_command, 10)

    def _on_command(self, message: TwistStamped) -> None:
        twist = message.twist
        self.told.append((twist.linear.x, twist.linear.y, twist.angular.z))


@contextmanager
def driven(kind: RobotModel, follower: str = "MPPI", place: str = "apartment") -> Iterator[Driven]:
    with closing(Driven(kind, follower, place)) as robot:
        robot.ready()
        yield robot


def outside_of_a_car(told: list[tuple[float, float, float]]) -> list[tuple[float, float, float]]:
    """Commands that steered wheels cannot carry out."""
    return [
        (vx, vy, omega)
        for vx, vy, omega in told
        if vy or abs(omega) * RADIUS > abs(vx) * 1.001 + 1e-6
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("follower", "goals"), [("MPPI", 2), ("PurePursuit", 1), ("Stanley", 1), ("DVZ", 1)]
)
def test_a_car_arrives_and_is_never_told_what_its_wheels_cannot_do(
    follower: str, goals: int
) -> None:
    with driven(ACKERMANN, follower) as robot:
        for x, y, yaw in GOALS[:goals]:
            ended = robot.result(robot.send_goal(x, y, yaw), timeout=120)
            assert ended.status == SUCCEEDED, ended.result.message
            assert robot.distance_to(x, y) < 0.10
            if yaw is not None:
                assert abs(math.remainder(robot.truth[2] - yaw, math.tau)) < 0.2
        assert robot.contacts == 0
        assert np.abs(robot.told).max() > 0.1
        assert outside_of_a_car(robot.told) == []


@pytest.mark.slow
def test_an_omni_arrives_and_goes_sideways_where_that_is_nearer() -> None:
    with driven(OMNI) as robot:
        for x, y, yaw in GOALS:
            ended = robot.result(robot.send_goal(x, y, yaw), timeout=120)
            assert ended.status == SUCCEEDED, ended.result.message
            assert robot.distance_to(x, y) < 0.10
        assert robot.contacts == 0
        assert max(abs(vy) for _, vy, _ in robot.told) > 0.02
        limits = described(OMNI)
        assert max(abs(vy) for _, vy, _ in robot.told) <= limits.ctrl_vy_limits.max_vel + 1e-6
        assert max(math.hypot(vx, vy) for vx, vy, _ in robot.told) <= 1.0 + 1e-6


def test_a_goal_with_a_heading_beside_a_car_takes_it_ahead_and_back() -> None:
    with driven(ACKERMANN, "PurePursuit") as robot:
        x, y, yaw = robot.truth
        ended = robot.result(robot.send_goal(x + 0.2, y + 0.15, yaw), timeout=60)
        assert ended.status == SUCCEEDED, ended.result.message
        assert robot.distance_to(x + 0.2, y + 0.15) < 0.10
        assert (
            min(vx for vx, _, _ in robot.told) < -0.05 < 0.05 < max(vx for vx, _, _ in robot.told)
        )
        assert outside_of_a_car(robot.told) == []
        assert robot.contacts == 0


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 5])
def test_whoever_drives_a_car_by_hand_and_in_curves_touches_nothing(seed: int) -> None:
    chance = random.Random(seed)
    with driven(ACKERMANN) as robot:
        ava = Hand(robot, "ava")
        ava.take()
        robot.rest(0.5)  # whoever takes the wheel has let go at first
        end = robot.clock.monotonic() + 15.0
        while robot.clock.monotonic() < end:
            ahead = chance.random() < 0.75
            ava.vx = chance.uniform(0.5, 1.0) if ahead else -chance.uniform(0.3, 1.0)
            ava.omega = chance.uniform(-1.7, 1.7)
            robot.rest(chance.uniform(0.25, 1.25))
        driven_far = sum(abs(vx) for vx, _, _ in robot.told)
        assert driven_far > 10.0, "it hardly moved"
        assert robot.contacts == 0
