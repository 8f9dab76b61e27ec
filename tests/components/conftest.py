"""Components that really run."""

from collections.abc import Callable, Iterator

import pytest

from kompass.components import Component
from tests.components.alive import Alive


@pytest.fixture
def run() -> Iterator[Callable[..., Alive]]:
    """Run a component until the end of the test."""
    running: list[Alive] = []

    def start(component: Component, *, activate: bool = True) -> Alive:
        running.append(Alive(component, activate=activate))
        return running[-1]

    yield start
    for one in running:
        one.close()
