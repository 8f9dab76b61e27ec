"""Missions: look, save, change, delete, restore; start one, and steer the one that runs."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query
from pydantic import ValidationError

from kompass.invalid import first_invalid
from kompass.missions.change import (
    DeleteMission,
    EditMission,
    MissionChange,
    RestoreMission,
    SaveMission,
    StartMission,
    StartNext,
    SteerRun,
    Unqueue,
)
from kompass.missions.mission import MOST_MISSIONS, Mission, MissionPlan
from kompass.places.place import MapIdentity
from kompass_console.api.access import CurrentConsole, LoggedIn, Operator
from kompass_console.api.monitor import kept, sentence
from kompass_console.api.places import map_of_now
from kompass_console.link.goal_check import STOPPED
from kompass_console.schema.mission_models import (
    MissionEdit,
    MissionInfo,
    MissionList,
    MissionSave,
    MissionVersion,
    RunStep,
    RunVerb,
)
from kompass_console.web.auth import LoginSession
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/missions", tags=["missions"])

MissionNumber = Annotated[int, Path(ge=1, le=2**53)]
Number = Annotated[int, Path(ge=1, le=2**53)]

_LOOK = "Look at the missions as they are now, and try again."
_NOBODY_KEEPS = "Nobody keeps missions on this robot: its monitor has not told of any."


@router.get("")
async def missions(_: LoggedIn, console: CurrentConsole) -> MissionList:
    """All missions of the robot; `here` are those on the map that it has now."""
    here = await asyncio.to_thread(console.link.places.here)
    book = console.link.missions.book
    return MissionList(
        available=book is not None and book.available,
        revision=0 if book is None else book.revision,
        problem=_NOBODY_KEEPS if book is None else book.problem and sentence(book.problem),
        map=here,
        most=MOST_MISSIONS,
        missions=[] if book is None else [_info(each, here) for each in book.missions],
    )


@router.post("", status_code=201)
async def save_mission(
    body: MissionSave, session: Operator, console: CurrentConsole
) -> MissionInfo:
    """Keep a mission on the map that the robot has now; on its disk when this is answered."""
    what = "save mission"
    plan = await _plan(console, session, what, body)
    return await _edited(console, session, what, SaveMission(plan=plan), body.name)


@router.put("/{mission_id}")
async def edit_mission(
    mission_id: MissionNumber, body: MissionEdit, session: Operator, console: CurrentConsole
) -> MissionInfo:
    """Change a mission; a run of it goes on as it began."""
    what = "change mission"
    plan = await _plan(console, session, what, body)
    change = EditMission(id=mission_id, version=body.version, plan=plan)
    return await _edited(console, session, what, change, body.name)


@router.delete("/{mission_id}")
async def delete_mission(
    mission_id: MissionNumber,
    version: Annotated[int, Query(ge=1, le=2**53)],
    session: Operator,
    console: CurrentConsole,
) -> MissionInfo:
    """Delete a mission; the last ones that were deleted can be restored."""
    change = DeleteMission(id=mission_id, version=version)
    return await _edited(console, session, "delete mission", change, mission_id)


@router.post("/{mission_id}/restore")
async def restore_mission(
    mission_id: MissionNumber, session: Operator, console: CurrentConsole
) -> MissionInfo:
    """Bring a mission back that was deleted."""
    change = RestoreMission(id=mission_id)
    return await _edited(console, session, "restore mission", change, mission_id)


@router.post("/{mission_id}/start")
async def start_mission(
    mission_id: MissionNumber, body: MissionVersion, session: Operator, console: CurrentConsole
) -> MissionInfo:
    """Begin a mission, or let it wait for its turn behind the one that runs."""
    _check_free(console, session, "start mission", mission_id)
    change = StartMission(
        id=mission_id, version=body.version, interruptions=console.link.drive.interruptions
    )
    return await _edited(console, session, "start mission", change, mission_id)


@router.post("/run/{number}/{verb}", status_code=204)
async def steer_mission(
    number: Number, verb: RunVerb, body: RunStep, session: Operator, console: CurrentConsole
) -> None:
    """Pause the run of that number, resume it, skip what it does, confirm what it asks, or cancel
    it."""
    what = f"{verb} mission"
    if verb == "resume":
        _check_free(console, session, what, number)
    elif verb == "skip":
        console.control.require(session, what, {"mission": number})
    run = console.link.missions.state.run
    name = run.mission.name if run is not None and run.number == number else number
    change = SteerRun(
        verb=verb, run=number, step=body.step, interruptions=console.link.drive.interruptions
    )
    await _carry_out(console, session, what, change, name)


@router.post("/queue/next", status_code=204)
async def start_next_mission(session: Operator, console: CurrentConsole) -> None:
    """Begin the first that waits, after one that was cancelled or has failed."""
    _check_free(console, session, "start next mission", None)
    change = StartNext(interruptions=console.link.drive.interruptions)
    await _carry_out(console, session, "start next mission", change, None)


@router.delete("/queue/{number}", status_code=204)
async def unqueue_mission(number: Number, session: Operator, console: CurrentConsole) -> None:
    """Take a mission out of the queue."""
    await _carry_out(console, session, "unqueue mission", Unqueue(number=number), number)


async def _plan(
    console: Console, session: LoginSession, what: str, body: MissionSave
) -> MissionPlan:
    try:
        here = await map_of_now(console)
        return MissionPlan(map=here, **body.model_dump(exclude={"version"}))
    except ValidationError as error:
        wrong = first_invalid(error)
        title = (
            f"The {wrong.where} cannot be {wrong.value!r:.60}."
            if wrong.where
            else (f"The mission {body.name:.60} cannot be like that.")
        )
        console.audit.record(session, what, title, mission=body.name)
        raise ConsoleError(422, title, sentence(wrong.text)) from None
    except ConsoleError as error:
        console.audit.record(session, what, error.title, mission=body.name)
        raise


def _check_free(console: Console, session: LoginSession, what: str, mission: object) -> None:
    """The robot is nobody's else: neither STOP nor a hand holds it, nor has another control.

    Raises
    ------
    ConsoleError
        409 when it is held.
    """
    drive = console.link.drive.info()
    error = None
    if drive is not None and drive.stopped:
        error = ConsoleError(409, STOPPED, "Release STOP when the way is clear, then try again.")
    elif drive is not None and drive.driven_by:
        error = ConsoleError(
            409, f"{drive.driven_by} drives by hand.", "Try again when the wheel has been given up."
        )
    if error is not None:
        console.audit.record(session, what, error.title, mission=mission)
        raise error
    console.control.require(session, what, {"mission": mission})


async def _edited(
    console: Console, session: LoginSession, what: str, change: MissionChange, name: object
) -> MissionInfo:
    mission = await _carry_out(console, session, what, change, name)
    if mission is None:
        raise ConsoleError(500, "The monitor did not say what became of the mission.", _LOOK)
    return _info(mission, await asyncio.to_thread(console.link.places.here))


async def _carry_out(
    console: Console, session: LoginSession, what: str, change: MissionChange, name: object
) -> Mission | None:
    """Have the monitor do it, and leave a line of it, however it ends."""
    details: dict[str, Any] = {"mission": name}
    before = console.link.missions.find(getattr(change, "id", 0))
    if before is not None:
        details["mission"], details["before"] = before.name, _brief(before)
    try:
        mission = await kept(
            console,
            lambda monitor: monitor.change_mission(change, author=session.user, role=session.role),
            "missions",
            _LOOK,
        )
    except ConsoleError as error:
        console.audit.record(session, what, error.title, **details)
        raise
    if mission is not None:
        details["after"] = _brief(mission)
    console.audit.record(session, what, "done", **details)
    return mission


def _info(mission: Mission, here: MapIdentity | None) -> MissionInfo:
    return MissionInfo(
        here=here is not None and mission.map.id == here.id,
        **{name: getattr(mission, name) for name in Mission.model_fields},
    )


def _brief(mission: Mission) -> dict[str, Any]:
    return mission.model_dump(
        mode="json", include={"name", "version", "waypoints", "rounds", "schedule"}
    )
