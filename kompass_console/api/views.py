"""Views: one browser page's scene each."""

from __future__ import annotations

from fastapi import APIRouter

from kompass_console.api.access import CurrentConsole, LoggedIn
from kompass_console.schema.models import View, ViewPatch
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/views", tags=["views"])


def unknown_view() -> ConsoleError:
    """The answer for a view this console does not know (any more)."""
    return ConsoleError(
        404,
        "This console does not know the view: it was started again since the page was opened.",
        "Reload the page.",
    )


@router.post("")
def create_view(_: LoggedIn, console: CurrentConsole) -> View:
    """A new view, in the console's theme."""
    return console.views.create()


@router.patch("/{view_id}")
def change_view(view_id: str, patch: ViewPatch, _: LoggedIn, console: CurrentConsole) -> View:
    """Change how a view is shown."""
    view = console.views.patch(view_id, patch)
    if view is None:
        raise unknown_view()
    console.scene.apply(view)
    return view


@router.delete("/{view_id}/preview", status_code=204)
def clear_preview(view_id: str, _: LoggedIn, console: CurrentConsole) -> None:
    """Take the preview of a goal away from a view."""
    if console.views.get(view_id) is None:
        raise unknown_view()
    console.scene.preview(view_id, None)
