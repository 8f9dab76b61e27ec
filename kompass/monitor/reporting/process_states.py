"""How the processes of the stack are doing, on ``~/stack_state``."""

from __future__ import annotations

from collections.abc import Callable

from builtin_interfaces.msg import Time
from kompass_interfaces.msg import ProcessState, StackState

from kompass.bus.node import Node
from kompass.monitor.reporting.status_proxy import StatusProxy
from kompass.rclpy_ext.topic import LATCHED
from kompass.supervisor.news import ProcessNews

SILENT = ("stuck", "dead", "given up")  # states of a process whose components say nothing


class ProcessStates:
    """Passes on what the supervisor tells of processes, and asks it for restarts.

    Parameters
    ----------
    node
        Publishes.
    proxy
        Speaks for the components of a process that is silent.
    ask
        Takes a line for the supervisor.
    stamp
        The time of now, for messages.
    """

    def __init__(
        self,
        node: Node,
        proxy: StatusProxy,
        ask: Callable[[str], None],
        stamp: Callable[[], Time],
    ) -> None:
        self._proxy, self._ask, self._stamp = proxy, ask, stamp
        self._processes: dict[str, ProcessState] = {}
        self._publisher = node.create_publisher(
            StackState, f"{node.get_name()}/stack_state", LATCHED.to_ros()
        )

    def changed(self, news: ProcessNews) -> None:
        """Take the state of one process, as the supervisor tells it."""
        process = ProcessState(
            name=news.name,
            nodes=news.nodes,
            state=news.state,
            pid=news.pid,
            restarts=news.restarts,
            reason=news.reason,
        )
        self._processes[process.name] = process
        processes = [*self._processes.values()]
        self._publisher.publish(StackState(stamp=self._stamp(), processes=processes))
        for component in process.nodes:
            if process.state in SILENT:
                self._proxy.begin(component, process.reason)
            elif process.state == "active":
                self._proxy.end(component)

    def restart_if_stuck(self, component: str) -> bool:
        """Have the process of a component that hangs started anew; whether it hangs."""
        processes = self._processes.values()
        stuck = any(one.state == "stuck" and component in one.nodes for one in processes)
        if stuck:
            self._ask(f"restart {component}")
        return stuck
