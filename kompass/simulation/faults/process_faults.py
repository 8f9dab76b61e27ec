"""Faults of the stack's processes: stopped, as one that hangs, or killed."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterable
from pathlib import Path

from kompass_interfaces.msg import ProcessState, StackState

from kompass.bus.node import Node
from kompass.rclpy_ext.qos import LATCHED_PROFILE
from kompass.simulation.faults.fault_manager import FaultRefused, NotYet
from kompass.simulation.faults.fault_names import SIGNALLED

TOPIC = "monitor/stack_state"
_GONE = ("dead", "given up")


class ProcessFaults:
    """Signals processes by the names that the stack's supervisor gives them.

    The names and process ids come over ROS, from whoever publishes them. So only siblings of this
    process are touched: what the same supervisor has forked.

    Parameters
    ----------
    node
        Of the simulator.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._processes: list[ProcessState] = []
        self._stopped: dict[str, int] = {}  # pidfds, which a later process cannot be mistaken for
        node.create_subscription(StackState, TOPIC, self._on_stack_state, LATCHED_PROFILE)

    def knows(self, name: str) -> bool:
        return name.partition(":")[0] in SIGNALLED

    def begin(self, name: str) -> bool:
        kind, _, target = name.partition(":")
        process = self._find(target)
        if kind == "stop" and process.pid == os.getpid():
            raise FaultRefused(
                "the simulator itself cannot be stopped: nobody could end that fault"
            )
        descriptor = os.pidfd_open(process.pid)
        number = signal.SIGKILL if kind == "kill" else signal.SIGSTOP
        signal.pidfd_send_signal(descriptor, number)
        self._node.get_logger().warning(f"{number.name} to {process.name}, process {process.pid}")
        if kind == "kill":
            os.close(descriptor)
            return False
        self._stopped[name] = descriptor
        return True

    def end(self, name: str) -> None:
        descriptor = self._stopped.pop(name)
        try:
            signal.pidfd_send_signal(descriptor, signal.SIGCONT)
        except ProcessLookupError:
            # Its supervisor has lost patience and put a new one in its place.
            self._node.get_logger().info(f"{name}: that process has ended meanwhile")
        finally:
            os.close(descriptor)

    def ended(self) -> Iterable[str]:
        return ()

    def _on_stack_state(self, message: StackState) -> None:
        self._processes = list(message.processes)

    def _find(self, target: str) -> ProcessState:
        for process in self._processes:
            if target in (process.name, *process.nodes) and process.state not in _GONE:
                if _parent(process.pid) != os.getppid():
                    raise FaultRefused(
                        f"{target} is process {process.pid}, which was not started together with "
                        "this simulator; signal it yourself"
                    )
                return process
        known = ", ".join(process.name for process in self._processes) or "none yet"
        raise NotYet(f"no process {target!r} is running; known are {known}")


def _parent(pid: int) -> int:
    """The parent of a process; 0 when there is no such process."""
    try:
        return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
    except FileNotFoundError:
        return 0
