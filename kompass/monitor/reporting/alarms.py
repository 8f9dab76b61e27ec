"""The alarms that rules have raised, on a latched topic."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable
from typing import get_args

from std_msgs.msg import String

from kompass.bus.node import Node
from kompass.rclpy_ext.timers import Timers
from kompass.rclpy_ext.topic import LATCHED
from kompass.rulebook.schema.alarm import Alarm
from kompass.store.errors import ChangeRefused
from kompass.store.timeline_store import Shelf
from kompass.timeline.entry import Level
from kompass.timeline.happening import Began, Happened, Happening, Over

TOPIC = "alarms"
LOOK = 1.0  # s between looks for shelves whose time is over


class Alarms:
    """Keeps the alarms in force, and tells them on ``<node>/alarms`` as a JSON list.

    Parameters
    ----------
    node, timers
        Publishes, and lets shelves end.
    tell
        Takes what happens to alarms.
    """

    def __init__(self, node: Node, timers: Timers, tell: Callable[[Happening], None]) -> None:
        self._clock, self._tell = node.clock, tell
        self._alarms: dict[str, Alarm] = {}
        self._shelves: dict[str, Shelf] = {}
        self._publisher = node.create_publisher(
            String, f"{node.get_name()}/{TOPIC}", LATCHED.to_ros()
        )
        self._publish()
        timers.every(LOOK, self._end_shelves)

    def raise_alarm(
        self, name: str, text: str, rule_id: str, severity: str, *, until_seen: bool = False
    ) -> None:
        """Show an alarm until it is cleared; raised again, it counts up and keeps its beginning.

        Whoever has acknowledged it has seen it as bad as it was then, and not worse. One of no rule
        stands until then only (``until_seen``): nobody would clear it.
        """
        now, known = self._clock.wall(), self._alarms.get(name)
        shelf = self._shelves.get(name)
        as_bad = known is not None and known.severity == severity
        self._alarms[name] = Alarm(
            name=name,
            text=text,
            rule_id=rule_id,
            severity=severity,
            since=known.since if known else now,
            count=known.count + 1 if known else 1,
            until_seen=until_seen,
            acknowledged_by=known.acknowledged_by if known and as_bad else "",
            shelved_until=shelf.until if shelf else 0.0,
            shelved_by=shelf.author if shelf else "",
        )
        self._publish()
        self._tell(Began(now, "alarm", f"alarm {name}", name, text, level_of(severity), rule_id))

    def clear(self, name: str) -> bool:
        """Take an alarm back; return whether there was one."""
        found = self._alarms.pop(name, None) is not None
        if found:
            self._publish()
            self._tell(Over(self._clock.wall(), f"alarm {name}"))
        return found

    def end_those_of(self, rules: Collection[str]) -> None:
        """Take back what was raised by rules that are in force no more: nobody would clear it."""
        for name in [name for name, alarm in self._alarms.items() if alarm.rule_id in rules]:
            self.clear(name)
            title = f"Ended with its rule: {name}"
            self._tell(Happened(self._clock.wall(), "alarm", title))

    # -- what people do -----------------------------------------------------------------------

    def acknowledge(self, name: str, since: float, by: str) -> None:
        """Somebody has seen the alarm that stands since then.

        Raises
        ------
        ChangeRefused
            When it stands no more.
        """
        known = self._alarms.get(name)
        if known is None or known.since != since:
            raise ChangeRefused(f"the alarm {name!r} stands no more; look at those that do")
        self._alarms[name] = known.model_copy(update={"acknowledged_by": by})
        self._publish()
        self._tell(Happened(self._clock.wall(), "alarm", f"Acknowledged: {name}", who=by))
        if known.until_seen:
            self.clear(name)

    def shelve(self, shelf: Shelf) -> None:
        """Put an alarm away until a time, whether it stands or comes; one that is over ends it."""
        now = self._clock.wall()
        if shelf.until > now:
            self._shelves[shelf.alarm] = shelf
            title = f"Shelved: {shelf.alarm}"
        else:
            self._shelves.pop(shelf.alarm, None)
            title = f"Shown again: {shelf.alarm}"
        self._fit()
        self._tell(Happened(now, "alarm", title, who=shelf.author))

    def restore(self, shelves: Iterable[Shelf]) -> None:
        """What was put away before this start."""
        self._shelves = {shelf.alarm: shelf for shelf in shelves} | self._shelves
        self._fit()

    def _end_shelves(self) -> None:
        now = self._clock.wall()
        over = [name for name, shelf in self._shelves.items() if shelf.until <= now]
        for name in over:
            del self._shelves[name]
        if over:
            self._fit()

    def _fit(self) -> None:
        """Have each alarm say whether it is put away."""
        for name, alarm in self._alarms.items():
            shelf = self._shelves.get(name)
            self._alarms[name] = alarm.model_copy(
                update={
                    "shelved_until": shelf.until if shelf else 0.0,
                    "shelved_by": shelf.author if shelf else "",
                }
            )
        self._publish()

    def _publish(self) -> None:
        data = [alarm.model_dump(mode="json") for alarm in self._alarms.values()]
        self._publisher.publish(String(data=json.dumps(data)))


_LEVELS: dict[str, Level] = {level: level for level in get_args(Level)}


def level_of(severity: str) -> Level:
    """How bad a severity of a rule is on the timeline."""
    return _LEVELS.get(severity, "warning")
