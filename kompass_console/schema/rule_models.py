"""The contract of the rules' routes and websockets; what is said of tables is in the rulebook."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import AfterValidator, BaseModel, Field

from kompass.backtest.report import BacktestReport
from kompass.monitor.tables.types import MAX_TEXT
from kompass.rulebook.schema.alarm import Alarm
from kompass.rulebook.schema.journal import FiringStep
from kompass.rulebook.schema.report import CheckReport, Conflict
from kompass.rulebook.schema.status import LeafReading, RuleStatus
from kompass.rules.schema.conditions import Condition
from kompass.rules.schema.table import Table
from kompass_console.schema.models import ErrorAnswer, In
from kompass_console.schema.plain import plain

Revision = Annotated[int, Field(ge=0, le=2**32 - 1)]
Reason = Annotated[
    str, Field(max_length=MAX_TEXT), AfterValidator(lambda said: plain(said, MAX_TEXT))
]


class NoOptions(In):
    """Nothing beside the table."""


class CheckRequest(NoOptions):
    """A table to check."""

    table: Table


class ApplyOptions(In):
    """How to put a table in force.

    `expected_revision` is the one the edit began from. `probation` are the seconds after which it
    is taken back unless confirmed; 0 never, null the monitor's default. `cancel_running` cancels
    running actions of changed and removed rules instead of letting them finish. `reset` are ids of
    unchanged rules that are to start afresh.
    """

    expected_revision: Revision
    reason: Reason = ""
    probation: Annotated[float, Field(ge=0.0, le=86_400.0)] | None = None
    cancel_running: bool = False
    reset: list[Annotated[str, Field(max_length=100)]] = Field(
        default_factory=list, max_length=10_000
    )


class ApplyRequest(ApplyOptions):
    """A table to put in force, and how."""

    table: Table


class ConfirmRequest(In):
    """The revision on probation that is to stay."""

    revision: Revision


class RollbackRequest(In):
    """Go back to the table of `revision`; null for the one before the one in force."""

    revision: Revision | None = None
    expected_revision: Annotated[Revision, Field(ge=1)]
    reason: Reason = ""
    cancel_running: bool = False


class Done(BaseModel):
    """It was done; one sentence."""

    message: str


class ConflictAnswer(ErrorAnswer):
    """Somebody else was faster; nothing was applied."""

    conflict: Conflict


class RefusedAnswer(ErrorAnswer):
    """The table has errors, or a guard rail forbids the change; nothing was applied.

    `report` is null, or absent, where it is not the table that is wrong, or it could not be read.
    """

    report: CheckReport | None = None


class BacktestOptions(In):
    """On which recording: a path on the robot, empty for the flight recorder's ring. `seconds`
    are the last ones of it; 0 for all."""

    recording: Annotated[str, Field(max_length=1000)] = ""
    seconds: Annotated[float, Field(ge=0.0, le=1e7, allow_inf_nan=False)] = 0.0


class BacktestRequest(BacktestOptions):
    """A table to try on a recording."""

    table: Table


class BacktestStarted(BaseModel):
    """A back-test runs; ask for it by its id."""

    id: str


class BacktestProgress(BaseModel):
    """How far a back-test is (0 to 1), and what it found or why it failed."""

    id: str
    state: Literal["waiting", "running", "done", "failed", "canceled"]
    progress: float
    text: str
    report: BacktestReport | None
    error: str | None


class RulesLive(BaseModel):
    """Message of `/api/rules/live`: the rules now, and what happened since the last message.

    `age` (s) is how old the monitor's word is; `available` is false when it is silent.
    """

    type: Literal["rules"] = "rules"
    available: bool
    revision: int
    confirmed: int
    probation_left: float
    notice: str
    robot: str
    statuses: list[RuleStatus]
    firings: list[FiringStep]
    missed: int  # steps that happened since the last message and are not in it
    alarms: list[Alarm]
    age: float | None


class ProbeRequest(In):
    """What the page sends on `/api/rules/probe`: a condition that need not be saved anywhere.

    A new request takes the place of the one with the same `id`; null ends it.
    """

    id: Annotated[str, Field(max_length=100)] = ""
    condition: Condition | None
    clear: Condition | None = None


class ProbeReading(BaseModel):
    """Message of `/api/rules/probe`: the condition as the engine judges it now.

    `verdict` null is unknown. `error` is a sentence, and empty when there is none.
    """

    type: Literal["probe"] = "probe"
    id: str
    leaves: list[LeafReading]
    verdict: bool | None
    clear_leaves: list[LeafReading]
    clear_verdict: bool | None
    error: str

    @classmethod
    def failed(cls, probe_id: str, error: str) -> Self:
        """Of a condition that cannot be looked at."""
        return cls(
            id=probe_id,
            leaves=[],
            verdict=None,
            clear_leaves=[],
            clear_verdict=None,
            error=error,
        )
