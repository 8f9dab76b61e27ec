"""The robot's battery, where somebody tells of it (sensor_msgs/BatteryState, REP 147)."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from rclpy.node import Node
from sensor_msgs.msg import BatteryState

from kompass_console.link.graph.discovery import Graph, of_type
from kompass_console.link.graph.reader import Reader
from kompass_console.schema.models import BatteryInfo
from kompass_console.schema.world import Latest

LOW, WELL = 0.2, 0.25  # charge from which on it is called low, and no more
_USUAL = "/battery_state"
_FORGET_AFTER = 120.0  # s


class _Charge(NamedTuple):
    share: float
    charging: bool
    voltage: float | None


class Battery:
    """Reads the one battery of the robot: on the usual topic, else on the first of its type.

    Parameters
    ----------
    changed
        Called when there is something new to show; on the link's thread.
    """

    def __init__(self, node: Node, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._newest: Latest[_Charge] = Latest()
        self._low = False
        self._reader = Reader(node, BatteryState, charge_of, self._store)

    def refresh(self, published: Graph) -> None:
        """Read from the topic that is there now."""
        names = of_type(published, "sensor_msgs/msg/BatteryState")
        topic = _USUAL if _USUAL in names else next(iter(names), None)
        if self._reader.follow(topic):
            self._newest.clear()

    def info(self) -> BatteryInfo | None:
        """What pages show; None where nobody tells, or has not for long."""
        stamped = self._newest.get()
        if stamped is None or stamped.age() > _FORGET_AFTER:
            return None
        charge = stamped.value
        return BatteryInfo(
            charge=round(charge.share, 4),
            charging=charge.charging,
            low=self._low,
            voltage=charge.voltage,
            topic=self._reader.topic or "",
            age=stamped.age(),
        )

    def _store(self, charge: _Charge) -> None:
        before = self._newest.get()
        self._low = charge.share < (WELL if self._low else LOW)
        self._newest.set(charge)
        if before is None or _shown(before.value) != _shown(charge):
            self._changed()


def charge_of(message: Any) -> _Charge:
    """A message as data.

    Raises
    ------
    ValueError
        It tells no charge: not a number is what drivers say that measure none.
    """
    share = float(message.percentage)
    if not math.isfinite(share):
        raise ValueError("percentage is not told")
    # It is to be from 0 to 1; some drivers say percent.
    share = share / 100.0 if share > 1.0 else share
    if not 0.0 <= share <= 1.0:
        raise ValueError(f"percentage = {message.percentage:g}; a charge is from 0 to 1")
    voltage = float(message.voltage)
    status = int(message.power_supply_status)
    return _Charge(
        share,
        status == BatteryState.POWER_SUPPLY_STATUS_CHARGING,
        round(voltage, 2) if math.isfinite(voltage) and voltage > 0.0 else None,
    )


def _shown(charge: _Charge) -> tuple[int, bool]:
    return round(100.0 * charge.share), charge.charging
