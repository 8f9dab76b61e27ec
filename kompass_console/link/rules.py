"""What the monitor publishes of the rules: how they are doing, what fires, which alarms stand."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from kompass_interfaces.msg import RuleFiring, RulesState
from pydantic import TypeAdapter
from rclpy.node import Node
from std_msgs.msg import String

from kompass.rulebook.schema.alarm import Alarm
from kompass_console.link.convert import seconds
from kompass_console.link.discovery import Graph, of_type
from kompass_console.link.reader import Reader
from kompass_console.schema.models import RulesInfo
from kompass_console.schema.rule_models import FiringStep
from kompass_console.schema.world import Latest

AVAILABLE_WITHIN = 2.0  # s; the monitor speaks at 4 Hz while anybody listens

_STEPS_KEPT = 200
_ALARMS = TypeAdapter(list[Alarm])


@dataclass(frozen=True, slots=True)
class Said:
    """One message of the monitor on the rules in force."""

    revision: int
    confirmed: int
    probation_left: float
    notice: str
    statuses: str  # JSON, list of RuleStatus

    @property
    def what_matters(self) -> tuple[object, ...]:
        """All that does not change from one moment to the next by itself."""
        return self.revision, self.confirmed, self.probation_left > 0.0, self.notice


class Rules:
    """The newest of each, and the last steps of firings.

    `changed` is called when the top bar has something new to say, `lively` with each message.
    Both on the link's thread.
    """

    def __init__(self, node: Node, changed: Callable[[], None], lively: Callable[[], None]) -> None:
        self._changed = changed
        self._lively = lively
        self._said: Latest[Said] = Latest()
        self._alarms: Latest[tuple[Alarm, ...]] = Latest()
        self._steps: deque[tuple[int, FiringStep]] = deque(maxlen=_STEPS_KEPT)
        self._count = 0
        self._state = Reader(node, RulesState, _said_of, self._store, latched=True)
        self._firings = Reader(node, RuleFiring, _step_of, self._stepped, latched=True, depth=100)
        self._raised = Reader(node, String, _alarms_of, self._store_alarms, latched=True)

    def refresh(self, published: Graph) -> None:
        """Listen to the monitor that is there now."""
        states = of_type(published, "kompass_interfaces/msg/RulesState")
        firings = of_type(published, "kompass_interfaces/msg/RuleFiring")
        self._state.follow(states[0] if states else None)
        self._firings.follow(firings[0] if firings else None)
        if states:
            alarms = f"{states[0].rpartition('/')[0]}/alarms"
            if "std_msgs/msg/String" in published.get(alarms, ()):
                self._raised.follow(alarms)

    def info(self) -> RulesInfo:
        """For the top bar."""
        said = self._said.get()
        if said is None:
            return RulesInfo(alarms=len(self.alarms()))
        age = said.age()
        return RulesInfo(
            available=age < AVAILABLE_WITHIN,
            revision=said.value.revision,
            confirmed=said.value.confirmed,
            probation_left=_left(said.value, age),
            notice=said.value.notice,
            alarms=len(self.alarms()),
            age=age,
        )

    def statuses(self) -> str:
        """How each rule is doing as last said: JSON, a list of RuleStatus as the monitor says."""
        said = self._said.get()
        return "[]" if said is None else said.value.statuses or "[]"

    def alarms(self) -> tuple[Alarm, ...]:
        """Those that stand."""
        newest = self._alarms.get()
        return () if newest is None else newest.value

    @property
    def count(self) -> int:
        """Number of steps heard so far."""
        return self._count

    def steps_since(self, count: int) -> list[FiringStep]:
        """Steps heard after the first `count`, oldest first; not more than are kept."""
        return [step for number, step in list(self._steps) if number > count]

    def _store(self, said: Said) -> None:
        before = self._said.get()
        self._said.set(said)
        if before is None or before.value.what_matters != said.what_matters:
            self._changed()
        self._lively()

    def _store_alarms(self, alarms: tuple[Alarm, ...]) -> None:
        self._alarms.set(alarms)
        self._changed()
        self._lively()

    def _stepped(self, step: FiringStep) -> None:
        self._steps.append((self._count + 1, step))
        self._count += 1
        self._lively()


def _left(said: Said, age: float) -> float:
    return max(0.0, said.probation_left - age)


def _said_of(message: Any) -> Said:
    return Said(
        revision=int(message.revision),
        confirmed=int(message.confirmed),
        probation_left=float(message.probation_left),
        notice=str(message.notice),
        statuses=str(message.rules),
    )


def _alarms_of(message: Any) -> tuple[Alarm, ...]:
    return tuple(_ALARMS.validate_json(message.data or "[]"))


def _step_of(message: Any) -> FiringStep:
    return FiringStep(
        time=seconds(message.stamp),
        rule_id=str(message.rule_id),
        rule_hash=str(message.revision),
        revision=int(message.table_revision),
        run_id=int(message.run_id),
        phase=str(message.phase),
        ok=bool(message.ok),
        text=str(message.text),
        details=json.loads(message.details or "null"),
    )
