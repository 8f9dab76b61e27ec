"""What nobody may do to the rules of a running robot, whoever asks and however well it is meant."""

import json
from collections.abc import Collection, Iterator
from typing import Literal

from pydantic import JsonValue

from kompass.rulebook.diff import field_changes
from kompass.rulebook.schema.report import Finding
from kompass.rulebook.views.recipe_code import functions_of
from kompass.rulebook.views.wording import describe_action
from kompass.rules.checks.catalog import Catalog, StackCatalog
from kompass.rules.engine.arbitrate import components_of
from kompass.rules.schema.actions import (
    Action,
    CallService,
    Lifecycle,
    Method,
    Publish,
    Python,
    Reconfigure,
    UpdateParameters,
    component_of,
)
from kompass.rules.schema.conditions import CallableCondition, leaves
from kompass.rules.schema.model import topic_key
from kompass.rules.schema.table import Rule, Table, rule_hash

Role = Literal["viewer", "operator", "engineer"]
ROLES: tuple[Role, ...] = ("viewer", "operator", "engineer")
RELEASE = "release_stop"
RELEASE_TYPE = "kompass_interfaces/srv/ReleaseStop"
# The wheels are reached through the drive manager's gate and by no other way.
MOTION_TYPES = ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")
# Parameters of the gate that decide whether it stops for what is in the way.
SAFETY_PARAMETERS = frozenset(
    {
        "disable_safety_stop",
        "use_without_scan_sensor",
        "critical_zone_distance",
        "slowdown_zone_distance",
        "scan_timeout",
        "odometry_timeout",
        "command_timeout",
    }
)
DRIVE_MANAGERS = ("drive_manager",)


def gates_of(catalog: Catalog) -> frozenset[str]:
    """Return the components that stand before the wheels, whatever they are called.

    Known by their parameters; without a catalog of the stack, by their usual name.
    """
    known = catalog.components() if isinstance(catalog, StackCatalog) else {}
    found = {name for name, spec in known.items() if "disable_safety_stop" in spec.parameters}
    return frozenset({*DRIVE_MANAGERS, *found})


def guard(
    before: Table,
    after: Table,
    *,
    role: str,
    recipe_table: Table,
    drive_managers: Collection[str] = DRIVE_MANAGERS,
) -> list[Finding]:
    """Return the guard rails that a change of the table runs into, as errors; empty if none.

    Rules that the recipe itself holds, unchanged in what they do, pass always: going back to the
    recipe is never refused for what the recipe says. Rules that were there before are looked at
    again, so that no revision of the past can bring back what is forbidden.

    Parameters
    ----------
    before
        The table in force.
    after
        The table to come.
    role
        Of who asks: ``viewer``, ``operator`` or ``engineer``.
    recipe_table
        The table that the recipe declares.
    drive_managers
        Node names of the components that stand before the wheels (:func:`gates_of`).
    """
    if role not in ("operator", "engineer"):
        changed = before != after
        return [_viewer(role)] if changed else []
    recipe = {rule.id: rule for rule in recipe_table.rules}
    found = list(_protection(before, after, role, recipe))
    functions = functions_of(recipe_table)
    for rule in after.rules:
        own = recipe.get(rule.id)
        if own is not None and rule_hash(own) == rule_hash(rule):
            continue
        for index, action in enumerate(rule.actions):
            where = f"actions[{index}]"
            found.extend(_action(rule, where, action, own, functions, drive_managers))
        found.extend(_polled(rule, functions))
    return found


def _viewer(role: str) -> Finding:
    who = "a viewer" if role == "viewer" else f"the role {role!r}"
    return Finding(
        level="error",
        code="role",
        rule_id="",
        field="role",
        value=role,
        text=f"{who} may look at rules and change nothing",
        remedy="sign in as operator or engineer",
    )


def _error(rule: Rule, code: str, field: str, value: JsonValue, text: str, remedy: str) -> Finding:
    return Finding(
        level="error",
        code=code,
        rule_id=rule.id,
        field=field,
        value=value,
        text=text,
        remedy=remedy,
    )


# -- protected rules ------------------------------------------------------------------------------


