"""What a mission does at its places: what a rule of whoever wrote the mission could do."""

from __future__ import annotations

from kompass.missions.mission import Act, Editor, Halt, MissionPlan
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.tables.recipe_check import faults_of
from kompass.rulebook.permissions import Permissions
from kompass.rules.engine.firing import NO_RUN, Firing
from kompass.rules.schema.actions import Action, CallService, arguments_of
from kompass.rules.schema.arguments import references
from kompass.rules.schema.conditions import Absent
from kompass.rules.schema.events import Event
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Severity, Source

# A rule has an event; this one is looked at by nobody.
_NEVER = Event(
    condition=Absent(
        signal=Signal(topic="drive_state", type="kompass_interfaces/msg/DriveState"),
        seconds=1.0,
    )
)


class UnfitAction(ValueError):
    """An action that a mission cannot do, or may not; the message says why."""


def check_actions(
    plan: MissionPlan, role: Editor, catalog: RecipeCatalog, permissions: Permissions
) -> None:
    """Look at all actions of a mission.

    Raises
    ------
    UnfitAction
        Naming waypoint and task, both from 1, what is wrong with it, and the remedy.
    """
    for number, waypoint in enumerate(plan.waypoints, 1):
        for count, task in enumerate(waypoint.tasks, 1):
            if isinstance(task, Act) and (why := _fault(task.action, role, catalog, permissions)):
                raise UnfitAction(f"place {number}, task {count}: {why}")


def firing_of(plan: MissionPlan, role: Editor, task: Act | Halt, gate: str, at: float) -> Firing:
    """A task, as the runner of actions takes it.

    Parameters
    ----------
    role
        Whose rights it has.
    gate
        Node name of the drive manager, for STOP.
    at
        Monotonic time [s].
    """
    stop = CallService(
        service=f"{gate}/stop",
        type="kompass_interfaces/srv/StopRobot",
        request={"operator_name": f"mission {plan.name}", "reason": "as the mission says"},
    )
    action = stop if isinstance(task, Halt) else task.action
    rule = _rule(plan.name, action, role)
    return Firing(
        rule_id=rule.id,
        run_id=NO_RUN,
        at=at,
        triggered_at=at,
        revision_hash="",
        topic=None,
        message=None,
        messages={},
        leaves=(),
        actions=rule.actions,
        lane="normal",
        severity=Severity.WARNING,
        rule=rule,
    )


def _rule(name: str, action: Action, role: Editor) -> Rule:
    source: Source = "engineer" if role == "engineer" else "edited"
    return Rule(id="mission", name=name, event=_NEVER, actions=(action,), source=source)


def _fault(action: Action, role: Editor, catalog: RecipeCatalog, permissions: Permissions) -> str:
    if list(references(arguments_of(action))):
        return (
            "it takes a value from a message, and at a place there is none; give the value itself"
        )
    rule = _rule("", action, role)
    for finding in faults_of(rule, catalog):
        if finding.level == "error":
            return f"{finding.text}; {finding.remedy}"
    refusal = permissions.refusal(rule, action)
    return "" if refusal is None else f"{refusal.text}; {refusal.remedy}"
