"""A stack and a client for a module of tests; whoever needs another stack names its own so."""

from collections.abc import Iterator
from contextlib import closing

import pytest

from tests.support.robot import Robot
from tests.support.stack import Stack


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    """Recipe 01 with the embedded robot and the console."""
    with closing(Stack.simulated()) as running:
        yield running


@pytest.fixture(scope="module")
def robot(stack: Stack) -> Iterator[Robot]:
    """An independent client on the stack's domain, once the robot can be driven."""
    with closing(Robot(stack.domain)) as client:
        client.ready()
        yield client
