"""Rules, actions and times as a person would say them."""

import json
from collections.abc import Iterable, Mapping

from pydantic import JsonValue

from kompass.rules.schema.actions import (
    Action,
    CallService,
    CancelGoal,
    ClearAlarm,
    Lifecycle,
    Log,
    Method,
    Publish,
    RaiseAlarm,
    Reconfigure,
    SendGoal,
    StartMission,
    UpdateParameters,
)
from kompass.rules.schema.arguments import is_reference, meant
from kompass.rules.schema.describe import describe
from kompass.rules.schema.events import Event
from kompass.rules.schema.table import Rule

_LONG = 60  # characters of an argument, beyond which it is cut


def describe_action(action: Action) -> str:
    """Return one line for an action: ``drive_manager: move to unblock``."""
    if isinstance(action, Log):
        return f'log "{action.text}"'
    if isinstance(action, Method):
        arguments = f" ({_listed(action.kwargs)})" if action.kwargs else ""
        return f"{action.component}: {action.method.replace('_', ' ')}{arguments}"
    if isinstance(action, Lifecycle):
        return f"{action.action} {action.component}"
    if isinstance(action, Reconfigure):
        how = f"from {action.config}" if isinstance(action.config, str) else _listed(action.config)
        return f"reconfigure {action.component}: {how}"
    if isinstance(action, UpdateParameters):
        return "set " + ", ".join(
            f"{action.component}.{name} = {_value(value)}"
            for name, value in action.parameters.items()
        )
    if isinstance(action, Publish):
        return f"publish on /{action.topic}{_repeated(action)}"
    if isinstance(action, CallService):
        return f"call /{action.service}"
    if isinstance(action, SendGoal):
        return f"send goal to /{action.action}"
    if isinstance(action, CancelGoal):
        return f"cancel goals of /{action.action}"
    if isinstance(action, RaiseAlarm):
        return f'raise alarm "{action.alarm}"'
    if isinstance(action, ClearAlarm):
        return f'clear alarm "{action.alarm}"'
    if isinstance(action, StartMission):
        return f'start mission "{action.mission}"'
    return f"run {action.name} of the recipe"


def describe_actions(actions: Iterable[Action]) -> str:
    """Return a list of actions in one line."""
    return ", then ".join(map(describe_action, actions))


def describe_rule(rule: Rule) -> str:
    """Return a rule in one sentence: ``when … for 2 s, then …``."""
    return f"when {describe_event(rule.event)}, then {describe_actions(rule.actions)}"


def describe_event(event: Event) -> str:
    """Return the condition with how long it must hold."""
    held = f" for {seconds(event.hold)}" if event.hold else ""
    return f"{describe(event.condition)}{held}"


def seconds(duration: float) -> str:
    """Return a duration as text: ``0.25 s``, ``41 s``, ``3 min 20 s``, ``2 h 5 min``."""
    duration = max(duration, 0.0)
    if duration < 9.95:
        return f"{duration:.2g} s"
    whole = round(duration)
    if whole < 120:
        return f"{whole} s"
    if whole < 7200:
        minutes, rest = divmod(whole, 60)
        return f"{minutes} min {rest} s" if rest else f"{minutes} min"
    hours, rest = divmod(whole // 60, 60)
    return f"{hours} h {rest} min" if rest else f"{hours} h"


def _repeated(action: Publish) -> str:
    if action.rate is None:
        return ""
    period = "" if action.period is None else f" for {seconds(action.period)}"
    return f" at {action.rate:g} Hz{period}"


def _listed(arguments: Mapping[str, JsonValue]) -> str:
    return ", ".join(f"{name} = {_value(value)}" for name, value in arguments.items())


def _value(value: JsonValue) -> str:
    if is_reference(value):
        return str(value)
    text = json.dumps(meant(value), ensure_ascii=False)
    return text if len(text) <= _LONG else text[: _LONG - 1] + "…"
