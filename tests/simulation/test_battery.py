"""The embedded robot's battery empties with time and way, and fills where the robot began."""

from __future__ import annotations

from kompass.simulation.battery import Battery, voltage
from kompass.simulation.faults.robot_faults import RobotFaults
from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.registry import world


def driven(battery: Battery, metres: float, seconds: float) -> None:
    for second in range(1, int(seconds) + 1):
        battery.step((1.0 + metres * second / seconds, 0.0), 1.0)


def test_who_drives_needs_more_than_who_stands() -> None:
    stands, drives = Battery((0.0, 0.0)), Battery((0.0, 0.0))
    for battery, metres in ((stands, 0.0), (drives, 120.0)):
        driven(battery, metres, 600.0)
        assert not battery.charging
    assert drives.charge < stands.charge < 0.8
    assert stands.charge > 0.7
    assert 10.5 < voltage(drives.charge) < voltage(stands.charge) < 12.6


def test_it_fills_where_it_began_while_the_robot_stands_and_is_never_too_full_or_empty() -> None:
    battery = Battery((0.0, 0.0))
    driven(battery, 5000.0, 20_000.0)
    assert battery.charge == 0.0
    for _ in range(4000):
        battery.step((0.0, 0.0), 1.0)
    assert battery.charging
    assert battery.charge == 1.0


def test_a_fault_leaves_it_little_and_gives_it_back() -> None:
    robot = SimulatedRobot(world("hexagon"))
    faults = RobotFaults(robot)
    before = robot.battery.charge
    faults.begin("battery_low")
    assert robot.battery.charge == 0.12
    robot.battery.step(robot.world.start[:2], 60.0)
    assert (robot.battery.charge, robot.battery.charging) == (0.12, False)
    faults.end("battery_low")
    assert robot.battery.charging
    assert robot.battery.charge > before
