"""What nobody may do to the rules of a running robot, whoever asks and however well it is meant."""

import json
from collections.abc import Iterator
from typing import Literal

from pydantic import JsonValue

from kompass.rulebook.diff import field_changes
from kompass.rulebook.permissions import FOREIGN, Permissions
from kompass.rulebook.schema.report import Finding
from kompass.rulebook.views.recipe_code import functions_of
from kompass.rules.engine.arbitrate import components_of
from kompass.rules.schema.actions import Lifecycle, Method
from kompass.rules.schema.conditions import CallableCondition, leaves
from kompass.rules.schema.table import Rule, Table, rule_hash

Role = Literal["viewer", "operator", "engineer"]
ROLES: tuple[Role, ...] = ("viewer", "operator", "engineer")


def guard(
    before: Table,
    after: Table,
    *,
    role: str,
    recipe_table: Table,
    permissions: Permissions,
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
        The table to come, its sources true.
    role
        Of who asks: ``viewer``, ``operator`` or ``engineer``.
    recipe_table
        The table that the recipe declares.
    permissions
        What rules may touch on this robot.
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
        found.extend(forbidden(rule, permissions))
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
    yield from _undone(after, recipe)
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


def _undone(after: Table, recipe: dict[str, Rule]) -> Iterator[Finding]:
    """Check that nobody starts again what a protected rule stops."""
    stopped = {
        component: rule
        for rule in after.rules
        if rule.protected
        for component in _asked(rule, ("stop",))
    }
    for rule in after.rules:
        own = recipe.get(rule.id)
        if rule.protected or (own is not None and rule_hash(own) == rule_hash(rule)):
            continue
        for component in stopped.keys() & set(_asked(rule, ("start", "restart", "configure"))):
            keeper = stopped[component]
            yield _error(
                rule,
                "undoes-protected",
                "actions",
                component,
                f"it would start {component}, which the protected rule "
                f"'{keeper.name or keeper.id}' stops",
                "leave it out: a person starts it again",
            )


def _asked(rule: Rule, words: tuple[str, ...]) -> Iterator[str]:
    """Walk the components of which a rule asks one of these."""
    for action in rule.actions:
        if not isinstance(action, Lifecycle | Method):
            continue
        word = action.action if isinstance(action, Lifecycle) else action.method
        if word in words:
            yield action.component


def _place(table: Table, rule_id: str) -> int:
    for place, rule in enumerate(table.rules):
        if rule.id == rule_id:
            return place
    return len(table.rules)


# -- actions --------------------------------------------------------------------------------------


def forbidden(rule: Rule, permissions: Permissions) -> Iterator[Finding]:
    """Walk what the actions of a rule may not touch, as errors."""
    for index, action in enumerate(rule.actions):
        for code, field, value, text, remedy in permissions.refusals(rule, action):
            where = f"actions[{index}].{field}" if field else f"actions[{index}]"
            yield _error(rule, code, where, value, text, remedy)


def _polled(rule: Rule, functions: set[str]) -> Iterator[Finding]:
    conditions = {"event.condition": rule.event.condition, "event.clear": rule.event.clear}
    for where, condition in conditions.items():
        for _, leaf in leaves(condition) if condition is not None else ():
            if isinstance(leaf, CallableCondition) and leaf.name not in functions:
                yield _error(rule, "foreign-function", where, leaf.name, *FOREIGN)
