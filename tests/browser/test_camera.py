"""What else a robot can show, on its page: its camera's picture, and layers of other topics."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import closing

import numpy as np
import pytest
from playwright.sync_api import Locator, expect

from kompass_console.scene.layers.extra import extra_colour
from kompass_console.scene.layers.palette import palette
from tests.browser.conftest import OpenPage
from tests.browser.console_page import UNCOVERED, ConsolePage
from tests.browser.test_accessibility import NO_SCENE, Judge
from tests.browser.test_small_screens import fits_a_thumb
from tests.support.processes import wait_until
from tests.support.stack import RECIPE, TOKEN, Stack

pytestmark = pytest.mark.browser

# Beside the first scan, which the page draws anyway; its own name for the points of the camera.
REAR, POINTS = "/rear_scan", "/camera/points"
_SHOWS = "(image) => image.complete && image.naturalWidth > 0"


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    """Recipe 09, with the robot that has several sensors and a camera."""
    recipe = RECIPE.with_name("09_several_sensors.py")
    with closing(Stack.simulated("--robot", "turtlebot3-plus", recipe=recipe)) as running:
        yield running


def picture_of(page: ConsolePage) -> Locator:
    """The camera's picture, once the browser has one."""
    picture = page.get("camera-picture")
    expect(picture).to_be_visible()
    wait_until(lambda: picture.evaluate(_SHOWS), 5, "a picture that the browser can show")
    return picture


def is_drawn(page: ConsolePage, topic: str) -> bool:
    """Whether anything on the page has the colour of a topic."""
    colour = np.array(extra_colour(topic, palette("light")))
    return int((np.abs(page.picture().astype(int) - colour).max(axis=2) <= 6).sum()) > 20


def test_the_camera_and_further_layers_are_shown_in_the_scene_when_they_are_asked_for(
    new_page: OpenPage,
) -> None:
    page = new_page(1280, 800)
    page.open(TOKEN)
    page.page.keyboard.press("c")
    small = picture_of(page).bounding_box()
    expect(page.get("camera-told")).to_have_text(re.compile(r"^\d\.\d s old$"))
    page.page.get_by_role("button", name="Larger picture").click()
    large = picture_of(page).bounding_box()
    assert small is not None
    assert large is not None
    assert large["width"] > 2 * small["width"]
    assert page.get("stop-button").evaluate(UNCOVERED)
    page.page.keyboard.press("Escape")
    expect(page.page.get_by_role("button", name="Larger picture")).to_be_visible()
    page.page.keyboard.press("Escape")
    expect(page.get("camera-card")).to_be_hidden()

    page.get("layers").click()
    assert not is_drawn(page, REAR)
    for topic in (REAR, POINTS):
        page.get(f"extra-{topic}").click()
    page.page.keyboard.press("Escape")
    wait_until(lambda: all(is_drawn(page, topic) for topic in (REAR, POINTS)), 10, "both layers")
    page.get("layers").click()
    expect(page.get(f"extra-{REAR}")).to_have_text(f"{REAR}Laser scan")
    page.get(f"extra-{REAR}").click()
    page.page.keyboard.press("Escape")
    wait_until(lambda: not is_drawn(page, REAR), 10, "no rear scan any more")


def test_on_a_phone_one_tap_shows_the_camera_and_leaves_stop_free(new_page: OpenPage) -> None:
    page = new_page(390, 844, has_touch=True, is_mobile=True)
    page.page.add_init_script("localStorage.setItem('kompass.scene', 'flat')")
    page.open_flat(TOKEN)
    page.get("camera-open").tap()
    picture_of(page)
    fits_a_thumb(page)
    assert page.get("stop-button").evaluate(UNCOVERED)
    page.page.get_by_role("button", name="Larger picture").tap()
    fits_a_thumb(page)
    assert page.get("stop-button").evaluate(UNCOVERED)
    large = picture_of(page).bounding_box()
    assert large is not None
    assert large["width"] > 340
    page.page.get_by_role("button", name="Close the camera").tap()
    page.get("layers").tap()
    page.get(f"extra-{REAR}").tap()
    fits_a_thumb(page)
    page.page.keyboard.press("Escape")
    wait_until(lambda: is_drawn(page, REAR), 10, "the rear scan on the flat map")


@pytest.mark.parametrize(
    ("width", "height", "theme"),
    [(1280, 800, "light"), (390, 844, "dark")],
    ids=["wide-light", "phone-dark"],
)
def test_axe_finds_nothing_wrong_with_camera_and_layers(
    new_page: OpenPage, width: int, height: int, theme: str
) -> None:
    page = new_page(width, height, color_scheme=theme, has_touch=width < 560, bypass_csp=True)
    page.page.route(
        "**/scene/**", lambda route: route.fulfill(body=NO_SCENE, content_type="text/html")
    )
    page.page.goto(f"{page.origin}/#token={TOKEN}")
    judge = Judge(page)
    judge("no camera yet", "camera-open")
    page.get("camera-open").click()
    picture_of(page)
    judge("small camera", "camera-picture")
    page.page.get_by_role("button", name="Larger picture").click()
    judge("large camera", "camera-picture")
    page.page.keyboard.press("c")
    page.get("layers").click()
    page.get(f"extra-{REAR}").click()
    judge("further layers", f"extra-{REAR}")
    assert judge.wrong == []
