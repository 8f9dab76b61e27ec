"""Two rules whose holds and cooldowns are watched while others are edited."""

from __future__ import annotations

from itertools import pairwise

from std_msgs.msg import Bool

from kompass.drills.facts import Fact, ProcessEnded, ProcessStarted, RuleFired
from kompass.drills.runner.observer import Observer
from kompass.drills.scenario import Scenario
from kompass.rules.schema.table import Rule
from kompass.virtual.node import VirtualNode

HELD, BEAT = "probe-held", "probe-beat"
HOLD, COOLDOWN = 1.5, 0.8  # s
PERIOD = 0.05  # s between two messages
ON, OFF = 2.2, 0.4  # s for which the probe is true, and false
LATE = 0.35  # s that a firing may be late, by the network


def probe_rules() -> tuple[Rule, ...]:
    """One that fires once each time when it was true for long, one after each cooldown."""
    signal = {"topic": "probe", "type": "std_msgs/msg/Bool", "path": ["data"]}
    is_on = {"kind": "compare", "signal": signal, "operator": "==", "value": True}
    heard = {"kind": "received", "signal": {**signal, "path": []}}
    log = [{"kind": "log", "text": "!"}]
    return (
        Rule.model_validate(
            {
                "id": HELD,
                "event": {"condition": is_on, "trigger": "edge", "hold": HOLD},
                "actions": log,
            }
        ),
        Rule.model_validate(
            {"id": BEAT, "event": {"condition": heard, "cooldown": COOLDOWN}, "actions": log}
        ),
    )


class Probes:
    """Says what they listen to, and looks at when they fire."""

    def __init__(self, node: VirtualNode, observer: Observer) -> None:
        self._observer = observer
        self._publisher = node.create_publisher(Bool, "probe", 10)
        self._count = 0
        self._rises: list[float] = []
        self._was_on = False
        node.create_timer(PERIOD, self._say)

    def _say(self) -> None:
        if not self._observer.has_begun:
            return
        is_on = self._observer.now % (ON + OFF) < ON
        if is_on and not self._was_on:
            self._rises.append(self._observer.now)
        self._was_on = is_on
        self._publisher.publish(Bool(data=is_on))

    def findings(self, facts: list[Fact], scenario: Scenario) -> list[str]:
        """Where a hold or a cooldown was not kept, by a monitor that lived and was not held."""
        found: list[str] = []
        away = [fault.at for fault in scenario.faults if fault.name.endswith(":monitor")]
        away += [
            fact.at
            for fact in facts
            if isinstance(fact, (ProcessEnded, ProcessStarted)) and fact.process == "monitor"
        ]
        first = min(away, default=scenario.limit)
        beats = [f for f in facts if isinstance(f, RuleFired) and f.rule_id == BEAT]
        for one, other in pairwise(beats):
            gap = other.at - one.at
            if one.epoch == other.epoch and gap < COOLDOWN - 0.05 and other.at < first:
                found.append(f"{BEAT} fired {gap:.2f} s after it had at {one.at:g} s")
            if other.at < first and gap > COOLDOWN + PERIOD + LATE:
                found.append(f"{BEAT} had a pause of {gap:.2f} s from {one.at:g} s on")
        held = [f.at for f in facts if isinstance(f, RuleFired) and f.rule_id == HELD]
        for rise in self._rises:
            due = rise + HOLD
            if due + LATE >= min(first, scenario.limit):
                continue
            got = [at for at in held if rise <= at < rise + ON + OFF]
            if len(got) != 1 or not -0.05 <= got[0] - due <= LATE:
                found.append(
                    f"{HELD} was true from {rise:.2f} s on, and fired at {got} instead of {due:.2f}"
                )
        return found
