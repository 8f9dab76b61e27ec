"""How the rules are doing, on ``~/rules_state``: on a change, and while anybody listens."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from builtin_interfaces.msg import Time
from kompass_interfaces.msg import RulesState
from rclpy.node import Node

from kompass.monitor.engine_loop import EngineLoop
from kompass.monitor.tables.types import InForce
from kompass.rclpy_ext.timers import Timers
from kompass.rclpy_ext.topic import LATCHED
from kompass.rulebook.schema.status import RuleStatus
from kompass.rulebook.views.views import Extras, rule_status

PERIOD = 0.25  # s between two looks while anybody listens
# After a change: whoever asked for it is to have the answer first, and several are told at once.
SOON = 0.05  # s
# Rules that are looked at in one go: the engine goes on between two of them.
SLICE = 20
PAUSE = 0.001  # s


class RulesStatePublisher:
    """Publishes the state of all rules, a slice at a time.

    Parameters
    ----------
    extras
        What the shell knows of a rule.
    in_force
        The table in force, and the seconds of probation that are left.
    """

    def __init__(
        self,
        node: Node,
        loop: EngineLoop,
        extras: Callable[[str], Extras],
        in_force: Callable[[], tuple[InForce, float]],
        stamp: Callable[[], Time],
        timers: Timers,
    ) -> None:
        self._loop, self._extras, self._in_force, self._stamp = loop, extras, in_force, stamp
        self._publisher = node.create_publisher(
            RulesState, f"{node.get_name()}/rules_state", LATCHED.to_ros()
        )
        self._made: list[str] = []
        self._revision = 0  # of the table whose rules are in `_made`
        self._again = False
        self._timers = timers
        self._busy = False
        timers.every(PERIOD, self._look)

    def changed(self) -> None:
        """Something that matters has changed: say so soon."""
        if self._busy:
            self._again = True
            return
        self._busy = True
        self._made, self._revision = [], self._loop.revision
        self._timers.after(SOON, self._go_on)

    def _look(self) -> None:
        if not self._busy and self._publisher.get_subscription_count():
            self.changed()

    def _go_on(self) -> None:
        loop = self._loop
        if self._revision != loop.revision:
            self._made, self._revision = [], loop.revision
        rules = loop.table.rules
        begin = len(self._made)
        now, offset = loop.now, loop.wall_offset
        for plan in rules[begin : begin + SLICE]:
            rule_id = plan.rule.id
            status = rule_status(
                loop.table, loop.state, rule_id, now, offset, extras=self._extras(rule_id)
            )
            self._made.append(status.model_dump_json())
        if len(self._made) < len(rules):
            self._timers.after(PAUSE, self._go_on)
            return
        self._busy = False
        self._publish()
        if self._again:
            self._again = False
            self.changed()

    def _publish(self) -> None:
        now, left = self._in_force()
        self._publisher.publish(
            RulesState(
                stamp=self._stamp(),
                revision=now.revision,
                confirmed=now.confirmed,
                probation_left=left,
                notice=now.notice,
                rules=f"[{','.join(self._made)}]",
            )
        )


def read_statuses(text: str) -> list[RuleStatus]:
    """The ``rules`` of a :class:`RulesState`, as models."""
    data: list[dict[str, Any]] = json.loads(text)
    return [RuleStatus.model_validate(item) for item in data]
