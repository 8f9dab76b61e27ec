"""Places: look, save, change, delete, restore. Going there is a goal, see `goals`."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query
from pydantic import ValidationError

from kompass.invalid import first_invalid
from kompass.places.change import DeletePlace, EditPlace, PlaceChange, RestorePlace, SavePlace
from kompass.places.place import MOST_PLACES, MapIdentity, Place, PlacePose
from kompass_console.api.access import CurrentConsole, LoggedIn, Operator
from kompass_console.api.monitor import kept, sentence
from kompass_console.link.goal_check import MESSAGES, cell_at, look_at_map
from kompass_console.schema.place_models import (
    PlaceEdit,
    PlaceInfo,
    PlaceKept,
    PlaceList,
    PlaceSave,
)
from kompass_console.web.auth import LoginSession
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/places", tags=["places"])

PlaceNumber = Annotated[int, Path(ge=1, le=2**53)]

_FRESH_POSE = 1.0  # s
_LOOK = "Look at the list of places as it is now, and try again."


@router.get("")
async def places(_: LoggedIn, console: CurrentConsole) -> PlaceList:
    """All places of the robot; `here` are those on the map that it has now."""
    watch = console.link.places
    here = await asyncio.to_thread(watch.here)
    book = watch.book
    return PlaceList(
        available=book is not None and book.available,
        revision=0 if book is None else book.revision,
        problem=_NOBODY_KEEPS if book is None else book.problem and sentence(book.problem),
        map=here,
        most=MOST_PLACES,
        places=[] if book is None else [_info(place, here) for place in book.places],
    )


@router.post("", status_code=201)
async def save_place(body: PlaceSave, session: Operator, console: CurrentConsole) -> PlaceKept:
    """Keep a place of the map that the robot has now; on the robot's disk when this is answered."""

    async def begin() -> PlaceChange:
        here = await map_of_now(console)
        pose = body.pose or _where_it_stands(console)
        _check_on_map(console, pose)
        return _made(SavePlace, name=body.name, note=body.note, pose=pose, map=here)

    kept = await _carry_out(console, session, "save place", begin, body.model_dump())
    return _with_warning(console, kept)


@router.patch("/{place_id}")
async def edit_place(
    place_id: PlaceNumber, body: PlaceEdit, session: Operator, console: CurrentConsole
) -> PlaceKept:
    """Rename a place, move it, write a note on it, or take it along to the map of now."""

    async def begin() -> PlaceChange:
        pose = _where_it_stands(console) if body.to_robot else body.pose
        here = await map_of_now(console) if body.here or pose else None
        if here is not None:
            place = _known(console, place_id)
            if not body.here and place.map.id != here.id:
                raise _elsewhere(place)
            _check_on_map(console, pose or place.pose)
        given = body.model_dump(include={"name", "note", "home"}, exclude_none=True)
        return _made(
            EditPlace,
            id=place_id,
            version=body.version,
            pose=pose,
            map=here if body.here else None,
            **given,
        )

    what = {"place": place_id, **body.model_dump(exclude_none=True)}
    return _with_warning(console, await _carry_out(console, session, "change place", begin, what))


@router.delete("/{place_id}")
async def delete_place(
    place_id: PlaceNumber,
    version: Annotated[int, Query(ge=1, le=2**53)],
    session: Operator,
    console: CurrentConsole,
) -> PlaceInfo:
    """Delete a place; the last ones that were deleted can be restored."""

    async def begin() -> PlaceChange:
        return DeletePlace(id=place_id, version=version)

    return await _carry_out(console, session, "delete place", begin, {"place": place_id})


@router.post("/{place_id}/restore")
async def restore_place(
    place_id: PlaceNumber, session: Operator, console: CurrentConsole
) -> PlaceInfo:
    """Bring a place back that was deleted."""

    async def begin() -> PlaceChange:
        return RestorePlace(id=place_id)

    return await _carry_out(console, session, "restore place", begin, {"place": place_id})


