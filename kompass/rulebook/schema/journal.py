"""The journal of firings."""

from typing import Any, Literal

from pydantic import BaseModel, JsonValue, model_validator

from kompass.rulebook.schema.status import LeafReading
from kompass.rules.schema.model import Model


class ActionRecord(Model):
    """How one action of a run ended.

    Attributes
    ----------
    problem
        Why it failed, to be read beside the name of the action; empty when it did not. Entries of
        before it was told apart have their text.
    """

    action: str
    ok: bool
    text: str
    seconds: float
    problem: str = ""

    @model_validator(mode="before")
    @classmethod
    def _of_before(cls, data: Any) -> Any:
        if isinstance(data, dict) and "problem" not in data and not data.get("ok", True):
            return {**data, "problem": data.get("text", "")}
        return data


class FiringRecord(Model):
    """One firing, with what came of it.

    Attributes
    ----------
    number
        Of the entry in the journal; never used twice.
    epoch
        The life of the monitor that it belongs to; ``run_id`` counts within it.
    kind
        ``firing``; ``shadow`` when it was evaluated and not acted upon; ``note`` for what the
        engine reports otherwise; ``near miss`` when it came close and did not fire; ``outranked``
        when a more severe rule had the component.
    time
        Seconds since the epoch (1970).
    revision
        Number of the table's revision in force, and ``rule_hash`` of the rule.
    ended, ok
        None while it runs.
    message
        The message that triggered it, as data; None when time did. Long lists are cut.
    recording
        Path of the recording kept around it; empty for none.
    """

    number: int
    epoch: str
    run_id: int
    rule_id: str
    name: str
    kind: Literal["firing", "shadow", "note", "near miss", "outranked"]
    time: float
    revision: int
    rule_hash: str
    severity: str
    topic: str | None = None
    text: str = ""
    leaves: tuple[LeafReading, ...] = ()
    actions: tuple[ActionRecord, ...] = ()
    ended: float | None = None
    ok: bool | None = None
    error: str = ""
    message: JsonValue = None
    recording: str = ""


class Journal(Model):
    """A stretch of the journal, newest first."""

    firings: tuple[FiringRecord, ...]
    more: bool


class FiringStep(BaseModel):
    """One step in the life of a rule's run, as the monitor published it.

    `details` has the leaves when it fired, and the action and its seconds when one ended.
    """

    time: float
    rule_id: str
    rule_hash: str
    revision: int
    run_id: int
    phase: str
    ok: bool
    text: str
    details: JsonValue
