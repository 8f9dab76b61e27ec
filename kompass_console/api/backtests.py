"""Back-tests: what a table would have done on a recording."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Request

from kompass.rclpy_ext.reply import NoAnswer
from kompass_console.api.access import CurrentConsole, LoggedIn, Operator
from kompass_console.api.monitor import body_of, no_monitor, read_table
from kompass_console.link.rules.backtests import TooMany
from kompass_console.schema.rule_models import (
    BacktestOptions,
    BacktestProgress,
    BacktestRequest,
    BacktestStarted,
)
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api", tags=["backtests"])

BacktestId = Annotated[str, Path(max_length=100)]


@router.post("/backtests", status_code=202, openapi_extra=body_of(BacktestRequest))
async def start_backtest(
    request: Request, session: Operator, console: CurrentConsole
) -> BacktestStarted:
    """Begin to try a table on a recording; ask for its progress by the id."""
    table, options = await read_table(request, BacktestOptions)
    what = options.model_dump()
    try:
        job = await console.link.backtests.start(table, options.recording, options.seconds)
    except NoAnswer as error:
        console.audit.record(session, "back-test", error.why, **what)
        raise no_monitor(error) from error
    except TooMany as error:
        console.audit.record(session, "back-test", "too many", **what)
        raise ConsoleError(429, f"{error}", "Wait until one has ended, or cancel one.") from error
    console.audit.record(session, "back-test", "started", id=job, **what)
    return BacktestStarted(id=job)


@router.get("/backtests/{backtest_id}")
async def backtest(
    backtest_id: BacktestId, _: LoggedIn, console: CurrentConsole
) -> BacktestProgress:
    """How far it is, and its report when it is done."""
    progress = console.link.backtests.progress(backtest_id)
    if progress is None:
        raise _unknown()
    return progress


@router.delete("/backtests/{backtest_id}", status_code=204)
async def cancel_backtest(
    backtest_id: BacktestId, session: Operator, console: CurrentConsole
) -> None:
    """Cancel it; of one that has ended, forget the report."""
    done = console.link.backtests.cancel(backtest_id)
    outcome = "done" if done else "unknown"
    console.audit.record(session, "cancel back-test", outcome, id=backtest_id)
    if not done:
        raise _unknown()


def _unknown() -> ConsoleError:
    return ConsoleError(
        404,
        "This console does not know the back-test: it was started again, or the report is old.",
        "Start the back-test again.",
    )
