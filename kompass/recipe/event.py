"""Events of a recipe: the expression form of today, and the named classes of older recipes."""

from __future__ import annotations

import difflib
import math
import re
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, Self

from pydantic import ValidationError

from kompass.expressions import MessageField, condition_of, signal_of
from kompass.invalid import first_invalid
from kompass.named_arguments import named_arguments
from kompass.rclpy_ext.topic import Topic
from kompass.recipe.condition_function import ConditionFunction, condition_function
from kompass.recipe.functions import name_of
from kompass.rules.schema.actions import RaiseAlarm
from kompass.rules.schema.conditions import CallableCondition, Changed, Condition
from kompass.rules.schema.describe import describe
from kompass.rules.schema.events import Event as RuleEvent
from kompass.rules.schema.table import Rule
from kompass.settings import notice_once

# What events of other releases have, and what does it here. An event is read once: what becomes of
# it lives in the monitor, in a process of its own.
_ELSEWHERE = {
    "id": "its rule gets one of its condition; state it with event.as_rule('my-id')",
    **dict.fromkeys(
        ("trig", "raise_event_trigger"),
        "publish what its condition waits for, or answer a topic with launcher.on(Event(topic), …)",
    ),
    **dict.fromkeys(
        ("clear", "reset"),
        "'kompass-console rules reset <rule>' lets a rule start afresh, and so does the page",
    ),
    **dict.fromkeys(
        ("trigger", "under_processing", "processed_once", "get_last_processed_id"),
        "'kompass-console rules explain <rule>' and the topic /monitor/rules_state tell it",
    ),
    **dict.fromkeys(
        ("register_method", "register_actions", "clear_actions"),
        "name what answers it with launcher.on(event, Action(function)), or in events_actions",
    ),
    **dict.fromkeys(
        ("json", "dictionary", "to_json", "to_dict"),
        "'kompass-console rules export' writes it with its actions, as a rule",
    ),
    **dict.fromkeys(
        ("from_json", "from_dict"), "'kompass-console rules apply' reads rules from a file"
    ),
    **dict.fromkeys(
        ("get_involved_topics", "verify_required_action_topics"),
        "'kompass-console rules explain <rule>' names them",
    ),
    **dict.fromkeys(
        ("check_condition", "check_action_condition"),
        "'kompass-console rules backtest' tells when it would fire",
    ),
}


