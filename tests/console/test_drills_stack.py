"""A drill that is begun on a running robot drives what runs there, and ends with its console."""

from __future__ import annotations

import os
import signal
import uuid
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import httpx
import pytest

from tests.console.test_rules_stack import logged_in
from tests.support.processes import ended, marked, wait_until
from tests.support.stack import Stack

pytestmark = pytest.mark.ros

MARK = uuid.uuid4().hex
RECIPE = Path(__file__).parents[2] / "benchmarks" / "recipes" / "followed.py"


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    car = {"ROBOT": "ackermann", "FOLLOWER": "MPPI"}
    with closing(Stack.simulated(recipe=RECIPE, DRILLED_BY=MARK, **car)) as running:
        yield running


def processes() -> list[str]:
    """What a drill of this stack consists of."""
    found = marked(f"DRILLED_BY={MARK}")
    return [line for line in found if "kompass.drills" in line or "multiprocessing" in line]


def begin(client: httpx.Client, processes_up: int = 4) -> None:
    table = client.get("/api/rules").json()["table"]
    answer = client.post("/api/drills", json={"table": table, "faults": ["kill"], "drives": 50})
    assert answer.status_code == 202, answer.text
    wait_until(lambda: len(processes()) >= processes_up, 60.0, "the processes that make drives")


def test_the_console_of_a_recipe_drills_that_recipe_with_world_and_robot_at_hand(
    stack: Stack,
) -> None:
    with logged_in(stack, "Console") as client:
        room = client.get("/api/drills").json()
    assert room["refusal"] is None
    assert (room["recipe"], room["own_world"]) == (RECIPE.name, "hexagon")
    assert room["robot"] == "ackermann"


@pytest.mark.parametrize(
    ("processes_up", "number"),
    [
        pytest.param(3, signal.SIGKILL, id="killed while it imports"),
        pytest.param(4, signal.SIGKILL, id="killed while it drives"),
        pytest.param(4, signal.SIGTERM, id="ended while it drives"),
    ],
)
def test_nothing_of_a_drill_outlives_its_console(
    stack: Stack, processes_up: int, number: int
) -> None:
    with logged_in(stack, "Console") as client:
        begin(client, processes_up)
    os.kill(stack.pid_of("console"), number)
    assert ended(processes, 3.0) == []
    # The console comes back, and knows nothing of it.
    with logged_in(stack, "Console") as client:
        assert client.get("/api/drills").json()["newest"] is None


def test_nothing_of_a_drill_outlives_the_stack(stack: Stack) -> None:
    """The last test of the module: its stack ends."""
    with logged_in(stack, "Console") as client:
        begin(client)
    stack.close()
    assert ended(processes, 3.0) == []
