"""Views, one browser page's scene each; viser's client and its websocket behind the same login."""

from __future__ import annotations

from fastapi import APIRouter, Response, WebSocket

from kompass_console.api.access import CurrentConsole, LoggedIn, console_of, session_of
from kompass_console.api.sockets import NOT_LOGGED_IN
from kompass_console.scene.client_page import SCENE_POLICY, scene_page
from kompass_console.schema.models import View, ViewPatch
from kompass_console.web.errors import ConsoleError

views = APIRouter(prefix="/api/views", tags=["views"])
router = APIRouter(include_in_schema=False)

_NO_SUCH_VIEW = 4404  # close code


def unknown_view() -> ConsoleError:
    """The answer for a view this console does not know (any more)."""
    return ConsoleError(
        404,
        "This console does not know the view: it was started again since the page was opened.",
        "Reload the page.",
    )


@views.post("")
def create_view(_: LoggedIn, console: CurrentConsole) -> View:
    """A new view, in the console's theme."""
    return console.views.create()


@views.patch("/{view_id}")
def change_view(view_id: str, patch: ViewPatch, _: LoggedIn, console: CurrentConsole) -> View:
    """Change how a view is shown."""
    view = console.views.patch(view_id, patch)
    if view is None:
        raise unknown_view()
    console.scene.apply(view)
    return view


@views.delete("/{view_id}/preview", status_code=204)
def clear_preview(view_id: str, _: LoggedIn, console: CurrentConsole) -> None:
    """Take the preview of a goal away from a view."""
    if console.views.get(view_id) is None:
        raise unknown_view()
    console.scene.preview(view_id, None)


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