class Event:
    """Something that happens, to be answered by actions.

    Parameters
    ----------
    event_condition
        A comparison (``topic.msg.data > 5``), a combination of them, a Topic (each message), or a
        function without arguments that returns a truth value.
    on_change
        Fire on becoming true, instead of on each message for which it is true.
    handle_once
        At most once while the stack runs.
    keep_event_delay
        Dead time after the actions have finished [s].
    check_rate
        How often a function is asked [Hz]; ten times a second unless stated.

    Raises
    ------
    TypeError
        When the condition is none of these, or cannot be asked without more.
    ValueError
        When the delay is negative, or the rate is not above 0.
    """

    @named_arguments
    def __init__(
        self,
        event_condition: Any,
        on_change: bool = False,
        handle_once: bool = False,
        keep_event_delay: float = 0.0,
        check_rate: float | None = None,
    ) -> None:
        self.name = ""
        self.function: ConditionFunction | None = None
        if isinstance(event_condition, MessageField):
            raise TypeError(f"{event_condition!r} is a value; compare it, or write .is_true()")
        if callable(event_condition) and not isinstance(event_condition, Topic):
            self.function = condition_function(event_condition, check_rate)
            condition: Condition = CallableCondition(
                name=name_of(self.function.use.function), rate=self.function.use.rate
            )
        else:
            condition = condition_of(event_condition)
            if check_rate is not None:
                notice_once(
                    f"check_rate={check_rate!r} means nothing for {describe(condition)}: "
                    "only functions are asked at a rate"
                )
        self.rule_event = _rule_event(
            condition=condition,
            trigger="edge" if on_change else "level",
            cooldown=_delay(keep_event_delay),
            once=handle_once,
        )

    # What `as_rule` has stated of the rule, beside its event; and of the event, beside the above.
    rule_fields: Mapping[str, Any] = {}
    event_fields: Mapping[str, Any] = {}

    def as_rule(self, rule_id: str = "", **fields: Any) -> Self:
        """State more of the rule that this event becomes; returns the event itself.

        Parameters
        ----------
        rule_id
            By which history and journal know the rule; made of the name or condition unless given.
        fields
            Of the rule (:class:`kompass.rules.Rule`): ``name``, ``note``, ``severity``, ``lane``,
            ``enabled``, ``protected`` (nobody may edit it away), ``shadow``. Of when it fires
            (:class:`kompass.rules.Event`): ``trigger``, ``hold`` [s], ``clear`` (a condition),
            ``cooldown`` [s], ``once``, ``mode``, ``max_rate``, ``first_true_is_edge``.

        Raises
        ------
        TypeError
            For a field that neither has, or an id that is no text.
        ValueError
            When a value does not fit.
        """
        if not isinstance(rule_id, str):
            raise TypeError(f"{self!r}: rule_id = {rule_id!r} is no text; give one, as 'too-near'")
        of_rule = {"name", "note", "severity", "lane", "enabled", "protected", "shadow"}
        of_event = set(RuleEvent.model_fields) - {"condition"}
        unknown = [name for name in fields if name not in of_rule | of_event]
        if unknown:
            close = difflib.get_close_matches(unknown[0], of_rule | of_event, n=1)
            remedy = f"did you mean '{close[0]}'?" if close else f"known: {sorted(of_event)}"
            raise TypeError(f"{self!r}: a rule has no field '{unknown[0]}'; {remedy}")
        _check_rule(self.rule_event, {name: fields[name] for name in fields if name in of_rule})
        if fields.get("clear") is not None:
            fields["clear"] = condition_of(fields["clear"])
        stated = {name: value for name, value in fields.items() if name in of_event}
        known = {name: getattr(self.rule_event, name) for name in RuleEvent.model_fields}
        self.rule_event = _rule_event(**{**known, **stated})
        self.event_fields = {**self.event_fields, **stated}
        self.rule_fields = {
            **self.rule_fields,
            **{name: value for name, value in fields.items() if name in of_rule},
            **({"id": rule_id} if rule_id else {}),
        }
        return self

    @property
    def id(self) -> str:
        """The id of its rule, when that was stated or the event has a name.

        Raises
        ------
        AttributeError
            When it was not; the launcher makes one of the condition then.
        """
        stated = self.rule_fields.get("id") or (slug(self.name) if self.name else "")
        if not stated:
            raise AttributeError("id")  # told of by __getattr__, which Python asks next
        return str(stated)

    def __invert__(self) -> Event:
        raise TypeError(f"{self!r} has no opposite; negate its condition: Event(~(condition))")

    def __getattr__(self, name: str) -> Any:
        ours = _ELSEWHERE.get(name)
        if ours is None:
            raise AttributeError(f"'{type(self).__name__}' object has no attribute '{name}'")
        raise AttributeError(f"an event has no '{name}' here; {ours}")

    def __repr__(self) -> str:
        return f"Event({self.name or describe(self.rule_event.condition)})"


def slug(text: str) -> str:
    """Turn a name or a condition into an identifier of small letters, digits and dashes."""
    words = {
        "==": "is",
        "!=": "is-not",
        "<=": "at-most",
        ">=": "at-least",
        "<": "below",
        ">": "above",
    }
    for sign, word in words.items():
        text = text.replace(sign, f" {word} ")
    made = re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:80]
    return made or "rule"


def _delay(stated: float) -> float:
    fits = isinstance(stated, int | float) and not isinstance(stated, bool)
    if not fits or not (math.isfinite(stated) or stated < 0):
        raise ValueError(f"keep_event_delay = {stated!r}: give a number of seconds")
    if stated < 0:
        raise ValueError(f"keep_event_delay = {stated!r} must not be negative")
    return float(stated)


def _rule_event(**fields: Any) -> RuleEvent:
    try:
        return RuleEvent(**fields)
    except ValidationError as error:
        where, value, said = first_invalid(error)
        text = f"{where} = {value!r}: {said}" if where else said
        raise ValueError(f"Event({describe(fields['condition'])}): {text}") from None


def _check_rule(event: RuleEvent, fields: Mapping[str, Any]) -> None:
    """Raise where a value is none of a rule; its actions are not known yet."""
    action = RaiseAlarm(alarm="as_rule")
    try:
        Rule.model_validate({"id": "as_rule", "event": event, "actions": [action], **fields})
    except ValidationError as error:
        where, value, said = first_invalid(error)
        raise ValueError(f"as_rule: {where} = {value!r}: {said}") from None


