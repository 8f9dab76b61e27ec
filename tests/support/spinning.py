"""An executor of rclpy in the test's own thread."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest
import rclpy

from kompass.rclpy_ext.executor import TaskExecutor
from kompass.rclpy_ext.node import PlainNode
from tests.support.domains import next_domain
from tests.support.patience import patient


class Spinning:
    """A node, and the executor that the test spins itself."""

    def __init__(self, node: PlainNode, executor: TaskExecutor) -> None:
        self.node, self.executor = node, executor

    def until(self, condition: Callable[[], object], timeout: float = 5.0) -> None:
        """Spin until a condition holds."""
        deadline = time.monotonic() + patient(timeout)
        while not condition():
            assert time.monotonic() < deadline, f"not within {patient(timeout):g} s"
            self.executor.spin_once(timeout_sec=0.02)

    def rest(self, seconds: float) -> None:
        """Spin for a while."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.02)


@contextmanager
def spinner() -> Iterator[Spinning]:
    """A node on a ROS domain of its own, with an executor that the test spins."""
    rclpy.init(args=[], domain_id=next_domain())
    node = PlainNode("tester")
    executor = TaskExecutor()
    executor.add_node(node)
    yield Spinning(node, executor)
    node.destroy_node()
    rclpy.shutdown()


@pytest.fixture(scope="module")
def spinning() -> Iterator[Spinning]:
    with spinner() as one:
        yield one
