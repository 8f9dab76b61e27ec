"""How the processes of the stack are doing, on ``~/stack_state``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from builtin_interfaces.msg import Time
from kompass_interfaces.msg import ProcessState, StackState

from kompass.bus.node import Node
from kompass.monitor.reporting.status_proxy import StatusProxy
from kompass.rclpy_ext.topic import LATCHED
from kompass.supervisor.news import ProcessNews
from kompass.supervisor.usage import Usage

USAGE_PERIOD = 2.0  # s between looks at what processes take
Measure = Callable[[Iterable[int], float], Mapping[int, Usage]]
SILENT = ("stuck", "dead", "given up")  # states of a process whose components say nothing
_UNKNOWN = -1.0


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
    measure
        What processes take, by their ids, at a monotonic time; None where nobody can tell.
    """

    def __init__(
        self,
        node: Node,
        proxy: StatusProxy,
        ask: Callable[[str], None],
        stamp: Callable[[], Time],
        measure: Measure | None = None,
    ) -> None:
        self._clock, self._measure = node.clock, measure
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
            cpu=_UNKNOWN,
        )
        known = self._processes.get(process.name)
        if known is not None and known.pid == process.pid:
            process.cpu, process.memory = known.cpu, known.memory
        self._processes[process.name] = process
        self._publish()
        for component in process.nodes:
            if process.state in SILENT:
                self._proxy.begin(component, process.reason)
            elif process.state == "active":
                self._proxy.end(component)

    def look(self) -> None:
        """See what each takes; to be called every `USAGE_PERIOD`."""
        if self._measure is None or not self._processes:
            return
        pids = {process.pid for process in self._processes.values() if process.pid > 0}
        found = self._measure(pids, self._clock.monotonic())
        for process in self._processes.values():
            usage = found.get(process.pid)
            process.cpu = _UNKNOWN if usage is None or usage.cpu is None else usage.cpu
            process.memory = 0 if usage is None else usage.memory
        self._publish()

    def _publish(self) -> None:
        processes = [*self._processes.values()]
        self._publisher.publish(StackState(stamp=self._stamp(), processes=processes))

    def restart_if_stuck(self, component: str) -> bool:
        """Have the process of a component that hangs started anew; whether it hangs."""
        processes = self._processes.values()
        stuck = any(one.state == "stuck" and component in one.nodes for one in processes)
        if stuck:
            self._ask(f"restart {component}")
        return stuck
