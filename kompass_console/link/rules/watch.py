"""What the monitor publishes of the rules: how they are doing, what fires, which alarms stand."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from kompass.monitor.client import MonitorClient, TableState
from kompass.rulebook.schema.alarm import Alarm
from kompass.rulebook.schema.journal import FiringStep
from kompass_console.schema.models import RulesInfo
from kompass_console.schema.plain import LONGEST_LABEL, plain, plain_json
from kompass_console.schema.world import Latest

AVAILABLE_WITHIN = 2.0  # s; the monitor speaks at 4 Hz while anybody listens

_STEPS_KEPT = 200
_MOST_ALARMS = 200  # at once; more nobody reads


class RulesWatch:
    """The newest of each, and the last steps of firings.

    Parameters
    ----------
    changed
        Called when the top bar has something new to show; on the link's thread.
    heard
        Called with each message; on the link's thread.
    """

    def __init__(self, changed: Callable[[], None], heard: Callable[[], None]) -> None:
        self._changed = changed
        self._heard = heard
        self._said: Latest[TableState] = Latest()
        self._alarms: Latest[tuple[Alarm, ...]] = Latest()
        self._steps: deque[tuple[int, FiringStep]] = deque(maxlen=_STEPS_KEPT)
        self._count = 0

    def follow(self, monitor: MonitorClient) -> None:
        """Listen to the monitor that is there now; what another said last stays until then."""
        monitor.watch_state(self._store)
        monitor.watch_firings(self._stepped)
        monitor.watch_alarms(self._store_alarms)

    def info(self) -> RulesInfo:
        """For the top bar."""
        said = self._said.get()
        if said is None:
            return RulesInfo(alarms=self._shown_alarms())
        age = said.age()
        return RulesInfo(
            available=age < AVAILABLE_WITHIN,
            revision=said.value.revision,
            confirmed=said.value.confirmed,
            probation_left=_left(said.value, age),
            notice=plain(said.value.notice),
            alarms=self._shown_alarms(),
            age=age,
        )

    def statuses(self) -> str:
        """How each rule is doing as last said: JSON, a list of RuleStatus as the monitor says."""
        said = self._said.get()
        return "[]" if said is None else said.value.statuses.text

    def alarms(self) -> tuple[Alarm, ...]:
        """Those that stand."""
        newest = self._alarms.get()
        return () if newest is None else newest.value

    def _shown_alarms(self) -> int:
        """Number of those that nobody has put away."""
        now = time.time()
        return sum(alarm.shelved_until <= now for alarm in self.alarms())

    @property
    def count(self) -> int:
        """Number of steps heard so far."""
        return self._count

    def steps_since(self, count: int) -> list[FiringStep]:
        """Steps heard after the first `count`, oldest first; not more than are kept."""
        return [step for number, step in list(self._steps) if number > count]

    def _store(self, said: TableState) -> None:
        before = self._said.get()
        self._said.set(said)
        if before is None or _what_matters(before.value) != _what_matters(said):
            self._changed()
        self._heard()

    def _store_alarms(self, alarms: tuple[Alarm, ...]) -> None:
        self._alarms.set(tuple(_plain_alarm(alarm) for alarm in alarms[:_MOST_ALARMS]))
        self._changed()
        self._heard()

    def _stepped(self, step: FiringStep) -> None:
        self._steps.append((self._count + 1, _plain_step(step)))
        self._count += 1
        self._heard()


def _plain_alarm(alarm: Alarm) -> Alarm:
    return alarm.model_copy(
        update={
            "name": plain(alarm.name, LONGEST_LABEL),
            "text": plain(alarm.text),
            "rule_id": plain(alarm.rule_id, LONGEST_LABEL),
            "severity": plain(alarm.severity, LONGEST_LABEL),
            "acknowledged_by": plain(alarm.acknowledged_by, LONGEST_LABEL),
            "shelved_by": plain(alarm.shelved_by, LONGEST_LABEL),
        }
    )


def _plain_step(step: FiringStep) -> FiringStep:
    return step.model_copy(
        update={
            "rule_id": plain(step.rule_id, LONGEST_LABEL),
            "phase": plain(step.phase, LONGEST_LABEL),
            "text": plain(step.text),
            "details": plain_json(step.details),
        }
    )


def _left(said: TableState, age: float) -> float:
    return max(0.0, said.probation_left - age)


def _what_matters(said: TableState) -> tuple[object, ...]:
    """All that does not change from one moment to the next by itself."""
    return said.revision, said.confirmed, said.probation_left > 0.0, said.notice
