"""What differs between two tables."""

from typing import Literal

from pydantic import JsonValue

from kompass.rules.schema.model import Model


class FieldChange(Model):
    """One field of a rule, before and after; None where it does not exist.

    Attributes
    ----------
    field
        Where in the rule, e.g. ``event.cooldown`` or ``actions[0].text``.
    """

    field: str
    before: JsonValue = None
    after: JsonValue = None


class RuleChange(Model):
    """One rule that differs.

    Attributes
    ----------
    kind
        ``moved`` when only its place in the order differs.
    semantic
        Whether it behaves differently; false when only its name, note or place changed.
    summary
        One sentence for a person: "cooldown 60 s → 20 s".
    """

    rule_id: str
    name: str
    kind: Literal["added", "removed", "changed", "moved"]
    semantic: bool
    summary: str
    fields: tuple[FieldChange, ...] = ()


class TableDiff(Model):
    """From one table to another; empty ``changes`` when they are the same."""

    before: int | None = None  # revisions, where known
    after: int | None = None
    changes: tuple[RuleChange, ...] = ()