def _protection(
    before: Table, after: Table, role: str, recipe: dict[str, Rule]
) -> Iterator[Finding]:
    """Check that protected rules keep what they do, their place, and their protection."""
    now = {rule.id: (place, rule) for place, rule in enumerate(after.rules)}
    was = {rule.id: rule for rule in before.rules}
    # What the recipe protects is protected even if the table in force has lost it.
    known = {**was, **{r.id: r for r in recipe.values() if r.protected and r.id not in was}}
    for rule in known.values():
        from_recipe = rule.id in recipe and recipe[rule.id].protected
        if not (rule.protected or from_recipe):
            continue
        if rule.id not in now:
            if rule.id in was:
                yield _removed(rule, from_recipe)
            continue
        place, new = now[rule.id]
        free = not from_recipe and role == "engineer" and not new.protected
        if free:
            continue  # an engineer has taken the protection off first
        yield from _kept(recipe[rule.id] if from_recipe else rule, rule, new, from_recipe)
        yield from _outranked(before, after, place, new)
    for rule in after.rules:
        yield from _flag(rule, was.get(rule.id), recipe.get(rule.id), role)


_UNPROTECT = ", or let an engineer take the protection off first"


def _text(value: JsonValue) -> str:
    return "what it was" if isinstance(value, (dict, list)) else json.dumps(value)


def _removed(rule: Rule, from_recipe: bool) -> Finding:
    return _error(
        rule,
        "protected",
        "protected",
        True,
        f"'{rule.name or rule.id}' is protected and cannot be removed",
        "keep the rule" + ("" if from_recipe else _UNPROTECT),
    )


def _kept(recipe: Rule, rule: Rule, new: Rule, from_recipe: bool) -> Iterator[Finding]:
    original = recipe if from_recipe and rule_hash(new) == rule_hash(recipe) else rule
    if rule_hash(original) == rule_hash(new):
        return
    for change in field_changes(original, new):
        if change.field in ("name", "note", "protected"):
            continue
        verb = {
            "enabled": "cannot be switched off or on",
            "shadow": "cannot be put into shadow or out of it",
        }.get(change.field, "cannot be changed")
        yield _error(
            new,
            "protected",
            change.field,
            change.after,
            f"'{new.name or new.id}' is protected and {verb}",
            f"leave it at {_text(change.before)}" + ("" if from_recipe else _UNPROTECT),
        )


def _flag(rule: Rule, was: Rule | None, recipe: Rule | None, role: str) -> Iterator[Finding]:
    """Check that the protection itself is set and cleared only where it may be."""
    wanted = recipe.protected if recipe is not None else None
    had = was.protected if was is not None else False
    if wanted is not None:
        if rule.protected != wanted and rule.protected != had:
            yield _error(
                rule,
                "protected-flag",
                "protected",
                rule.protected,
                "whether a rule of the recipe is protected is for the recipe to say",
                f"leave it at {wanted}",
            )
        elif wanted and not rule.protected:
            yield _error(
                rule,
                "protected-flag",
                "protected",
                False,
                "the recipe protects this rule",
                "set it to true",
            )
    elif rule.protected != had and role != "engineer":
        yield _error(
            rule,
            "protected-flag",
            "protected",
            rule.protected,
            "only an engineer may protect a rule, or take the protection off",
            f"leave it at {had}",
        )


def _outranked(before: Table, after: Table, place: int, rule: Rule) -> Iterator[Finding]:
    """Check that no rule was put in front of a protected one that wants the same component."""
    wanted = components_of(rule.actions)
    ahead = {r.id for r in before.rules[: _place(before, rule.id)]}
    old = {r.id: r for r in before.rules}
    for other in after.rules[:place]:
        shared = wanted & components_of(other.actions)
        if not shared or other.protected or other.id in ahead or other.severity != rule.severity:
            continue
        yield _error(
            other,
            "outranks-protected",
            "",
            other.id,
            f"it was put in front of the protected rule '{rule.name or rule.id}', "
            f"which acts on {min(shared)} too",
            "put it behind the protected rule",
        )
    for other in after.rules:
        if other.id == rule.id or other.protected or other.severity <= rule.severity:
            continue
        shared = wanted & components_of(other.actions)
        was = old.get(other.id)
        had = was is not None and was.severity > rule.severity
        if not shared or (had and was is not None and components_of(was.actions) & wanted):
            continue
        yield _error(
            other,
            "outranks-protected",
            "severity",
            other.severity.name.lower(),
            f"it would take {min(shared)} away from the protected rule '{rule.name or rule.id}'",
            f"set the severity to {rule.severity.name.lower()} or lower",
        )


def _place(table: Table, rule_id: str) -> int:
    for place, rule in enumerate(table.rules):
        if rule.id == rule_id:
            return place
    return len(table.rules)


