"""The browser that is installed on this machine, without a window, a GPU or the internet."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager

from playwright.sync_api import Browser, sync_playwright

FLAGS = [
    "--no-sandbox",
    # WebGL is drawn by the processor: a test machine has no GPU.
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    # All else is drawn by the processor at once, and not as if by a GPU that it plays, too: a page
    # without a scene takes a third less of it.
    "--disable-gpu-compositing",
    # What a browser does on its own account must not be taken for the page's doing.
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-quic",
    "--disable-sync",
    "--no-first-run",
]
_NAMES = ("chromium", "chromium-browser", "google-chrome")


def executable() -> str:
    """Path of the browser: ``KOMPASS_BROWSER``, else the first known one on the path.

    Raises RuntimeError when there is none.
    """
    named = os.environ.get("KOMPASS_BROWSER")
    found = named or next((path for name in _NAMES if (path := shutil.which(name))), None)
    if found is None:
        raise RuntimeError(
            f"no browser: none of {', '.join(_NAMES)} is on the path; install Chromium, "
            "or name one in KOMPASS_BROWSER"
        )
    return found


@contextmanager
def chromium() -> Iterator[Browser]:
    """A running browser, for as long as the block lasts."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable(), args=FLAGS)
        try:
            yield browser
        finally:
            browser.close()
