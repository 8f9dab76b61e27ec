"""One running stack for a module of tests."""

from collections.abc import Iterator

import pytest

from tests.support.robot import Robot
from tests.support.stack import Stack


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    """Recipe 01 with the embedded robot and the console."""
    running = Stack.simulated()
    try:
        yield running
    finally:
        running.close()


@pytest.fixture(scope="module")
def robot(stack: Stack) -> Iterator[Robot]:
    """An independent client on the stack's domain."""
    client = Robot(stack.domain)
    try:
        client.ready()
        yield client
    finally:
        client.close()
