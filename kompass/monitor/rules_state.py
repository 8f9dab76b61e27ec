"""How the rules are doing, on ``~/rules_state``: on a change, and while anybody listens."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future

from builtin_interfaces.msg import Time
from kompass_interfaces.msg import RulesState

from kompass.bus.node import Node
from kompass.monitor.engine_loop import EngineLoop
from kompass.monitor.tables.active_table import ActiveTable
from kompass.rclpy_ext.timers import Timers
from kompass.rclpy_ext.topic import LATCHED
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
    node
        Publishes.
    loop
        The engine.
    extras
        Returns what is known of a rule outside the engine.
    active
        The table in force.
    stamp
        The time of now, for messages.
    timers
        On the executor's thread.
    """

    def __init__(
        self,
        node: Node,
        loop: EngineLoop,
        extras: Callable[[str], Extras],
        active: ActiveTable,
        stamp: Callable[[], Time],
        timers: Timers,
    ) -> None:
        self._loop, self._extras, self._active, self._stamp = loop, extras, active, stamp
        self._publisher = node.create_publisher(
            RulesState, f"{node.get_name()}/rules_state", LATCHED.to_ros()
        )
        self._made: list[str] = []
        self._revision = 0  # of the table whose rules are in `_made`
        self._again = False
        self._timers = timers
        self._busy = False
        self._wanted: list[Future[str]] = []  # by who asked for the states of now
        timers.every(PERIOD, self._look)

    def changed(self) -> None:
        """Publish soon, because something that matters has changed."""
        if self._busy:
            self._again = True
            return
        self._busy = True
        self._made, self._revision = [], self._loop.revision
        self._timers.after(SOON, self._go_on)

    def told_next(self, future: Future[str]) -> None:
        """Give a future the states (a JSON list) as soon as they are made anew, beginning now."""
        self._wanted.append(future)
        if self._busy:
            self._again = True
            return
        self._busy = True
        self._made, self._revision = [], self._loop.revision
        self._go_on()

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
        for compiled in rules[begin : begin + SLICE]:
            rule_id = compiled.rule.id
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
        now = self._active.in_force
        rules = f"[{','.join(self._made)}]"
        for future in self._wanted:
            future.set_result(rules)
        self._wanted = []
        self._publisher.publish(
            RulesState(
                stamp=self._stamp(),
                revision=now.revision,
                confirmed=now.confirmed,
                probation_left=self._active.probation_left,
                notice=now.notice,
                rules=rules,
            )
        )