# -- actions --------------------------------------------------------------------------------------


def _polled(rule: Rule, functions: set[str]) -> Iterator[Finding]:
    conditions = {"event.condition": rule.event.condition, "event.clear": rule.event.clear}
    for where, condition in conditions.items():
        for _, leaf in leaves(condition) if condition is not None else ():
            if isinstance(leaf, CallableCondition) and leaf.name not in functions:
                yield _error(rule, "foreign-function", where, leaf.name, *_FOREIGN)


_FOREIGN = (
    "only functions that rules of the recipe use can be called",
    "choose one of those, or let the recipe use it",
)


def _action(
    rule: Rule,
    where: str,
    action: Action,
    own: Rule | None,
    functions: set[str],
    drive_managers: Collection[str],
) -> Iterator[Finding]:
    if own is not None and _normalized(action) in map(_normalized, own.actions):
        return  # the recipe itself lets this rule do it
    if _releases(action):
        yield _error(
            rule,
            "resumes-after-stop",
            where,
            describe_action(action),
            "it would let the robot move again after STOP",
            "leave it out: a person releases the STOP",
        )
    if isinstance(action, Publish) and action.type in MOTION_TYPES:
        yield _error(
            rule,
            "bypasses-gate",
            f"{where}.type",
            action.type,
            f"velocities on /{action.topic} would reach the wheels past the drive manager's gate",
            "send a goal, or call a method of the drive manager",
        )
    if isinstance(action, Python) and action.name not in functions:
        yield _error(rule, "foreign-function", f"{where}.name", action.name, *_FOREIGN)
    if component_of(action) in drive_managers:
        yield from _gatekeeper(rule, where, action)
    elif isinstance(action, CallService) and not _releases(action):
        yield from _service(rule, where, action, drive_managers)


def _normalized(action: Action) -> Action:
    """Return an action without its timeout and what follows a failure, for comparison."""
    return action.model_copy(update={"timeout": None, "on_error": "abort"})


def _releases(action: Action) -> bool:
    if isinstance(action, CallService):
        return action.type == RELEASE_TYPE or topic_key(action.service).endswith(RELEASE)
    return isinstance(action, Method) and action.method.endswith(RELEASE)


def _gatekeeper(rule: Rule, where: str, action: Action) -> Iterator[Finding]:
    """Check what is done to the component before the wheels."""
    remedy = "only the recipe may do that"
    if isinstance(action, Lifecycle) and action.action in ("stop", "configure"):
        text = f"{action.component} is the gate before the wheels and keeps running"
        yield _error(rule, "opens-gate", f"{where}.action", action.action, text, remedy)
    elif isinstance(action, Method) and action.method in ("stop", "reconfigure"):
        text = f"{action.component} is the gate before the wheels and keeps running"
        yield _error(rule, "opens-gate", f"{where}.method", action.method, text, remedy)
    elif isinstance(action, Reconfigure):
        text = f"a new configuration of {action.component} could switch its safety off"
        yield _error(rule, "opens-gate", f"{where}.config", None, text, remedy)
    elif isinstance(action, UpdateParameters):
        for name, value in action.parameters.items():
            if name.split(".")[0] in SAFETY_PARAMETERS:
                text = f"{name} of {action.component} decides when the robot stops"
                yield _error(rule, "opens-gate", f"{where}.parameters.{name}", value, text, remedy)
    elif isinstance(action, Method) and action.method in _SETTERS:
        text = f"what it sets of {action.component} could decide when the robot stops"
        remedy = "choose the action that changes parameters, so that it can be checked"
        yield _error(rule, "opens-gate", f"{where}.method", action.method, text, remedy)


def _service(
    rule: Rule, where: str, action: CallService, drive_managers: Collection[str]
) -> Iterator[Finding]:
    """Check that the same is not done through the services of that component."""
    *owner, name = topic_key(action.service).split("/")
    if owner and owner[-1] in drive_managers and name not in _HARMLESS:
        text = f"/{action.service} belongs to the gate before the wheels"
        remedy = "choose the action of that kind instead, so that it can be checked"
        yield _error(rule, "opens-gate", f"{where}.service", action.service, text, remedy)


# Methods that do what there is an action for, past the checks of that action.
_SETTERS = frozenset({"set_param", "set_params", "update_parameter", "update_parameters"})
# Services of the gate that only ever stop the robot, or only ask.
_HARMLESS = frozenset({"stop", "get_state", "get_parameters", "list_parameters"})
