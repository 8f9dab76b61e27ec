"""The rule table: read, check, put in force, keep, take back."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request, Response
from kompass_interfaces.srv import (
    ApplyRules,
    CheckRules,
    ConfirmRules,
    GetRules,
    ResetRule,
    RollbackRules,
)

from kompass.rulebook.schema.report import ApplyReport, CheckReport
from kompass.rulebook.schema.table_view import TableView
from kompass_console.api.access import CurrentConsole, LoggedIn, Operator
from kompass_console.api.monitor_answers import ask, asked, sentence
from kompass_console.api.payload import body_of, passed_on, read_table, refusal
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
from kompass_console.web.auth import Session
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/rules", tags=["rules"])

RuleName = Annotated[str, Path(max_length=100)]

_DEFAULT_PROBATION = -1.0  # as in ApplyRules
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
    answer = await asked(console, GetRules.Request(revision=revision), 404, _RELOAD)
    return passed_on(answer.answer)


@router.post("/check", response_model=CheckReport, openapi_extra=body_of(CheckRequest))
async def check_rules(request: Request, session: LoggedIn, console: CurrentConsole) -> Response:
    """What is wrong with a table, and what applying it would do. Changes nothing."""
    table, _ = await read_table(request, NoOptions)
    answer = await ask(console, CheckRules.Request(table=table, role=session.role))
    if not answer.answer:
        raise ConsoleError(422, sentence(answer.message), "Correct the table and check it again.")
    return passed_on(answer.answer)


@router.post(
    "/apply",
    response_model=ApplyReport,
    responses=_CHANGES,
    openapi_extra=body_of(ApplyRequest),
)
async def apply_rules(request: Request, session: Operator, console: CurrentConsole) -> Response:
    """Put a table in force: all of it between two messages, or nothing."""
    table, options = await read_table(request, ApplyOptions)
    probation = _DEFAULT_PROBATION if options.probation is None else options.probation
    wanted = ApplyRules.Request(
        table=table,
        expected_revision=options.expected_revision,
        author=session.user,
        role=session.role,
        reason=options.reason,
        probation=probation,
        cancel_running=options.cancel_running,
        reset=options.reset,
    )
    what = options.model_dump(exclude={"reset"})
    return await _change(console, session, "apply rules", wanted, what)


@router.post("/rollback", response_model=ApplyReport, responses=_CHANGES)
async def rollback_rules(
    body: RollbackRequest, session: Operator, console: CurrentConsole
) -> Response:
    """Put the table of an earlier revision in force again, as a new revision."""
    wanted = RollbackRules.Request(
        revision=body.revision or 0,
        expected_revision=body.expected_revision,
        author=session.user,
        role=session.role,
        reason=body.reason,
        cancel_running=body.cancel_running,
    )
    return await _change(console, session, "roll back rules", wanted, body.model_dump())


@router.post("/confirm")
async def confirm_rules(body: ConfirmRequest, session: Operator, console: CurrentConsole) -> Done:
    """Keep the revision that is on probation."""
    wanted = ConfirmRules.Request(revision=body.revision, author=session.user, role=session.role)
    what = body.model_dump()
    return await _small_change(console, session, "confirm rules", wanted, what, 409)


@router.post("/{rule_id}/reset")
async def reset_rule(rule_id: RuleName, session: Operator, console: CurrentConsole) -> Done:
    """Let a rule start afresh: its once, its cooldown and its rate latch."""
    wanted = ResetRule.Request(rule_id=rule_id, author=session.user, role=session.role)
    return await _small_change(console, session, "reset rule", wanted, {"rule": rule_id}, 404)


async def _change(
    console: Console, session: Session, what: str, wanted: Any, details: dict[str, Any]
) -> Response:
    try:
        answer = await ask(console, wanted)
    except ConsoleError as error:
        console.audit.record(session.user, session.role, what, error.title, **details)
        raise
    outcome = sentence(answer.message) if answer.message or answer.outcome else "done"
    console.audit.record(
        session.user, session.role, what, outcome, in_force=int(answer.revision), **details
    )
    if answer.outcome == ApplyRules.Request.APPLIED:
        return passed_on(answer.answer)
    if answer.outcome == ApplyRules.Request.CONFLICT:
        remedy = "Look at both changes, choose what to keep, and apply again."
        return refusal(409, outcome, remedy, "conflict", answer.answer)
    if answer.outcome == ApplyRules.Request.REFUSED:
        remedy = "Correct what the findings name, and apply again."
        return refusal(422, outcome, remedy, "report", answer.answer)
    raise ConsoleError(
        507,
        outcome,
        "The old rules stay in force. Make room on the robot's disk, or look at the monitor's log.",
    )


async def _small_change(
    console: Console,
    session: Session,
    what: str,
    wanted: Any,
    details: dict[str, Any],
    status: int,
) -> Done:
    try:
        answer = await asked(console, wanted, status, _RELOAD)
    except ConsoleError as error:
        console.audit.record(session.user, session.role, what, error.title, **details)
        raise
    console.audit.record(session.user, session.role, what, "done", **details)
    return Done(message=sentence(answer.message or "done"))
