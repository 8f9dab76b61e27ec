"""The embedded robot's battery empties with time and way, and fills where the robot began."""

from __future__ import annotations

from kompass.simulation.battery import Battery


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
    assert 10.5 < drives.voltage < stands.voltage < 12.6


def test_it_fills_where_it_began_while_the_robot_stands_and_is_never_too_full_or_empty() -> None:
    battery = Battery((0.0, 0.0))
    driven(battery, 5000.0, 20_000.0)
    assert battery.charge == 0.0
    for _ in range(4000):
        battery.step((0.0, 0.0), 1.0)
    assert battery.charging
    assert battery.charge == 1.0
