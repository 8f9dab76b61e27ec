"""Rules, the immutable table of them, and the hashes that identify what they do."""

import hashlib
import json
from enum import IntEnum
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, PlainSerializer, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError

from kompass.rules.schema.actions import Action
from kompass.rules.schema.events import Event
from kompass.rules.schema.identity_cache import IdentityCache
from kompass.rules.schema.model import Model


class Severity(IntEnum):
    """Who wins when two rules want the same component."""

    INFO = 0
    WARNING = 1
    ERROR = 2
    CRITICAL = 3


_SEVERITIES = {severity.name.lower(): severity for severity in Severity}


def _severity(value: Any) -> Severity:
    if isinstance(value, Severity):
        return value
    found = _SEVERITIES.get(value) if isinstance(value, str) else None
    if found is None:
        raise ValueError(f"{value!r} is not a severity; known are: {', '.join(_SEVERITIES)}")
    return found


SeverityField = Annotated[
    Severity,
    BeforeValidator(_severity),
    PlainSerializer(lambda s: s.name.lower(), return_type=str),
    WithJsonSchema({"enum": [*_SEVERITIES], "type": "string"}),
]
RuleId = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9_.-]{0,99}$", examples=["stuck-unblock"])]
SAME_ID = "same-id"  # kind of the error of a table in which two rules have one
Lane = Literal["safety", "normal"]
Source = Literal["recipe", "engineer", "edited"]


class Rule(Model):
    """One event and the actions that answer it.

    Attributes
    ----------
    id
        Stable slug; what the history and the journal know the rule by.
    severity
        Which of two rules wins when both want the same component.
    lane
        Rules of the safety lane never wait for rules of the normal one.
    protected
        Whether editing it away is refused.
    shadow
        Whether it is evaluated and recorded without acting.
    source
        Who had a hand in it: ``recipe`` for the recipe alone, ``engineer`` for engineers,
        ``edited`` once an operator has. The rule has the rights of that person.
    """

    id: RuleId
    name: str = ""
    enabled: bool = True
    event: Event
    actions: Annotated[tuple[Action, ...], Field(min_length=1)]
    # The default of the schema, too, is told by its name: JSON knows no number of it.
    severity: Annotated[SeverityField, Field(json_schema_extra={"default": "warning"})] = (
        Severity.WARNING
    )
    lane: Lane = "normal"
    protected: bool = False
    shadow: bool = False
    note: str = ""
    source: Source = "edited"


class Table(Model):
    """The rules of a robot, in the order in which they are evaluated."""

    rules: tuple[Rule, ...] = ()

    @model_validator(mode="after")
    def _ids_are_unique(self) -> Self:
        seen: dict[str, tuple[int, Rule]] = {}
        for index, rule in enumerate(self.rules):
            if rule.id in seen:
                first, other = seen[rule.id]
                raise PydanticCustomError(
                    SAME_ID,
                    "rules[{first}] ({one}) and rules[{index}] ({other}) have the same id {id}; "
                    "rename one",
                    {
                        "first": first,
                        "one": repr(other.name or other.id),
                        "index": index,
                        "other": repr(rule.name or rule.id),
                        "id": repr(rule.id),
                        "field": f"rules[{index}].id",
                    },
                )
            seen[rule.id] = (index, rule)
        return self


# What a rule is called and where it comes from changes nothing of what it does.
_NOT_SEMANTIC = {"name", "note", "source"}


def rule_hash(rule: Rule) -> str:
    """Return 16 hex digits that differ between rules that behave differently."""
    return _rule_hash(rule)


def table_hash(table: Table) -> str:
    """Return 16 hex digits over what the rules do and their order."""
    return _table_hash(table)


def _digest(data: Any) -> str:
    text = json.dumps(data, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


_rule_hash = IdentityCache[Rule, str](
    lambda rule: _digest(rule.model_dump(mode="json", exclude=_NOT_SEMANTIC))
)
_table_hash = IdentityCache[Table, str](
    lambda table: _digest([rule_hash(rule) for rule in table.rules])
)
