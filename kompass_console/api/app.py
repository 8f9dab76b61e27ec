"""The web application: routes, errors as sentences, and the schema the page is typed against."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Mapping
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.responses import Response

from kompass_console.api import (
    audit,
    backtests,
    camera,
    control,
    drills,
    flat_map,
    goals,
    hand,
    insight,
    live,
    localisation,
    log,
    measure,
    missions,
    page,
    places,
    probe,
    recordings,
    rules,
    scene,
    session,
    stop,
    timeline,
    zones,
)
from kompass_console.api.access import LoggedIn
from kompass_console.api.audited import AuditRequests
from kompass_console.link.state import build_state
from kompass_console.schema.drill_models import DrillRequest
from kompass_console.schema.hand_models import HandAnswer, HandRequest
from kompass_console.schema.look_models import CameraNews
from kompass_console.schema.map_models import FlatNews
from kompass_console.schema.models import ErrorAnswer, ErrorDetail, Ping, StateMessage, StopRequest
from kompass_console.schema.rule_models import (
    ApplyRequest,
    BacktestRequest,
    CheckRequest,
    ProbeReading,
    ProbeRequest,
    RulesLive,
)
from kompass_console.version import VERSION
from kompass_console.web.body_limit import BodyLimit
from kompass_console.web.body_text import BodyText
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError
from kompass_console.web.invalid_request import told_invalid
from kompass_console.web.web_guard import WebGuard

_BESIDE_ROUTES: tuple[type[BaseModel], ...] = (
    StateMessage,
    Ping,
    HandRequest,
    HandAnswer,
    FlatNews,
    CameraNews,
    RulesLive,
    ProbeRequest,
    ProbeReading,
    CheckRequest,
    ApplyRequest,
    BacktestRequest,
    DrillRequest,
    StopRequest,
)


def create_app(console: Console | None) -> FastAPI:
    """The application of a console; None is for its schema only."""

    @contextlib.asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        assert console is not None  # without one, only the schema is asked for
        _make_routes(app)
        feeding = (
            asyncio.create_task(console.feed.run(_builder(console))),
            asyncio.create_task(
                console.rules_feed.run(console.link.rules, console.settings.robot_name)
            ),
            asyncio.create_task(console.sockets.run()),
            asyncio.create_task(console.webhooks.run(lambda: _builder(console)(0, 0))),
        )
        yield
        for task in feeding:
            task.cancel()
        await asyncio.gather(*feeding, return_exceptions=True)
        await asyncio.to_thread(console.auth.save)

    app = FastAPI(
        title="Kompass Console",
        version=VERSION,
        docs_url=None,
        redoc_url=None,
        openapi_url=None,
        lifespan=lifespan,
        separate_input_output_schemas=False,
        generate_unique_id_function=lambda route: route.name,
        responses={
            "default": {"model": ErrorAnswer, "description": "What and why, and what to do"}
        },
    )
    app.state.console = console
    for router in (
        session.router,
        scene.views,
        goals.router,
        missions.router,
        places.router,
        timeline.router,
        log.router,
        zones.router,
        measure.router,
        localisation.router,
        stop.router,
        control.router,
        hand.router,
        live.router,
        probe.router,
        rules.router,
        insight.router,
        backtests.router,
        drills.router,
        recordings.router,
        audit.router,
        flat_map.router,
        camera.router,
        scene.router,
    ):
        app.include_router(router)

    @app.get("/api/openapi.json", include_in_schema=False)
    def schema(_: LoggedIn) -> dict[str, Any]:
        return openapi(app)

    app.include_router(page.router)  # last: it takes every path that is left
    app.add_middleware(BodyText)
    app.add_middleware(BodyLimit)
    app.add_middleware(  # the last added is the first to see a request
        WebGuard, allow_hosts=() if console is None else console.settings.allow_hosts
    )
    if console is not None:
        app.add_middleware(AuditRequests, audit=console.audit)
    app.add_exception_handler(ConsoleError, _console_error)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(HTTPException, _http_error)
    app.add_exception_handler(ClientDisconnect, _gone)
    return app


def _make_routes(app: FastAPI) -> None:
    """FastAPI makes a route when a request first comes by it; a first STOP cannot wait for that."""
    scope = {"type": "http", "method": "GET", "path": "/", "root_path": "", "headers": []}
    for route in app.router.routes:
        route.matches(scope)


def openapi(app: FastAPI) -> dict[str, Any]:
    """The schema of all routes, with what websockets and unparsed bodies carry among its
    components."""
    schema = app.openapi()
    components = schema.setdefault("components", {}).setdefault("schemas", {})
    for model in _BESIDE_ROUTES:
        own = model.model_json_schema(ref_template="#/components/schemas/{model}")
        components.update(own.pop("$defs", {}))
        components[model.__name__] = own
    schema["components"]["schemas"] = dict(sorted(components.items()))
    return schema


def _builder(console: Console) -> Any:
    return lambda seq, viewers: build_state(
        seq,
        console.settings.robot_name,
        console.world,
        console.link,
        console.localisation,
        viewers,
        control=console.control.info(),
        audit_problem=console.audit.log.problem,
        webhook_problem=console.webhooks.problem,
    )


def _answer(
    status: int, title: str, remedy: str, headers: Mapping[str, str] | None = None
) -> Response:
    body = ErrorAnswer(detail=ErrorDetail(title=title, remedy=remedy))
    return JSONResponse(body.model_dump(), status, headers)


async def _console_error(_: Request, error: Exception) -> Response:
    assert isinstance(error, ConsoleError)
    return _answer(error.status_code, error.title, error.remedy, error.headers)


async def _invalid(_: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    return _answer(422, *told_invalid(error.errors()))


async def _http_error(_: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    return _answer(error.status_code, f"{error.detail}.", "Reload the page and try again.")


async def _gone(_: Request, error: Exception) -> Response:
    """Who left before the request was whole hears no answer; it is no failure of the console."""
    assert isinstance(error, ClientDisconnect)
    return Response(status_code=400)
