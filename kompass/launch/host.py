"""Inside a child: give components their nodes, make them active, and spin until told to end."""

import os
import signal
import threading

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

from kompass.components.component import Component
from kompass.components.node import ComponentNode
from kompass.launch.process import Report

TWIN_CHECK_DELAY = 1.0  # s in which DDS finds the other participants


class TerminationRequest:
    """SIGTERM as an event that a side thread can wait for.

    A Python signal handler only runs when the main thread executes Python, and that one waits
    inside the executor.
    """

    def __init__(self) -> None:
        self._read, write = os.pipe()
        os.set_blocking(write, False)
        signal.signal(signal.SIGTERM, lambda *_: None)
        signal.set_wakeup_fd(write, warn_on_full_buffer=False)

    def wait(self) -> None:
        """Block until the request comes."""
        while signal.SIGTERM not in os.read(self._read, 64):
            pass


def host(
    components: list[Component],
    activate: list[str],
    report: Report,
    *,
    namespace: str = "",
    first_start: bool = True,
) -> None:
    """Run components in this process until SIGTERM.

    Each has a node and an executor of its own, so that one that is busy does not hold up another.

    Parameters
    ----------
    components
        What to run.
    activate
        Names of those that become active at once; the others wait to be started.
    report
        Tells the supervisor.
    namespace
        ROS namespace of the nodes.
    first_start
        Look for the same nodes elsewhere on the domain. Not after a crash: DDS remembers the
        dead one for a while.
    """
    termination = TerminationRequest()
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    executors = []
    try:
        for component in components:
            node = component.create_node(namespace)
            executor = SingleThreadedExecutor()
            executor.add_node(node)
            executors.append(executor)
            if component.node_name in activate:
                node.trigger_configure()
                node.trigger_activate()
                if not component.health.is_healthy:
                    raise RuntimeError(f"{component.node_name}: {component.health.message}")
            if first_start:
                _watch_for_twin(node, report)
        report("active " + " ".join(component.node_name for component in components))
        _spin(executors, termination)
    finally:
        for component in components:
            component.leave()
        rclpy.shutdown()


def _watch_for_twin(node: ComponentNode, report: Report) -> None:
    """Tell the supervisor when another machine runs a node of the same name."""

    def look() -> None:
        timer.cancel()
        names = node.get_node_names_and_namespaces()
        if names.count((node.get_name(), node.get_namespace())) > 1:
            report(
                f"fatal another stack on this ROS domain already runs '{node.get_name()}'; "
                "stop it, or choose another domain with --domain-id"
            )

    timer = node.create_timer(TWIN_CHECK_DELAY, look)


def _spin(executors: list[SingleThreadedExecutor], termination: TerminationRequest) -> None:
    def end() -> None:
        termination.wait()
        for executor in executors:
            executor.shutdown(timeout_sec=0)

    threading.Thread(target=end, name="termination", daemon=True).start()
    others = [
        threading.Thread(target=executor.spin, name=f"executor-{index}")
        for index, executor in enumerate(executors[1:])
    ]
    for thread in others:
        thread.start()
    executors[0].spin()
    for thread in others:
        thread.join(timeout=1.0)
