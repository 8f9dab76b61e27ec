"""A stack and a browser for a module of tests; a page of its own for each test."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.chromium import chromium
from tests.browser.console_page import ConsolePage
from tests.support.robot import Robot
from tests.support.running import robot, stack
from tests.support.stack import TOKEN, Stack

__all__ = ["browser", "new_page", "page", "robot", "stack"]

OpenPage = Callable[..., ConsolePage]

# A busy machine without a GPU draws slowly; waiting longer costs nothing where it is fast.
expect.set_options(timeout=15_000)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """A browser, gone again before the module is asked for what it left behind."""
    with chromium() as running:
        yield running


@pytest.fixture
def new_page(
    request: pytest.FixtureRequest, stack: Stack, robot: Robot, browser: Browser
) -> Iterator[OpenPage]:
    """Makes pages, each as a browser that was never here; every one is pictured at the end."""
    made: list[ConsolePage] = []

    def make(width: int = 1120, height: int = 640, **options: Any) -> ConsolePage:
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        context.set_default_timeout(30_000)
        made.append(ConsolePage(context.new_page(), stack.url))
        return made[-1]

    yield make
    if robot.newest["/drive_state"].stopped:  # by a test that failed half-way
        robot.release()
    wrong: list[str] = []
    for number, page in enumerate(made):
        page.keep(f"{request.node.name}-{number}" if number else request.node.name)
        wrong += page.errors + page.policy_violations()
        page.page.context.close()
    assert not wrong, "the page's script failed, or tried what its content policy refuses"


@pytest.fixture
def page(new_page: OpenPage) -> ConsolePage:
    """An operator's page with its scene drawn."""
    opened = new_page()
    opened.open(TOKEN)
    return opened
