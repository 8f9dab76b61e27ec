"""Keep-out and speed zones: look, draw, save, change, delete, restore."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
from fastapi import APIRouter, Path, Query
from pydantic import ValidationError

from kompass.invalid import first_invalid
from kompass.places.place import MapIdentity
from kompass.zones.change import DeleteZone, EditZone, RestoreZone, SaveZone, ZoneChange
from kompass.zones.in_force import Outlines
from kompass.zones.zone import MOST_ZONES, Zone, ZonePlan
from kompass_console.api.access import CurrentConsole, LoggedIn, Operator
from kompass_console.api.gesture import points_on_floor
from kompass_console.api.monitor import kept, sentence
from kompass_console.api.places import map_of_now
from kompass_console.link.goal_check import cell_at
from kompass_console.scene.layers.preview import Preview
from kompass_console.schema.zone_models import (
    MaskInfo,
    ZoneDrawn,
    ZoneEdit,
    ZoneInfo,
    ZoneList,
    ZoneSave,
    ZoneSketch,
)
from kompass_console.web.auth import LoginSession
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/zones", tags=["zones"])

ZoneNumber = Annotated[int, Path(ge=1, le=2**53)]

_LOOK = "Look at the list of zones as it is now, and try again."
_NOBODY_KEEPS = "Nobody keeps zones on this robot: its monitor has not told of any."
_FEW = "Set at least three corners."


@router.get("")
async def zones(_: LoggedIn, console: CurrentConsole) -> ZoneList:
    """All zones of the robot; those on the map that it has now are in force."""
    watch = console.link.zones
    here = await asyncio.to_thread(console.link.places.here)
    book = watch.book
    return ZoneList(
        available=book is not None and book.available,
        revision=0 if book is None else book.revision,
        problem=_NOBODY_KEEPS if book is None else book.problem and sentence(book.problem),
        map=here,
        most=MOST_ZONES,
        zones=[] if book is None else [_info(zone, here) for zone in book.zones],
        masks=[
            MaskInfo(
                name=mask.name,
                kind="keep_out" if mask.speed is None else "speed",
                speed=mask.speed,
                corners=list(mask.corners),
            )
            for mask in watch.masks
        ],
    )


@router.post("/sketch")
async def sketch_zone(body: ZoneSketch, session: Operator, console: CurrentConsole) -> ZoneDrawn:
    """What a zone looks like that is being drawn; it is shown on that view, and nothing is kept."""
    corners = list(body.corners)
    if body.view is not None and body.start is not None:
        found = await points_on_floor(body.view, body.start, body.end, session, console)
        if found is None:
            return _drawn(console, corners, "This is above the horizon; press the floor.")
        start, end = found
        corners += _rectangle(start, end) if not corners else [end or start]
    corners = [(round(x, 6), round(y, 6)) for x, y in corners]
    if body.view is not None and console.views.get(body.view, session) is not None:
        console.scene.preview(body.view, _outline(corners))
    here = await map_of_now(console)
    outside = next((each for each in corners if not _is_on_map(console, *each)), None)
    if outside is not None:
        problem = f"The corner ({outside[0]:z.2f}, {outside[1]:z.2f}) is outside the map."
    elif len(corners) < 3:
        problem = _FEW
    else:
        try:
            ZonePlan(name="drawn", kind="keep_out", corners=tuple(corners), map=here)
            problem = ""
        except ValidationError as error:
            problem = sentence(first_invalid(error).text)
    return _drawn(console, corners, problem)


@router.post("", status_code=201)
async def save_zone(body: ZoneSave, session: Operator, console: CurrentConsole) -> ZoneInfo:
    """Keep a zone of the map that the robot has now; in force, and on the robot's disk, when this
    is answered."""

    async def begin() -> ZoneChange:
        return SaveZone(plan=await _plan(console, body))

    return await _carry_out(console, session, "save zone", begin, body.model_dump())


@router.put("/{zone_id}")
async def edit_zone(
    zone_id: ZoneNumber, body: ZoneEdit, session: Operator, console: CurrentConsole
) -> ZoneInfo:
    """Change a zone of the map that the robot has now."""

    async def begin() -> ZoneChange:
        return EditZone(id=zone_id, version=body.version, plan=await _plan(console, body))

    return await _carry_out(
        console, session, "change zone", begin, {"zone": zone_id, **body.model_dump()}
    )


@router.delete("/{zone_id}")
async def delete_zone(
    zone_id: ZoneNumber,
    version: Annotated[int, Query(ge=1, le=2**53)],
    session: Operator,
    console: CurrentConsole,
) -> ZoneInfo:
    """Delete a zone; the last ones that were deleted can be restored."""

    async def begin() -> ZoneChange:
        return DeleteZone(id=zone_id, version=version)

    return await _carry_out(console, session, "delete zone", begin, {"zone": zone_id})


@router.post("/{zone_id}/restore")
async def restore_zone(zone_id: ZoneNumber, session: Operator, console: CurrentConsole) -> ZoneInfo:
    """Bring a zone back that was deleted; in force at once."""

    async def begin() -> ZoneChange:
        return RestoreZone(id=zone_id)

    return await _carry_out(console, session, "restore zone", begin, {"zone": zone_id})


async def _carry_out(
    console: Console,
    session: LoginSession,
    what: str,
    begin: Callable[[], Any],
    details: dict[str, Any],
) -> ZoneInfo:
    """Have the monitor do it, and leave a line of it, however it ends."""
    known = console.link.zones.find(details.get("zone", 0))
    if known is not None:
        details["before"] = _brief(known)
    try:
        change: ZoneChange = await begin()
        zone = await kept(
            console,
            lambda monitor: monitor.change_zone(change, author=session.user, role=session.role),
            "zones",
            _LOOK,
        )
    except ConsoleError as error:
        console.audit.record(session, what, error.title, **details)
        raise
    console.audit.record(session, what, "done", **details, after=_brief(zone))
    return _info(zone, await asyncio.to_thread(console.link.places.here))


async def _plan(console: Console, body: ZoneSave) -> ZonePlan:
    here = await map_of_now(console)
    outside = next((each for each in body.corners if not _is_on_map(console, *each)), None)
    if outside is not None:
        raise ConsoleError(
            422,
            f"The corner x {outside[0]:.2f}, y {outside[1]:.2f} m is outside the map.",
            "Choose a point of the map.",
        )
    try:
        return ZonePlan(
            name=body.name,
            kind=body.kind,
            speed=body.speed,
            corners=tuple(body.corners),
            map=here,
        )
    except ValidationError as error:
        wrong = first_invalid(error)
        what = (
            f"The {wrong.where} of the zone cannot be {wrong.value!r:.60}."
            if wrong.where
            else f"The zone {body.name!r:.60} cannot be like that."
        )
        raise ConsoleError(422, what, sentence(wrong.text)) from None


def _drawn(console: Console, corners: list[tuple[float, float]], problem: str) -> ZoneDrawn:
    """What a page shows of it, with who would be in it: a robot is got out by hand only."""
    whole = Outlines([corners] if not problem else [])
    motion, places = console.world.motion.get(), console.world.places.get()
    marks = () if places is None else places.value
    return ZoneDrawn(
        corners=corners,
        problem=problem,
        robot_inside=motion is not None and _holds(whole, motion.value.pose.x, motion.value.pose.y),
        places_inside=[mark.name for mark in marks if _holds(whole, mark.x, mark.y)],
    )


def _holds(outlines: Outlines, x: float, y: float) -> bool:
    return bool(outlines.inside(x, y).any())


def _rectangle(
    start: tuple[float, float], end: tuple[float, float] | None
) -> list[tuple[float, float]]:
    if end is None:
        return [start]
    return [start, (end[0], start[1]), end, (start[0], end[1])]


def _outline(corners: list[tuple[float, float]]) -> Preview | None:
    if not corners:
        return None
    return Preview(None, path=np.asarray([*corners, corners[0]]))


def _is_on_map(console: Console, x: float, y: float) -> bool:
    stamped = console.world.map.get()
    return stamped is None or cell_at(stamped.value, x, y) is not None


def _info(zone: Zone, here: MapIdentity | None) -> ZoneInfo:
    return ZoneInfo(
        here=here is not None and zone.map.id == here.id,
        **{name: getattr(zone, name) for name in ZoneInfo.model_fields if name != "here"},
    )


def _brief(zone: Zone) -> dict[str, Any]:
    return zone.model_dump(include={"name", "kind", "speed", "corners", "version"})
