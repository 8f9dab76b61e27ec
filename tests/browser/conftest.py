"""A stack and a browser for a module of tests; pages of its own for each test, or one for all."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.chromium import chromium
from tests.browser.console_page import ConsolePage
from tests.support.patience import patient
from tests.support.robot import Robot
from tests.support.running import robot, stack
from tests.support.stack import TOKEN, Stack

__all__ = ["browser", "drawn", "new_page", "page", "robot", "stack"]

OpenPage = Callable[..., ConsolePage]

# A busy machine without a GPU draws slowly; waiting longer costs nothing where it is fast.
expect.set_options(timeout=patient(10) * 1000)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """A browser, gone again before the module is asked for what it left behind."""
    with chromium() as running:
        yield running


@contextmanager
def opening(name: str, stack: Stack, robot: Robot, browser: Browser) -> Iterator[OpenPage]:
    """Makes pages, each as a browser that was never here; every one is pictured at the end."""
    made: list[ConsolePage] = []

    def make(width: int = 1120, height: int = 640, **options: Any) -> ConsolePage:
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        context.set_default_timeout(patient(30) * 1000)
        made.append(ConsolePage(context.new_page(), stack.url))
        return made[-1]

    yield make
    release_if_stopped(robot)
    wrong: list[str] = []
    for number, page in enumerate(made):
        page.keep(f"{name}-{number}" if number else name)
        wrong += page.errors + page.policy_violations()
        # Whoever goes without a word keeps control of the robot for a while.
        page.page.context.request.post(f"{stack.url}/api/logout", headers={"Origin": stack.url})
        page.page.context.close()
    assert not wrong, "the page's script failed, or tried what its content policy refuses"


def release_if_stopped(robot: Robot) -> None:
    """Of a test that failed half-way."""
    if robot.newest["/drive_state"].stopped:
        robot.release()


@pytest.fixture
def new_page(
    request: pytest.FixtureRequest, stack: Stack, robot: Robot, browser: Browser
) -> Iterator[OpenPage]:
    """Makes pages for one test."""
    with opening(request.node.name, stack, robot, browser) as make:
        yield make


@pytest.fixture(scope="module")
def drawn(
    request: pytest.FixtureRequest, stack: Stack, robot: Robot, browser: Browser
) -> Iterator[ConsolePage]:
    """An operator's page with its scene drawn: one for a module, for that takes a while."""
    with opening(Path(request.node.name).stem, stack, robot, browser) as make:
        opened = make()
        opened.open(TOKEN)
        yield opened


@pytest.fixture
def page(
    request: pytest.FixtureRequest, stack: Stack, drawn: ConsolePage, robot: Robot
) -> Iterator[ConsolePage]:
    """The page of the module, as the test before has left it."""
    yield drawn
    drawn.keep(request.node.name)
    release_if_stopped(robot)
    # Whoever drove keeps control of the robot; pages of the next test are other people's.
    drawn.page.context.request.post(f"{stack.url}/api/control/give", headers={"Origin": stack.url})