class _NamedEvent(Event, ABC):
    """An event with a name, over one field of one topic."""

    when = "level"
    first_true_is_edge = True

    def __init__(
        self,
        event_name: str,
        event_source: Topic,
        nested_attributes: str | Sequence[str],
        handle_once: bool,
        keep_event_delay: float,
    ) -> None:
        if not isinstance(event_source, Topic):
            raise TypeError(f"{event_name}: event_source = {event_source!r} is not a Topic")
        self.name = event_name
        self.function = None
        self._field = _field_at(event_source, nested_attributes)
        self.rule_event = _rule_event(
            condition=self._condition(),
            trigger=self.when,
            cooldown=_delay(keep_event_delay),
            once=handle_once,
            first_true_is_edge=self.first_true_is_edge,
        )

    @abstractmethod
    def _condition(self) -> Condition:
        """What must be true of the message."""


class _Valued(_NamedEvent):
    """A named event that compares the field with a value."""

    @named_arguments
    def __init__(
        self,
        event_name: str,
        event_source: Topic,
        trigger_value: Any,
        nested_attributes: str | Sequence[str],
        handle_once: bool = False,
        keep_event_delay: float = 0.0,
    ) -> None:
        self._value = trigger_value
        super().__init__(event_name, event_source, nested_attributes, handle_once, keep_event_delay)


class OnAny(_NamedEvent):
    """Each message."""

    @named_arguments
    def __init__(
        self,
        event_name: str,
        event_source: Topic,
        handle_once: bool = False,
        keep_event_delay: float = 0.0,
    ) -> None:
        self._topic = event_source
        super().__init__(event_name, event_source, (), handle_once, keep_event_delay)

    def _condition(self) -> Condition:
        return condition_of(self._topic)


class OnEqual(_Valued):
    """Each message whose field equals the value."""

    def _condition(self) -> Condition:
        return condition_of(self._field == self._value)


class OnDifferent(_Valued):
    """Each message whose field differs from the value."""

    def _condition(self) -> Condition:
        return condition_of(self._field != self._value)


class _Ordered(_Valued):
    @named_arguments
    def __init__(
        self,
        event_name: str,
        event_source: Topic,
        trigger_value: Any,
        nested_attributes: str | Sequence[str],
        or_equal: bool = False,
        handle_once: bool = False,
        keep_event_delay: float = 0.0,
    ) -> None:
        self._or_equal = or_equal
        super().__init__(
            event_name,
            event_source,
            trigger_value,
            nested_attributes,
            handle_once,
            keep_event_delay,
        )


class OnGreater(_Ordered):
    """Each message whose field is greater than the value (or equal, if wanted)."""

    def _condition(self) -> Condition:
        compare = self._field >= self._value if self._or_equal else self._field > self._value
        return condition_of(compare)


class OnLess(_Ordered):
    """Each message whose field is less than the value (or equal, if wanted)."""

    def _condition(self) -> Condition:
        compare = self._field <= self._value if self._or_equal else self._field < self._value
        return condition_of(compare)


class OnContainsAll(_Valued):
    """Each message whose field holds all of the items."""

    def _condition(self) -> Condition:
        if isinstance(self._value, list | tuple):
            return condition_of(self._field.contains_all(self._value))
        return condition_of(self._field.contains(self._value))


class OnContainsAny(_Valued):
    """Each message whose field holds one of the items."""

    def _condition(self) -> Condition:
        return condition_of(self._field.contains_any(_listed(self._value)))


class OnChange(_NamedEvent):
    """Each message whose field differs from the one before."""

    when = "change"

    @named_arguments
    def __init__(
        self,
        event_name: str,
        event_source: Topic,
        nested_attributes: str | Sequence[str],
        handle_once: bool = False,
        keep_event_delay: float = 0.0,
    ) -> None:
        super().__init__(event_name, event_source, nested_attributes, handle_once, keep_event_delay)

    def _condition(self) -> Condition:
        return Changed(signal=signal_of(self._field))


class OnChangeEqual(OnEqual):
    """The field changed into the value; never the first message."""

    when = "change"


class OnChangeContainsAll(OnContainsAll):
    """The field changed and now holds all of the items."""

    when = "change"


class OnChangeContainsAny(OnContainsAny):
    """The field held none of the items, and now holds one."""

    when = "edge"
    first_true_is_edge = False


class OnChangeNotContain(_Valued):
    """The field held one of the items, and now holds none."""

    when = "edge"
    first_true_is_edge = False

    def _condition(self) -> Condition:
        return condition_of(self._field.not_contains_any(_listed(self._value)))


def _listed(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list | tuple | set) else [value]


def _field_at(topic: Topic, attributes: str | Sequence[str]) -> MessageField:
    path = (attributes,) if isinstance(attributes, str) else tuple(attributes)
    return MessageField(topic.name, topic.ros_msg_type, topic.data_timeout, path)
