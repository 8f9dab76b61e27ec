"""What checking and applying a table answers."""

from typing import Literal

from pydantic import JsonValue

from kompass.rulebook.schema.diff_models import TableDiff
from kompass.rules.schema.model import Model


class Finding(Model):
    """Something wrong with a rule (``error``), or to think about (``lint``).

    Attributes
    ----------
    code
        Short and stable, e.g. ``unknown-field``, ``self-trigger``, ``protected``.
    field, value
        Where, and what stands there.
    text, remedy
        What is wrong, and what to do instead.
    """

    level: Literal["error", "lint"]
    code: str
    rule_id: str
    field: str
    value: JsonValue = None
    text: str
    remedy: str


class Effect(Model):
    """What happens, or happened, to the rules' state; ids of rules.

    ``running`` are those whose actions are running and whose content changes.
    """

    carried: tuple[str, ...] = ()
    reset: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()
    added: tuple[str, ...] = ()
    running: tuple[str, ...] = ()


class CheckReport(Model):
    """``ok`` when there is no error; lints do not forbid anything."""

    ok: bool
    revision: int  # in force, against which it was checked
    findings: tuple[Finding, ...] = ()
    diff: TableDiff = TableDiff()
    effect: Effect = Effect()


class ApplyReport(Model):
    """A table went into force.

    Attributes
    ----------
    probation
        Seconds after which it is taken back unless confirmed; 0 for never.
    pause
        Seconds for which the monitor took no message.
    """

    revision: int
    previous: int
    probation: float
    pause: float
    effect: Effect
    diff: TableDiff
    findings: tuple[Finding, ...] = ()


class Conflict(Model):
    """Somebody else was faster: nothing was applied.

    Attributes
    ----------
    expected, revision
        From which the edit began, and what is in force.
    author, time, reason
        Of the revision in force.
    theirs, yours
        What each changed since ``expected``.
    both
        Ids of rules that both changed.
    """

    expected: int
    revision: int
    author: str
    time: float
    reason: str
    theirs: TableDiff
    yours: TableDiff
    both: tuple[str, ...] = ()
