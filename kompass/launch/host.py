"""Inside a child: give components their nodes, make them active, and spin until told to end."""

import os
import signal
import threading
from collections.abc import Mapping
from functools import partial
from typing import Any

import rclpy
from rclpy.signals import SignalHandlerOptions

from kompass.bus.node import LifecycleNode, MakeNode
from kompass.components.base.component import Component
from kompass.components.base.node import ComponentNode
from kompass.launch.answering import answer_over
from kompass.rclpy_ext.executor import TaskExecutor
from kompass.supervisor.desired_state import DesiredState
from kompass.supervisor.heartbeat import send_heartbeat
from kompass.supervisor.news import ProcessNews
from kompass.supervisor.process import Report

TWIN_CHECK_DELAY = 1.0  # s in which DDS finds the other participants
SPIN_TIMEOUT = 0.1  # s; how soon the end is noticed


def host(
    components: list[Component],
    activate: list[str] | DesiredState,
    report: Report,
    *,
    namespace: str = "",
    first_start: bool = True,
    inbox: int = -1,
    channels: Mapping[str, int] | None = None,
    feeders: Mapping[str, frozenset[str]] | None = None,
) -> None:
    """Run components in this process until SIGTERM.

    Each has a node and an executor of its own, so that one that is busy does not hold up another.
    An exception in a callback is a failure of that component, and the end of nothing.

    Parameters
    ----------
    components
        What to run.
    activate
        Names of those that become active at once; the others wait to be started. A ``DesiredState``
        is kept up to date besides.
    report
        Tells the supervisor.
    namespace
        ROS namespace of the nodes.
    first_start
        Look for the same nodes elsewhere on the domain. Not after a crash: DDS remembers the
        dead one for a while.
    inbox
        File descriptor on which the supervisor tells of processes, a JSON line each; -1 for none.
    channels
        File descriptors on which the monitor asks something of components, by their names.
    feeders
        Names of those whose loss each component, by name, is told of.
    """
    desired = activate
    if not isinstance(desired, DesiredState):
        desired = DesiredState({one.node_name: one.node_name in desired for one in components})
    ended = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: ended.set())
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    executors: list[TaskExecutor] = []
    try:
        for component in components:
            executor = TaskExecutor()
            executors.append(executor)
            node = give_life(component, executor, desired, namespace)
            if first_start:
                _watch_for_twin(node, report)
        running = list(zip(components, executors, strict=True))
        if inbox >= 0:
            _listen(inbox, running, feeders or {})
        if channels:
            answer_over(channels, running)
        report("active " + " ".join(component.node_name for component in components))
        _spin(running, ended)
    finally:
        for component in components:
            component.leave()
        rclpy.shutdown()


def give_life(
    component: Component,
    executor: Any,
    desired: DesiredState,
    namespace: str,
    make: MakeNode = ComponentNode,
) -> LifecycleNode:
    """Give a component its node, and make it active where it is meant to be.

    Parameters
    ----------
    executor
        Gets the node.
    desired
        What is meant to be active; kept up to date from then on.
    namespace, make
        Of the node.

    Raises
    ------
    RuntimeError
        When it does not become active; the message says why.
    """
    node = component.create_node(namespace, make)
    executor.add_node(node)
    component.on_intent = partial(desired.set, component.node_name)
    if desired.is_active(component.node_name):
        node.trigger_configure()
        # What nobody described a robot to waits for one, and its health says so.
        if not component.lacks_robot:
            node.trigger_activate()
            if not component.health.is_healthy:
                raise RuntimeError(f"{component.node_name}: {component.health.message}")
    return node


def _listen(
    inbox: int, running: list[tuple[Component, TaskExecutor]], feeders: Mapping[str, frozenset[str]]
) -> None:
    """Tell components, each on the thread of its executor, when one that feeds them is lost."""

    def read() -> None:
        with os.fdopen(inbox) as lines:
            for line in lines:
                news = ProcessNews.of_line(line)
                if not news.is_lost:
                    continue
                for component, executor in running:
                    lost = feeders.get(component.node_name, frozenset()) & set(news.nodes)
                    if lost:
                        text = f"{', '.join(sorted(lost))}: {news.reason}"
                        executor.create_task(component.on_feeder_lost, text)

    # Blocked in a read nearly always.
    threading.Thread(target=read, name="inbox", daemon=True).start()


def _watch_for_twin(node: LifecycleNode, report: Report) -> None:
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


def _spin(running: list[tuple[Component, TaskExecutor]], ended: threading.Event) -> None:
    def spin(component: Component, executor: TaskExecutor) -> None:
        name = component.node_name
        try:
            while not ended.is_set():
                try:
                    executor.spin_once(timeout_sec=SPIN_TIMEOUT)
                except Exception as error:
                    if not _came_from_callback(error):
                        raise
                    component.on_callback_error(error)
                send_heartbeat(name)
        finally:
            # One executor that dies takes the process along; the supervisor starts it again.
            ended.set()

    others = [
        threading.Thread(target=spin, args=pair, name=pair[0].node_name) for pair in running[1:]
    ]
    for thread in others:
        thread.start()
    spin(*running[0])
    for thread in others:
        thread.join()


def _came_from_callback(error: Exception) -> bool:
    """Whether Python code below the executor raised it, and not the executor itself."""
    return error.__traceback__ is not None and error.__traceback__.tb_next is not None
