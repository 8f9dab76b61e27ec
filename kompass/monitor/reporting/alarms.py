"""The alarms that rules have raised, on a latched topic."""

from __future__ import annotations

import json

from std_msgs.msg import String

from kompass.bus.node import Node
from kompass.rclpy_ext.topic import LATCHED
from kompass.rulebook.schema.alarm import Alarm

TOPIC = "alarms"


class Alarms:
    """Keeps the alarms in force, and tells them on ``<node>/alarms`` as a JSON list."""

    def __init__(self, node: Node) -> None:
        self._clock = node.clock
        self._alarms: dict[str, Alarm] = {}
        self._publisher = node.create_publisher(
            String, f"{node.get_name()}/{TOPIC}", LATCHED.to_ros()
        )
        self._publish()

    def raise_alarm(self, name: str, text: str, rule_id: str, severity: str) -> None:
        """Show an alarm until it is cleared; raised again, it counts up and keeps its beginning."""
        known = self._alarms.get(name)
        self._alarms[name] = Alarm(
            name=name,
            text=text,
            rule_id=rule_id,
            severity=severity,
            since=known.since if known else self._clock.wall(),
            count=known.count + 1 if known else 1,
        )
        self._publish()

    def clear(self, name: str) -> bool:
        """Take an alarm back; return whether there was one."""
        found = self._alarms.pop(name, None) is not None
        if found:
            self._publish()
        return found

    def _publish(self) -> None:
        data = [alarm.model_dump(mode="json") for alarm in self._alarms.values()]
        self._publisher.publish(String(data=json.dumps(data)))
