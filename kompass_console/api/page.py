"""The page itself: files that the build of `web/` left beside this package."""

from __future__ import annotations

from pathlib import Path

from fastapi import APIRouter, Response
from fastapi.responses import FileResponse

from kompass_console.api.access import CurrentConsole
from kompass_console.schema.plain import LONGEST_NAME, plain
from kompass_console.web.errors import ConsoleError

router = APIRouter(include_in_schema=False)

# The build names its assets by their content, so they may be kept; the page that names them not.
_KEEP = {"Cache-Control": "public, max-age=31536000, immutable"}


@router.get("/")
def page(console: CurrentConsole) -> Response:
    """The console's page; it logs in by itself."""
    index = console.settings.static_dir / "index.html"
    if not index.is_file():
        raise ConsoleError(
            503,
            "The page has not been built.",
            "Build it: npm ci && npm run build, in the folder web.",
        )
    return FileResponse(index, media_type="text/html")


@router.get("/{path:path}")
def asset(path: str, console: CurrentConsole) -> Response:
    """A file of the built page."""
    root = console.settings.static_dir.resolve()
    try:
        file = (root / path).resolve()
        found = file.is_relative_to(root) and file.is_file()
    except (OSError, ValueError):  # no file can have such a name
        found = False
    if not found:
        name = plain(Path(path).name, LONGEST_NAME)
        raise ConsoleError(404, f"There is no {name!r} here.", "Open the address /.")
    return FileResponse(file, headers=_KEEP if path.startswith("assets/") else None)