async def place_to_go(console: Console, place_id: int, version: int) -> Place:
    """A place that the robot may be sent to.

    Raises
    ------
    ConsoleError
        404 when there is none; 409 when it was changed since it was looked at, or is on another
        map than the robot has now.
    """
    place = _known(console, place_id)
    if place.version != version:
        raise ConsoleError(
            409,
            f"The place {place.name!r} was changed meanwhile, by {place.author or 'somebody'}.",
            _LOOK,
        )
    here = await map_of_now(console)
    if place.map.id != here.id:
        raise _elsewhere(place)
    return place


_NOBODY_KEEPS = "Nobody keeps places on this robot: its monitor has not told of any."


async def _carry_out(
    console: Console,
    session: LoginSession,
    what: str,
    begin: Callable[[], Any],
    details: dict[str, Any],
) -> PlaceInfo:
    """Have the monitor do it, and leave a line of it, however it ends."""
    known = console.link.places.find(details.get("place", 0))
    if known is not None:
        details["before"] = _brief(known)
    try:
        change: PlaceChange = await begin()
        place = await kept(
            console,
            lambda monitor: monitor.change_place(change, author=session.user, role=session.role),
            "places",
            _LOOK,
        )
    except ConsoleError as error:
        console.audit.record(session, what, error.title, **details)
        raise
    console.audit.record(session, what, "done", **details, after=_brief(place))
    return _info(place, await asyncio.to_thread(console.link.places.here))


def _made(kind: type[SavePlace] | type[EditPlace], **fields: Any) -> PlaceChange:
    try:
        return kind(**fields)
    except ValidationError as error:
        wrong = first_invalid(error)
        raise ConsoleError(
            422, f"The {wrong.where} cannot be {wrong.value!r:.60}.", sentence(wrong.text)
        ) from None


async def map_of_now(console: Console) -> MapIdentity:
    """The map that the robot has.

    Raises
    ------
    ConsoleError
        409 when it has none.
    """
    here = await asyncio.to_thread(console.link.places.here)
    if here is None:
        raise ConsoleError(
            409, "The robot has no map, and places are of a map.", "Load a map, then try again."
        )
    return here


def _where_it_stands(console: Console) -> PlacePose:
    motion = console.world.motion.get()
    if motion is None or motion.age() > _FRESH_POSE:
        raise ConsoleError(
            409,
            "Where the robot stands is not known now.",
            "Check its localization, or save a point of the map.",
        )
    pose = motion.value.pose
    return PlacePose(x=pose.x, y=pose.y, yaw=pose.yaw)


def _check_on_map(console: Console, pose: PlacePose) -> None:
    stamped = console.world.map.get()
    if stamped is not None and cell_at(stamped.value, pose.x, pose.y) is None:
        raise ConsoleError(
            422,
            f"The point x {pose.x:.2f}, y {pose.y:.2f} m is outside the map.",
            "Choose a point of the map.",
        )


def _with_warning(console: Console, place: PlaceInfo) -> PlaceKept:
    why = look_at_map(console.world, place.pose.x, place.pose.y) if place.here else ""
    warning = f"The robot could not be sent here now: {MESSAGES[why]}" if why else ""
    return PlaceKept(**place.model_dump(), warning=warning)


def _known(console: Console, place_id: int) -> Place:
    place = console.link.places.find(place_id)
    if place is None:
        raise ConsoleError(404, f"There is no place {place_id} any more.", _LOOK)
    return place


def _elsewhere(place: Place) -> ConsoleError:
    return ConsoleError(
        409,
        f"{place.name!r} is a place of another map ({place.map.label}) than the robot has now.",
        "Load that map, or take the place along to this one if it is the same room.",
    )


def _info(place: Place, here: MapIdentity | None) -> PlaceInfo:
    return PlaceInfo(
        here=here is not None and place.map.id == here.id,
        **{name: getattr(place, name) for name in Place.model_fields},
    )


def _brief(place: Place) -> dict[str, Any]:
    return place.model_dump(include={"name", "note", "pose", "home", "version"})
