"""Why and when: explanations, the history, the journal of firings, and what rules are made of."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any

from fastapi import APIRouter, Query, Response
from fastapi.responses import PlainTextResponse

from kompass.monitor.client import Json
from kompass.recipe.export import Format, export
from kompass.rulebook.schema.diff_models import TableDiff
from kompass.rulebook.schema.explanation import ExplanationView
from kompass.rulebook.schema.graph_view import GraphView
from kompass.rulebook.schema.journal import Journal
from kompass.rulebook.schema.revision import History
from kompass.rulebook.schema.table_view import TableView
from kompass.rules.schema.table import Table
from kompass_console.api.access import CurrentConsole, LoggedIn
from kompass_console.api.monitor import asked, passed_on
from kompass_console.api.rules import RuleName
from kompass_console.schema.rule_models import Revision

router = APIRouter(prefix="/api", tags=["rules"])

_SUFFIXES: dict[Format, str] = {"json": "json", "yaml": "yaml", "python": "py"}
_RELOAD = "Load the rules again and look at what is in force."
Count = Annotated[int, Query(ge=1, le=1000)]
Number = Annotated[int, Query(ge=0, le=2**63 - 1)]


@router.get("/rules/{rule_id}/explain", response_model=ExplanationView)
async def explain_rule(
    rule_id: RuleName,
    _: LoggedIn,
    console: CurrentConsole,
    run_id: Number = 0,
    epoch: Annotated[str, Query(max_length=200)] = "",
) -> Response:
    """Why a rule fires or does not: now, or at the firing `run_id` of a life of the monitor."""
    return passed_on(
        await asked(console, lambda m: m.explain(rule_id, run_id, epoch), 404, _RELOAD)
    )


@router.get("/rules/history", response_model=History)
async def rules_history(
    _: LoggedIn,
    console: CurrentConsole,
    before: Annotated[Revision, Query()] = 0,
    count: Count = 50,
) -> Response:
    """Revisions below `before` (0: from the newest), newest first."""
    return passed_on(await asked(console, lambda m: m.history(before, count), 404, _RELOAD))


@router.get("/rules/diff", response_model=TableDiff)
async def rules_diff(
    _: LoggedIn,
    console: CurrentConsole,
    before: Annotated[int, Query(alias="from", ge=1, le=2**32 - 1)],
    after: Annotated[int, Query(alias="to", ge=1, le=2**32 - 1)],
) -> Response:
    """What differs between two revisions."""
    return passed_on(await asked(console, lambda m: m.diff(before, after), 404, _RELOAD))


@router.get("/rules/export", response_class=PlainTextResponse)
async def export_rules(
    _: LoggedIn,
    console: CurrentConsole,
    as_format: Annotated[Format, Query(alias="format")] = "json",
    revision: Annotated[Revision, Query()] = 0,
) -> Response:
    """A revision of the table (0: in force) as a file."""
    answer = await asked(console, lambda m: m.table(revision), 404, _RELOAD)
    text, number = await asyncio.to_thread(_table_text, answer, as_format)
    name = f"rules-{number}.{_SUFFIXES[as_format]}"
    headers = {"Content-Disposition": f'attachment; filename="{name}"'}
    return PlainTextResponse(text, headers=headers)


@router.get("/rules/schema")
def rules_schema(_: LoggedIn) -> dict[str, Any]:
    """JSON Schema of a table, for editors and scripts."""
    return Table.model_json_schema()


@router.get("/firings", response_model=Journal)
async def firings(
    _: LoggedIn,
    console: CurrentConsole,
    before: Number = 0,
    count: Count = 100,
    rule_id: Annotated[str, Query(max_length=100)] = "",
) -> Response:
    """Entries of the journal below `before` (0: from the newest), newest first."""
    return passed_on(
        await asked(console, lambda m: m.firings(before, count, rule_id), 404, _RELOAD)
    )


@router.get("/graph", response_model=GraphView)
async def graph(_: LoggedIn, console: CurrentConsole) -> Response:
    """What rules can be made of on this robot, now."""
    remedy = "Wait a moment and try again."
    return passed_on(await asked(console, lambda m: m.graph(), 503, remedy))


def _table_text(answer: Json[TableView], as_format: Format) -> tuple[str, int]:
    """A table as a file's text, and the number of its revision."""
    view = answer.parsed()
    title = f"{view.robot}, revision {view.revision}"
    return export(view.table, as_format, title=title), view.revision
