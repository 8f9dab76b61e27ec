"""In a real browser: a press means the place that is drawn there."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import BrowserContext, Page, sync_playwright

from kompass_console.scene.layers.palette import palette
from kompass_console.schema.roles import Role
from tests.console.conftest import TOKENS, Served, running_stack
from tests.console.fake_stack import ROOM
from tests.support.processes import wait_until

pytestmark = [pytest.mark.ros, pytest.mark.browser]

WIDTH, HEIGHT = 900, 600
# No GPU on a test machine: WebGL is drawn by the processor.
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


@pytest.fixture(scope="module")
def context() -> Iterator[BrowserContext]:
    installed = Path("/usr/bin/chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=installed if installed.exists() else None, args=FLAGS
        )
        yield browser.new_context(viewport={"width": WIDTH, "height": HEIGHT})
        browser.close()


def pixels(page: Page) -> np.ndarray:
    return np.array(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(int)


def free_floor(page: Page) -> np.ndarray:
    """Pixels (N, 2) of (x, y) with the colour of free floor."""
    free = np.array(palette("light").free[:3])
    rows, columns = np.nonzero(np.abs(pixels(page) - free).max(axis=2) < 3)
    return np.column_stack([columns, rows])


def test_a_press_on_a_corner_of_the_room_is_that_corner(
    console: Served, context: BrowserContext
) -> None:
    with running_stack():
        api = context.request
        headers = {"Origin": console.origin}

        def post(path: str, body: object = None) -> dict[str, object]:
            answer = api.post(console.origin + path, data=body or {}, headers=headers)
            assert answer.ok, answer.text()
            return dict(answer.json())

        post("/api/login", {"token": TOKENS[Role.OPERATOR], "user": "ava"})
        view = str(post("/api/views")["id"])
        page = context.new_page()
        page.goto(f"{console.origin}/scene/{view}/")
        wait_until(lambda: len(free_floor(page)) > 20_000, 30.0, "the map is drawn")
        x0, _, x1, y1 = ROOM

        def corners() -> list[tuple[object, object]]:
            floor = free_floor(page)
            north = floor[floor[:, 1] < floor[:, 1].min() + 3]
            picked = []
            # The far wall stands behind the floor, so both its corners can be seen.
            for pixel in (north[north[:, 0].argmin()], north[north[:, 0].argmax()]):
                start = [float(pixel[0]) / WIDTH, float(pixel[1]) / HEIGHT]
                check = post("/api/goals/check", {"view": view, "start": start})
                picked.append((check["x"], check["y"]))
            return picked

        expected = [pytest.approx((x, y1), abs=0.08) for x in (x0, x1)]
        for top in (False, True):
            body = {"top": top}
            assert api.patch(f"{console.origin}/api/views/{view}", data=body, headers=headers).ok
            wait_until(lambda: corners() == expected, 5.0, f"the corners, top={top}")
