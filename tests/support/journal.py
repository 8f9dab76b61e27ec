"""What rules did, as anybody can read it on the monitor's topic."""

from typing import Any, NamedTuple

from kompass.monitor.client import MonitorClient
from kompass.rulebook.schema.journal import FiringStep
from tests.support.tester import Tester


class Step(NamedTuple):
    """One message of ``/monitor/firings``."""

    at: float  # when it was received [s, monotonic]
    stamp: float  # when it was published [s, system]
    rule: str
    run: int
    phase: str
    ok: bool
    text: str
    details: Any


class Journal:
    """Collects firings from when it is made; a rule is meant by a part of its id."""

    def __init__(self, robot: Tester) -> None:
        self.steps: list[Step] = []
        self._robot = robot
        MonitorClient(robot.node, "/monitor").watch_firings(self._note)
        robot.wait_until(
            lambda: robot.node.count_publishers("/monitor/firings") > 0, 10, "the monitor's firings"
        )

    def _note(self, told: FiringStep) -> None:
        step = Step(
            self._robot.clock.monotonic(),
            told.time,
            told.rule_id,
            told.run_id,
            told.phase,
            told.ok,
            told.text,
            told.details or {},
        )
        self.steps.append(step)

    def of(self, rule: str, phase: str, since: int = 0) -> list[Step]:
        """Steps of one phase of the rules whose id holds ``rule``."""
        return [step for step in self.steps[since:] if rule in step.rule and step.phase == phase]

    @property
    def mark(self) -> int:
        """For ``since``: what comes from now on."""
        return len(self.steps)

    def done(self, rule: str, since: int = 0, timeout: float = 10.0) -> Step:
        """Wait for the end of a run of a rule."""
        self._robot.wait_until(
            lambda: self.of(rule, "done", since), timeout, f"the end of a run of '{rule}'"
        )
        return self.of(rule, "done", since)[0]

    def actions(self, step: Step) -> list[Step]:
        """The actions of a run, in the order in which they ended."""
        return [
            one
            for one in self.steps
            if (one.rule, one.run, one.phase) == (step.rule, step.run, "action")
        ]
