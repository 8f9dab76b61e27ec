"""What is told of the robot: found between two of its states. Pure.

These are the notices of the page (web/src/notify), but those that are for one person alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

from kompass_console.schema.models import ComponentInfo, ProcessInfo, State

Kind = Literal["stop", "fault", "goal", "mission", "alarm", "probation", "battery"]
KINDS: tuple[Kind, ...] = get_args(Kind)
HOLD = 1.0  # s for which something must fail before it is told of

_LOST = {
    "dead": "died",
    "stuck": "hangs",
    "given up": "died too often and is not started again",
}
_MISSION = {
    "asking": ("waits for a person", True),
    "paused": ("paused", True),
    "failed": ("failed", True),
    "done": ("done", False),
}


@dataclass(frozen=True, slots=True)
class Notice:
    """Something that whoever is responsible for the robot should hear of.

    `urgent` says that somebody has to do something, `body` what.
    """

    kind: Kind
    title: str
    body: str = ""
    urgent: bool = True


class NoticeFinder:
    """Looks at one state after the other. What was so in the first is no news."""

    def __init__(self) -> None:
        self._before: State | None = None
        self._failing: dict[str, float] = {}  # since when
        self._told: set[str] = set()

    def look(self, now: State) -> list[Notice]:
        """What has happened since the state before."""
        before, self._before = self._before, now
        faults = _faults(now)
        if before is None:
            self._told = set(faults)
            return []
        return [
            *_stopped(before, now),
            *self._faults(faults, now.time),
            *_goal(before, now),
            *_mission(before, now),
            *_rules(before, now),
            *_battery(before, now),
        ]

    def _faults(self, faults: Mapping[str, str], now: float) -> list[Notice]:
        """What has failed for long enough, once; all that failed together in one notice."""
        self._told &= faults.keys()
        self._failing = {
            name: self._failing.get(name, now) for name in faults if name not in self._told
        }
        if not any(now - since >= HOLD for since in self._failing.values()):
            return []
        first, *others = self._failing
        self._told |= self._failing.keys()
        also = f"Also: {'; '.join(faults[name] for name in others)}." if others else ""
        return [Notice("fault", faults[first], also or "Look at its health.")]


def _faults(state: State) -> dict[str, str]:
    """What is wrong by name, in words; what others may wait for comes first."""
    processes: dict[str, ProcessInfo] = {each.name: each for each in state.processes}
    labels: dict[str, list[str]] = {}
    for component in state.components:
        if component.process is not None:
            processes[component.process.name] = component.process
            labels.setdefault(component.process.name, []).append(component.label)
    found = {}
    for process in processes.values():
        if (word := _LOST.get(process.state)) is not None:
            name = ", ".join(labels.get(process.name, [process.name]))
            why = f" ({process.reason})" if process.reason else ""
            found[f"process {process.name}"] = f"{name} {word}{why}"
    lost = {each.removeprefix("process ") for each in found}
    ill = [
        each
        for each in state.components
        if each.status.endswith("_failure")
        and (each.process is None or each.process.name not in lost)
    ]
    for component in sorted(ill, key=lambda each: bool(each.src_components)):
        found[component.name] = _fails(component)
    return found


def _fails(component: ComponentInfo) -> str:
    if component.message:
        return f"{component.label}: {component.message}"
    return f"{component.label} fails"


def _stopped(before: State, now: State) -> list[Notice]:
    is_, was = now.drive, before.drive
    if was is None or was.stopped or is_ is None or not is_.stopped:
        return []
    by = f" by {is_.stopped_by}" if is_.stopped_by else ""
    why = f": {is_.reason}" if is_.reason else ""
    body = "It stays where it is until a person releases STOP."
    return [Notice("stop", f"Stopped{by}{why}", body)]


def _goal(before: State, now: State) -> list[Notice]:
    goal, run = now.goal, now.missions.run
    if goal is None or goal.phase != "failed":
        return []
    if before.goal is not None and (before.goal.id, before.goal.phase) == (goal.id, "failed"):
        return []
    if run is not None and run.phase not in ("canceled", "done", "failed"):
        return []  # told with the mission
    return [Notice("goal", f"Goal given up: {goal.message}" if goal.message else "Goal given up")]


def _mission(before: State, now: State) -> list[Notice]:
    found = []
    run, was = now.missions.run, before.missions.run
    if run is not None and run.phase in _MISSION:
        same = was is not None and (was.number, was.step) == (run.number, run.step)
        if not same:
            word, urgent = _MISSION[run.phase]
            body = run.ask if run.phase == "asking" else run.reason
            found.append(Notice("mission", f"{run.name}: {word}", body, urgent))
    notice = now.missions.notice
    if notice and notice != before.missions.notice:
        found.append(Notice("mission", "A mission did not begin", notice))
    return found


def _rules(before: State, now: State) -> list[Notice]:
    was, is_ = before.rules, now.rules
    if not (was.available and is_.available):
        return []
    found = []
    if is_.alarms > was.alarms:
        many = "A rule has raised an alarm" if is_.alarms == 1 else f"{is_.alarms} alarms stand"
        found.append(Notice("alarm", many, "Look at what it says on the page."))
    if was.probation_left > 0.0 >= is_.probation_left:
        if is_.revision == was.revision:
            title = f"Probation of revision {is_.revision} has ended"
            found.append(Notice("probation", title, is_.notice, urgent=False))
        else:
            title = f"Rules went back: revision {is_.revision} is in force"
            found.append(Notice("probation", title, is_.notice))
    return found


def _battery(before: State, now: State) -> list[Notice]:
    is_, was = now.battery, before.battery
    if is_ is None or not is_.low or is_.charging or was is None or was.low:
        return []
    title = f"Battery low: {int(100 * is_.charge)} %"
    return [Notice("battery", title, "Send it home, or charge it.")]
