"""Drills: what a proposed table would make of faults, against the table in force."""

from __future__ import annotations

import asyncio
import re
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request, Response
from pydantic import ValidationError

from kompass.drills.draw import expand_faults
from kompass.drills.report_html import report_html
from kompass.drills.runner.recorded_drive import NoScenario, scenario_of
from kompass.drills.scenario import Scenario
from kompass.drills.scenario_file import BadScenario, parse_scenario, scenario_text
from kompass.invalid import first_invalid
from kompass.recorder.mcap.contents import NotMcap
from kompass.rules.schema.table import Table
from kompass.simulation.faults.fault_names import (
    AT_ONCE,
    FAULTS,
    MACHINE_FAULTS,
    NEEDS_CAMERA,
    UnknownFault,
)
from kompass.simulation.faults.fault_parameters import PARAMETERS, WHEELS
from kompass.simulation.physics.robot_model import RobotModel
from kompass.simulation.worlds.registry import world, world_names
from kompass_console.api.access import CurrentConsole, LoggedIn, Operator
from kompass_console.api.monitor import asked, body_of, read_table, refusal, sentence
from kompass_console.drills.drills import Busy, CannotDrill, place_of
from kompass_console.schema.drill_models import (
    MOST_DRIVES,
    DrillFault,
    DrillOptions,
    DrillPair,
    DrillPlace,
    DrillProgress,
    DrillRequest,
    DrillRoom,
    DrillStarted,
    DrillWorld,
    RecordedScenario,
)
from kompass_console.schema.rule_models import RefusedAnswer
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api", tags=["drills"])

DrillId = Annotated[str, Path(max_length=100)]
ScenarioName = Annotated[str, Path(max_length=100)]
WorldName = Annotated[str, Path(max_length=100)]
RecordingName = Annotated[str, Path(max_length=200)]
Moment = Annotated[float | None, Query(ge=0, le=1e9, allow_inf_nan=False)]

_MEND = "Correct what the findings name, and drill again."
_REFUSED: dict[int | str, dict[str, Any]] = {
    422: {"model": RefusedAnswer, "description": "The table has errors"}
}


@router.get("/drills")
def drill_room(_: LoggedIn, console: CurrentConsole) -> DrillRoom:
    """Whether there are drills here, which faults and worlds there are, and the newest drill."""
    _notice(console)
    refused = console.drills.refusal
    return DrillRoom(
        refusal=None if refused is None else str(refused),
        remedy="" if refused is None else refused.remedy,
        recipe=console.drills.recipe,
        own_world=console.drills.own_world,
        robot=console.drills.robot.name,
        worlds=[DrillWorld(name=name, title=world(name).title) for name in world_names()],
        faults=[
            _fault(name, text)
            for name, text in (FAULTS | MACHINE_FAULTS).items()
            if console.drills.robot.camera is not None or name not in NEEDS_CAMERA
        ],
        most_drives=MOST_DRIVES,
        newest=console.drills.newest,
    )


@router.post(
    "/drills",
    status_code=202,
    responses=_REFUSED,
    openapi_extra=body_of(DrillRequest),
    response_model=DrillStarted,
)
async def start_drill(
    request: Request, session: Operator, console: CurrentConsole
) -> Response | DrillStarted:
    """Begin to try a table against the one in force; ask for its progress by the id."""
    text, options = await read_table(request, DrillOptions, "Correct it, and drill again.")
    what = options.model_dump(exclude={"scenario"})
    if options.scenario is not None:
        what = {"scenario": options.scenario.name, "drives": options.drives, "seed": options.seed}

    def refuse(error: ConsoleError) -> ConsoleError:
        console.audit.record(session, "drill", error.title, **what)
        return error

    if (unknown := _unknown_name(options, console.drills.robot)) is not None:
        raise refuse(unknown)
    try:
        remedy = "Correct the table and drill again."
        checked = await asked(console, lambda m: m.check(text, session.role), 422, remedy)
        answer = await asked(console, lambda m: m.table(), 404, "Load the rules again.")
        report, in_force = checked.parsed(), answer.parsed()
    except ConsoleError as error:
        raise refuse(error) from None
    except ValidationError as error:
        raise refuse(
            ConsoleError(
                502, f"What the monitor says cannot be read: {error.title}.", "Update both alike."
            )
        ) from error
    if not report.ok:
        console.audit.record(session, "drill", "the table has errors", **what)
        return refusal(422, "The rules have errors.", _MEND, "report", checked)
    try:
        proposed = Table.model_validate_json(text)
    except ValidationError as error:
        wrong = first_invalid(error)
        title = f"The table cannot be read: {wrong.where}: {wrong.text}."
        raise refuse(ConsoleError(422, title, remedy)) from None
    try:
        drill = console.drills.start(
            options,
            proposed=proposed,
            in_force=in_force.table,
            revision=report.revision,
            by=session.user,
            session=session.id,
        )
    except CannotDrill as error:
        raise refuse(ConsoleError(409, str(error), error.remedy)) from error
    except Busy as error:
        raise refuse(ConsoleError(429, str(error), "Wait until it has ended, or cancel it.")) from (
            error
        )
    console.audit.record(session, "drill", "started", id=drill, revision=report.revision, **what)
    return DrillStarted(id=drill)


@router.get("/drills/worlds/{name}")
def drill_world(name: WorldName, _: LoggedIn) -> DrillPlace:
    """A world from above, to choose places in."""
    if name not in world_names():
        raise _unknown_world(name)
    return place_of(name)


