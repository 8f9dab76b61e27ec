"""Views, one browser page's scene each; viser's client and its websocket behind the same login."""

from __future__ import annotations

import contextlib

from fastapi import APIRouter, Response, WebSocket, WebSocketDisconnect
from starlette.concurrency import run_in_threadpool

from kompass_console.api.access import CurrentConsole, LoggedIn, console_of
from kompass_console.api.drills import unknown_drill
from kompass_console.api.sockets import Pace, admitted
from kompass_console.scene.client_page import SCENE_POLICY, scene_page
from kompass_console.scene.drive_drawing import drive_drawing
from kompass_console.scene.scene import PageNotConnected
from kompass_console.scene.viser_hub import SUBPROTOCOL
from kompass_console.schema.drill_models import PlayedDrive
from kompass_console.schema.models import View, ViewPatch
from kompass_console.web.errors import ConsoleError

views = APIRouter(prefix="/api/views", tags=["views"])
router = APIRouter(include_in_schema=False)

_NO_SUCH_PROTOCOL = 4400  # close codes
_NO_SUCH_VIEW = 4404
_SCENE_ENDED = 1011

_CAMERAS = (60.0, 300)  # a second, and at once: viser's client sends 20 while it is moved


def unknown_view() -> ConsoleError:
    """The answer for a view this console does not know (any more)."""
    return ConsoleError(
        404,
        "This console does not know the view: it or your session began anew since the page was "
        "opened.",
        "Reload the page.",
    )


@views.post("")
def create_view(session: LoggedIn, console: CurrentConsole) -> View:
    """A new view, in the console's theme."""
    return console.views.create(session)


@views.patch("/{view_id}")
def change_view(view_id: str, patch: ViewPatch, session: LoggedIn, console: CurrentConsole) -> View:
    """Change how a view is shown."""
    view = console.views.patch(view_id, session, patch)
    if view is None:
        raise unknown_view()
    console.scene.apply(view)
    return view


@views.delete("/{view_id}/preview", status_code=204)
def clear_preview(view_id: str, session: LoggedIn, console: CurrentConsole) -> None:
    """Take the preview of a goal away from a view."""
    if console.views.get(view_id, session) is None:
        raise unknown_view()
    console.scene.preview(view_id, None)


@views.put("/{view_id}/drive", status_code=204)
async def play_drive(
    view_id: str, played: PlayedDrive, session: LoggedIn, console: CurrentConsole
) -> None:
    """Show a scenario of a drill in a view, in the place of the robot.

    It goes on by itself from there; a view that is not told so again for 10 s shows the robot.
    """
    if console.views.get(view_id, session) is None:
        raise unknown_view()
    pair = console.drills.pair(played.drill, played.scenario)
    if pair is None:
        raise unknown_drill()
    drive = await run_in_threadpool(drive_drawing, played.drill, pair.proposed, pair.in_force)
    try:
        await console.scene.play(view_id, drive, played.moment, played.speed)
    except PageNotConnected as error:
        raise ConsoleError(
            409, "The scene is not connected.", "Wait until it is drawn, or look at the map."
        ) from error


@views.delete("/{view_id}/drive", status_code=204)
async def leave_drive(view_id: str, session: LoggedIn, console: CurrentConsole) -> None:
    """Show the robot in a view again."""
    if console.views.get(view_id, session) is None:
        raise unknown_view()
    await console.scene.leave(view_id)


@router.get("/scene/{view_id}/")
def scene(view_id: str, session: LoggedIn, console: CurrentConsole) -> Response:
    """The page for a view's frame."""
    if console.views.get(view_id, session) is None:
        raise unknown_view()
    headers = {"Content-Security-Policy": SCENE_POLICY}
    return Response(scene_page(), media_type="text/html", headers=headers)


@router.websocket("/scene/{view_id}")
async def scene_socket(websocket: WebSocket, view_id: str) -> None:
    """viser's protocol."""
    if SUBPROTOCOL not in websocket.scope.get("subprotocols", []):
        await websocket.close(_NO_SUCH_PROTOCOL, "This address speaks viser's protocol only.")
        return
    async with admitted(websocket) as session:
        if session is None:
            return
        console = console_of(websocket)
        if console.views.get(view_id, session) is None:
            await websocket.close(_NO_SUCH_VIEW, unknown_view().title)
            return
        await websocket.accept(subprotocol=SUBPROTOCOL)
        await console.scene.hub.serve(websocket, view_id, Pace(*_CAMERAS).allows)
        with contextlib.suppress(WebSocketDisconnect, RuntimeError):  # the page may have closed it
            await websocket.close(_SCENE_ENDED, "The scene has ended; connect again.")
