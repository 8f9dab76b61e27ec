"""Recordings: what is kept of the flight recorder; keep more, take one along, delete one."""

from __future__ import annotations

import asyncio
from pathlib import PurePosixPath
from typing import Annotated

from fastapi import APIRouter, Path
from fastapi.responses import FileResponse

from kompass.recorder.places import SUFFIX
from kompass_console.api.access import CurrentConsole, Engineer, LoggedIn, Operator
from kompass_console.api.monitor import asked
from kompass_console.recordings import KeptRecording, Recordings
from kompass_console.schema.recording_models import (
    RecordingInfo,
    RecordingList,
    RecordingRequest,
    RecordingSaved,
    RingInfo,
)
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/recordings", tags=["recordings"])

RecordingName = Annotated[str, Path(max_length=255)]


@router.get("")
async def recordings(_: LoggedIn, console: CurrentConsole) -> RecordingList:
    """What is kept, and what could be."""
    found = console.recordings
    if found is None:
        return RecordingList(here=False, recordings=[], ring=None, free=0)
    try:
        return await asyncio.to_thread(_listed, found)
    except OSError as error:
        raise ConsoleError(
            503,
            f"The folder of recordings cannot be read: {error.strerror}.",
            f"Look at {found.folder} on the robot.",
        ) from error


@router.post("", status_code=201)
async def save_recording(
    body: RecordingRequest, session: Operator, console: CurrentConsole
) -> RecordingSaved:
    """Keep a stretch of the flight recorder, before its ring goes over it."""
    what, remedy = body.model_dump(), "Choose another name, or make room on the robot's disk."
    try:
        answer = await asked(
            console, lambda m: m.save_recording(body.seconds, body.name), 409, remedy
        )
    except ConsoleError as error:
        console.audit.record(session, "save recording", error.title, **what)
        raise
    console.audit.record(session, "save recording", "done", path=answer.path, **what)
    name = PurePosixPath(answer.path).name.removesuffix(SUFFIX)
    return RecordingSaved(name=name, path=answer.path, message=answer.message)


@router.get(
    "/{name}",
    response_class=FileResponse,
    responses={200: {"content": {"application/octet-stream": {}}, "description": "An MCAP file"}},
)
async def download_recording(
    name: RecordingName, session: Operator, console: CurrentConsole
) -> FileResponse:
    """The file itself, piece by piece as it is taken; parts of it by `Range`."""
    found = _here(console)
    path = await asyncio.to_thread(found.path, name)
    if path is None:
        console.audit.record(session, "download recording", "unknown", name=name)
        raise _unknown(name)
    console.audit.record(session, "download recording", "begun", name=name)
    return FileResponse(path, media_type="application/octet-stream", filename=path.name)


@router.delete("/{name}", status_code=204)
async def delete_recording(name: RecordingName, session: Engineer, console: CurrentConsole) -> None:
    """Delete a recording for good."""
    found = _here(console)
    try:
        done = await asyncio.to_thread(found.delete, name)
    except OSError as error:
        console.audit.record(session, "delete recording", f"{error.strerror}", name=name)
        raise ConsoleError(
            503,
            f"The recording cannot be deleted: {error.strerror}.",
            f"Look at {found.folder} on the robot.",
        ) from error
    outcome = "done" if done else "unknown"
    console.audit.record(session, "delete recording", outcome, name=name)
    if not done:
        raise _unknown(name)


def _here(console: Console) -> Recordings:
    if console.recordings is None:
        raise ConsoleError(
            409,
            "The recordings are on the robot, and this console runs on another machine.",
            "Open the console that runs with the robot, or copy the file from there.",
        )
    return console.recordings


def _listed(found: Recordings) -> RecordingList:
    rotating = found.rotating()
    return RecordingList(
        here=True,
        recordings=[_info(kept) for kept in found.kept()],
        ring=None if rotating is None else RingInfo(begin=rotating.begin, size=rotating.size),
        free=found.free(),
    )


def _info(kept: KeptRecording) -> RecordingInfo:
    return RecordingInfo(
        name=kept.name,
        saved=kept.saved,
        begin=kept.inside.begin or None,
        end=kept.inside.end or None,
        size=kept.size,
        messages=kept.inside.messages,
        of_firing=kept.of_firing,
        problem=kept.inside.problem,
    )


def _unknown(name: str) -> ConsoleError:
    return ConsoleError(
        404,
        f"There is no recording {name!r}.",
        "Load the list again: it was deleted, or went to make room for newer ones.",
    )
