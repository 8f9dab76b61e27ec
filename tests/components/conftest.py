"""Components that really run."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from kompass.components import Component
from tests.components.alive import Alive, OnDds, Virtual


@pytest.fixture(autouse=True)
def data_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the robot of a test keeps its data: a STOP must not outlive the test."""
    monkeypatch.setenv("KOMPASS_DATA_DIR", str(tmp_path))
    monkeypatch.setenv("KOMPASS_ROBOT_NAME", "tested")
    return tmp_path / "tested"


@pytest.fixture
def run_on_dds() -> Iterator[Callable[..., Alive]]:
    """Run a component on DDS until the end of the test."""
    yield from _running(OnDds)


@pytest.fixture
def run() -> Iterator[Callable[..., Alive]]:
    """Run a component in virtual time until the end of the test."""
    yield from _running(Virtual)


def _running(kind: Callable[..., Alive]) -> Iterator[Callable[..., Alive]]:
    running: list[Alive] = []

    def start(component: Component, **how: bool) -> Alive:
        running.append(kind(component, **how))
        return running[-1]

    yield start
    for one in running:
        one.close()
