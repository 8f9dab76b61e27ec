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


class Prospect(Model):
    """What is to be expected of a new or changed rule as soon as the table is applied.

    Attributes
    ----------
    fires
        ``soon``: ``seconds`` after it is applied. ``with a message``: ``seconds`` after the next
        message; without ``seconds``, with the next that changes a value. ``when next true``: its
        condition is true, and must be false first. ``with a change``: its condition is true, and
        a value must change on a topic that is silent. ``if silent``: ``seconds`` after it is
        applied, unless a message comes. ``unknown``: no value is known yet.
    acts
        Whether it may stop or move the robot, or something of it.
    text
        ``true now: it will fire in 2.0 s after Apply``.
    """

    rule_id: str
    fires: Literal[
        "soon", "with a message", "when next true", "with a change", "if silent", "unknown"
    ]
    seconds: float | None = None
    acts: bool
    text: str


class CheckReport(Model):
    """``ok`` when there is no error; lints do not forbid anything.

    Attributes
    ----------
    revision
        In force, against which it was checked.
    prospects
        New and changed rules that are true at this moment, or not known to be false.
    now
        The same in one line; empty where nothing is new or changed, or there are errors.
    """

    ok: bool
    revision: int
    findings: tuple[Finding, ...] = ()
    diff: TableDiff = TableDiff()
    effect: Effect = Effect()
    prospects: tuple[Prospect, ...] = ()
    now: str = ""


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
