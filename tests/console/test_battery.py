"""The battery as pages are told of it: where somebody tells, and called low with a hysteresis."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import pytest
from sensor_msgs.msg import BatteryState

from kompass_console.link.battery import charge_of
from kompass_console.schema.roles import Role
from tests.console.conftest import Served
from tests.console.test_link import State, listening, until
from tests.support.robot import Robot


def test_a_driver_that_measures_no_charge_or_nonsense_is_left_out() -> None:
    assert charge_of(BatteryState(percentage=0.5, voltage=math.nan))[::2] == (0.5, None)
    assert charge_of(BatteryState(percentage=64.0)).share == pytest.approx(0.64)
    for wrong in (math.nan, math.inf, -0.1, 101.0):
        with pytest.raises(ValueError, match="percentage"):
            charge_of(BatteryState(percentage=wrong))


@pytest.fixture
def robot(domain: int) -> Iterator[Robot]:
    robot = Robot(domain)
    yield robot
    robot.close()


def has_charge(share: float, state: State) -> bool:
    return state["battery"] is not None and abs(state["battery"]["charge"] - share) < 1e-3


@pytest.mark.ros
def test_pages_are_told_of_the_battery_and_when_it_is_low(console: Served, robot: Robot) -> None:
    publisher = robot.node.create_publisher(BatteryState, "/power", 10)

    def tells(share: float, charging: bool = False) -> None:
        status = (
            BatteryState.POWER_SUPPLY_STATUS_CHARGING
            if charging
            else BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
        )
        publisher.publish(BatteryState(percentage=share, power_supply_status=status))

    with console.client(Role.VIEWER) as client, listening(console, client) as socket:
        assert until(socket, lambda state: True)["battery"] is None
        robot.wait_until(lambda: publisher.get_subscription_count() > 0, 10, "the console")
        for share, low in ((0.5, False), (0.19, True), (0.22, True), (0.26, False), (0.22, False)):
            tells(share)
            said = until(socket, partial(has_charge, share))
            assert said["battery"]["low"] == low, share
        tells(0.3, charging=True)
        until(socket, lambda state: state["battery"]["charging"])
