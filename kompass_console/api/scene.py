"""The scene: viser's client for one view, and its websocket, behind the same login."""

from __future__ import annotations

from fastapi import APIRouter, Response, WebSocket

from kompass_console.api.access import CurrentConsole, LoggedIn, console_of, session_of
from kompass_console.api.sockets import NOT_LOGGED_IN
from kompass_console.api.views import unknown_view
from kompass_console.scene.client_page import SCENE_POLICY, scene_page
from kompass_console.web.errors import ConsoleError

router = APIRouter(include_in_schema=False)

_NO_SUCH_VIEW = 4404  # close code


@router.get("/scene/{view_id}/")
def scene(view_id: str, _: LoggedIn, console: CurrentConsole) -> Response:
    """The page for a view's frame."""
    if console.views.get(view_id) is None:
        raise unknown_view()
    headers = {"Content-Security-Policy": SCENE_POLICY}
    return Response(scene_page(), media_type="text/html", headers=headers)


@router.websocket("/scene/{view_id}")
async def scene_socket(websocket: WebSocket, view_id: str) -> None:
    """viser's protocol."""
    console = console_of(websocket)
    try:
        session_of(websocket)
    except ConsoleError as error:
        await websocket.close(NOT_LOGGED_IN, error.title)
        return
    if console.views.get(view_id) is None:
        await websocket.close(_NO_SUCH_VIEW, unknown_view().title)
        return
    await console.scene.hub.serve(websocket, view_id)
