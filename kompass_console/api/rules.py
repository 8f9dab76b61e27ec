"""The rule table: read, check, put in force, keep, take back."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request, Response
from pydantic import ValidationError

from kompass.monitor.client import (
    DEFAULT_PROBATION,
    Applied,
    Conflicting,
    Json,
    MonitorClient,
    NotApplied,
    TableRefused,
)
from kompass.rclpy_ext.reply import Reply
from kompass.rulebook.schema.report import ApplyReport, CheckReport
from kompass.rulebook.schema.table_view import TableView
from kompass_console.api.access import CurrentConsole, LoggedIn, Operator
from kompass_console.api.monitor import (
    ask,
    asked,
    body_of,
    passed_on,
    read_table,
    refusal,
    sentence,
)
from kompass_console.schema.rule_models import (
    ApplyOptions,
    ApplyRequest,
    CheckRequest,
    ConfirmRequest,
    ConflictAnswer,
    Done,
    NoOptions,
    RefusedAnswer,
    Revision,
    RollbackRequest,
)
from kompass_console.web.auth import LoginSession
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/rules", tags=["rules"])

RuleName = Annotated[str, Path(max_length=100)]

_RELOAD = "Load the rules again and look at what is in force."
_CHANGES: dict[int | str, dict[str, Any]] = {
    409: {"model": ConflictAnswer, "description": "Somebody else was faster"},
    422: {"model": RefusedAnswer, "description": "The table has errors, or is guarded"},
}


@router.get("", response_model=TableView)
async def rules(
    _: LoggedIn, console: CurrentConsole, revision: Annotated[Revision, Query()] = 0
) -> Response:
    """A revision of the table; 0 for the one in force."""
    return passed_on(await asked(console, lambda m: m.table(revision), 404, _RELOAD))


@router.post("/check", response_model=CheckReport, openapi_extra=body_of(CheckRequest))
async def check_rules(request: Request, session: LoggedIn, console: CurrentConsole) -> Response:
    """What is wrong with a table, and what applying it would do. Changes nothing."""
    table, _ = await read_table(request, NoOptions)
    remedy = "Correct the table and check it again."
    return passed_on(await asked(console, lambda m: m.check(table, session.role), 422, remedy))


@router.post(
    "/apply",
    response_model=ApplyReport,
    responses=_CHANGES,
    openapi_extra=body_of(ApplyRequest),
)
async def apply_rules(request: Request, session: Operator, console: CurrentConsole) -> Response:
    """Put a table in force: all of it between two messages, or nothing."""
    table, options = await read_table(request, ApplyOptions)
    probation = DEFAULT_PROBATION if options.probation is None else options.probation

    def change(monitor: MonitorClient) -> Reply[Applied]:
        return monitor.apply(
            table,
            expected=options.expected_revision,
            author=session.user,
            role=session.role,
            reason=options.reason,
            probation=probation,
            cancel_running=options.cancel_running,
            reset=options.reset,
        )

    what = {**options.model_dump(exclude={"expected_revision"}), "probation": probation}
    what["before"] = options.expected_revision
    return await _change(console, session, "apply rules", change, what)


@router.post("/rollback", response_model=ApplyReport, responses=_CHANGES)
async def rollback_rules(
    body: RollbackRequest, session: Operator, console: CurrentConsole
) -> Response:
    """Put the table of an earlier revision in force again, as a new revision."""

    def change(monitor: MonitorClient) -> Reply[Applied]:
        return monitor.roll_back(
            body.revision or 0,
            expected=body.expected_revision,
            author=session.user,
            role=session.role,
            reason=body.reason,
            cancel_running=body.cancel_running,
        )

    what = {
        "to": body.revision or "the one before",
        "before": body.expected_revision,
        **body.model_dump(exclude={"revision", "expected_revision"}),
    }
    return await _change(console, session, "roll back rules", change, what)


@router.post("/confirm")
async def confirm_rules(body: ConfirmRequest, session: Operator, console: CurrentConsole) -> Done:
    """Keep the revision that is on probation."""

    def change(monitor: MonitorClient) -> Reply[str]:
        return monitor.confirm(body.revision, author=session.user, role=session.role)

    what = body.model_dump()
    return await _small_change(console, session, "confirm rules", change, what, 409)


@router.post("/{rule_id}/reset")
async def reset_rule(rule_id: RuleName, session: Operator, console: CurrentConsole) -> Done:
    """Let a rule start afresh: its once, its cooldown and its rate latch."""

    def change(monitor: MonitorClient) -> Reply[str]:
        return monitor.reset(rule_id, author=session.user, role=session.role)

    return await _small_change(console, session, "reset rule", change, {"rule": rule_id}, 404)


async def _change(
    console: Console,
    session: LoginSession,
    what: str,
    change: Callable[[MonitorClient], Reply[Applied]],
    details: dict[str, Any],
) -> Response:
    def record(outcome: str, **more: Any) -> None:
        console.audit.record(session, what, outcome, **more, **details)

    try:
        applied = await ask(console, change)
    except ConsoleError as error:
        record(error.title)
        raise
    except NotApplied as error:
        why = sentence(str(error))
        record(why, in_force=error.in_force)
        if isinstance(error, Conflicting):
            remedy = "Look at both changes, choose what to keep, and apply again."
            return refusal(409, why, remedy, "conflict", error.conflict)
        if isinstance(error, TableRefused):
            remedy = "Correct what the findings name, and apply again."
            return refusal(422, why, remedy, "report", error.report)
        raise ConsoleError(
            507,
            why,
            "The old rules stay in force. Make room on the robot's disk, or look at the monitor's "
            "log.",
        ) from error
    console.drills.overtaken(applied.revision)
    outcome = sentence(applied.message) if applied.message else "done"
    record(outcome, after=applied.revision, rules=_changed_rules(applied.report))
    return passed_on(applied.report)


def _changed_rules(report: Json[ApplyReport]) -> dict[str, list[str]] | None:
    """Ids of the rules that a change touched, by how; None of a monitor of another release."""
    try:
        changes = report.parsed().diff.changes
    except ValidationError:
        return None
    touched: dict[str, list[str]] = {}
    for change in changes:
        touched.setdefault(change.kind, []).append(change.rule_id)
    return touched


async def _small_change(
    console: Console,
    session: LoginSession,
    what: str,
    change: Callable[[MonitorClient], Reply[str]],
    details: dict[str, Any],
    status: int,
) -> Done:
    try:
        said = await asked(console, change, status, _RELOAD)
    except ConsoleError as error:
        console.audit.record(session, what, error.title, **details)
        raise
    console.audit.record(session, what, "done", **details)
    return Done(message=sentence(said or "done"))