@router.post(
    "/drills/scenarios",
    openapi_extra={
        "requestBody": {"required": True, "content": {"text/plain": {"schema": {"type": "string"}}}}
    },
)
async def read_scenario_file(request: Request, _: Operator) -> Scenario:
    """The scenario of a YAML file."""
    raw = await request.body()
    try:
        return await asyncio.to_thread(parse_scenario, raw.decode("utf-8"), "the file")
    except UnicodeDecodeError as error:
        why = f"byte {error.start} is not UTF-8"
    except BadScenario as error:
        why = str(error.problems[0])
    raise ConsoleError(
        422, f"The file is no scenario: {why}.", "Correct it there, and choose it again."
    )


@router.get("/drills/scenarios/recorded/{recording}")
async def recorded_scenario(
    recording: RecordingName,
    _: Operator,
    console: CurrentConsole,
    begin: Moment = None,
    end: Moment = None,
) -> RecordedScenario:
    """What a kept recording becomes as a scenario: start, goals, and what broke.

    ``begin`` and ``end`` are seconds since its own beginning, for a stretch of it.
    """
    path = None
    if console.recordings is not None:
        path = await asyncio.to_thread(console.recordings.path, recording)
    if path is None:
        raise ConsoleError(
            404, f"There is no recording {recording!r} here.", "Choose another, or make one."
        )
    try:
        found = await asyncio.to_thread(scenario_of, path, recording, begin, end)
    except (NoScenario, NotMcap) as error:
        why = str(error)
    except ValidationError as error:
        wrong = first_invalid(error)
        why = f"{wrong.where}: {wrong.text}"
    else:
        return RecordedScenario(
            scenario=found.scenario, sentence=found.sentence, remarks=list(found.remarks)
        )
    raise ConsoleError(
        422,
        f"No scenario can be made of {recording}: {why}.",
        "Choose another recording, or another stretch of it.",
    )


@router.get("/drills/{drill_id}")
def drill(drill_id: DrillId, _: LoggedIn, console: CurrentConsole) -> DrillProgress:
    """How far it is, and what it came to when it is done."""
    _notice(console)
    progress = console.drills.progress(drill_id)
    if progress is None:
        raise unknown_drill()
    return progress


@router.get("/drills/{drill_id}/drives/{scenario:path}")
def drill_drive(
    drill_id: DrillId, scenario: ScenarioName, _: LoggedIn, console: CurrentConsole
) -> DrillPair:
    """A scenario's drives under both tables, from beginning to end."""
    pair = console.drills.pair(drill_id, scenario)
    if pair is None:
        raise _without_result(console, drill_id)
    return pair


@router.get("/drills/{drill_id}/files/{scenario:path}", response_class=Response)
def drill_scenario(
    drill_id: DrillId, scenario: ScenarioName, _: LoggedIn, console: CurrentConsole
) -> Response:
    """The scenario of a drive as a file, to be kept and driven again."""
    pair = console.drills.pair(drill_id, scenario)
    if pair is None:
        raise _without_result(console, drill_id)
    made = pair.proposed.scenario
    # What a person has called it is no name of a file everywhere.
    name = re.sub(r"[^A-Za-z0-9]+", "-", f"{made.world} {made.name}").strip("-")
    headers = {"Content-Disposition": f'attachment; filename="{name}.yaml"'}
    text = scenario_text(made)
    return Response(text, media_type="application/yaml", headers=headers)


@router.get("/drills/{drill_id}/report", response_class=Response)
def drill_report(drill_id: DrillId, _: LoggedIn, console: CurrentConsole) -> Response:
    """All of it as one page to send around."""
    report = console.drills.report(drill_id)
    if report is None:
        raise _without_result(console, drill_id)
    headers = {"Content-Disposition": f'attachment; filename="drill-{report.seed}.html"'}
    return Response(report_html(report), media_type="text/html", headers=headers)


@router.delete("/drills/{drill_id}", status_code=204)
def cancel_drill(drill_id: DrillId, session: Operator, console: CurrentConsole) -> None:
    """Cancel it; of one that has ended, forget what came of it."""
    done = console.drills.cancel(drill_id, f"{session.user} cancelled it.")
    outcome = "done" if done else "unknown"
    console.audit.record(session, "cancel drill", outcome, id=drill_id)
    if not done:
        raise unknown_drill()


def _notice(console: Console) -> None:
    """Somebody may have changed the rules past this console."""
    said = console.link.rules.info()
    if said.available:
        console.drills.overtaken(said.revision)


def _unknown_name(options: DrillOptions, robot: RobotModel) -> ConsoleError | None:
    """Why worlds or faults cannot be drawn from."""
    if options.world is not None and options.world not in world_names():
        return _unknown_world(options.world)
    try:
        expand_faults(options.faults, (), robot.name)  # whose they are, only the recipe knows
    except UnknownFault as error:
        return ConsoleError(422, sentence(str(error)), "Choose other faults.")
    return None


def _unknown_world(name: str) -> ConsoleError:
    known = ", ".join(world_names())
    return ConsoleError(422, f"There is no world {name!r}.", f"Choose one of {known}.")


def _fault(whole: str, text: str) -> DrillFault:
    name, _, parameter = whole.partition(":")
    return DrillFault(
        name=name,
        text=text,
        parameter=parameter,
        example=PARAMETERS[name].example if parameter else "",
        choices=list(WHEELS) if parameter == "WHEEL" else [],
        at_once=f"{name}:" == AT_ONCE,
    )


def _without_result(console: Console, drill_id: str) -> ConsoleError:
    """Why there is no result, or none of this drive."""
    told = console.drills.progress(drill_id)
    if told is not None and told.state == "running":
        return ConsoleError(409, "This drill has not come to its end yet.", "Wait until it has.")
    return unknown_drill()


def unknown_drill() -> ConsoleError:
    """The answer for a drill or a drive that this console does not know."""
    return ConsoleError(
        404,
        "This console does not know the drill, or it has not come to an end: it was started again, "
        "or the report is old.",
        "Drill again.",
    )
