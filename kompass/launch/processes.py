"""The processes of a stack: each with its own interpreter, forked and watched by a supervisor."""

from __future__ import annotations

import importlib
import inspect
import os
from collections.abc import Sequence

from kompass.components.base.component import Component
from kompass.launch.channels import connect
from kompass.launch.companions import companions
from kompass.launch.environment import prepare_key
from kompass.launch.gates import feeders_of, halt_process
from kompass.launch.host import host
from kompass.launch.stack import Stack
from kompass.monitor.process import NAME, run_monitor
from kompass.recorder.process import flight_recorder
from kompass.supervisor.desired_state import DesiredState
from kompass.supervisor.heartbeat import Heartbeat
from kompass.supervisor.instance_lock import lock_instance
from kompass.supervisor.process import ProcessSpec, Report
from kompass.supervisor.restarts import Restarts
from kompass.supervisor.supervisor import Supervisor


def run_processes(stack: Stack) -> None:
    """Run a stack until SIGINT or SIGTERM; see :meth:`kompass.launch.launcher.Launcher.bringup`."""
    prepare_key()
    # Every process would import it with its first message: a parser of IDL that none of them needs.
    importlib.import_module("rosidl_generator_py")
    # And look through all modules with its first line of rclpy's log, in the middle of a drive.
    inspect.stack()
    own, recorder = [_host(stack, group) for group in stack.groups], list[ProcessSpec]()
    heartbeat = Heartbeat(())
    if stack.monitored is not None:
        monitor, recorder = _monitor(stack, heartbeat)
        own.append(monitor)
    names = [name for spec in own for name in spec.names]
    # A node of the recipe's own takes the place of a companion of that name.
    more = [*halt_process(stack.components, stack.namespace), *recorder, *companions()]
    beside = [spec for spec in more if not set(spec.names) & set(names)]
    names += [name for spec in beside for name in spec.names]
    held = lock_instance(names, stack.namespace)
    try:
        if stack.monitored is not None:
            held += connect(monitor, own[:-1])
        Supervisor(
            [*own, *beside],
            announced=[spec.name for spec in own],
            limits=stack.patience,
            restarts=Restarts(stack.process_retries),
            activation_timeout=stack.activation_timeout,
            inactive=stack.inactive,
            heartbeat=heartbeat,
        ).run()
    finally:
        for descriptor in held:
            os.close(descriptor)


def process_name(group: Sequence[Component]) -> str:
    """What a process of components is called."""
    return group[0].node_name if len(group) == 1 else "components"


def _monitor(stack: Stack, supervisor: Heartbeat) -> tuple[ProcessSpec, list[ProcessSpec]]:
    """The monitor's process, which watches the supervisor, and those of its flight recorder."""
    monitored = stack.monitored
    assert monitored is not None
    recording, recorder = flight_recorder(stack.components, stack.namespace)

    def main(report: Report) -> None:
        rules, catalog = monitored.rules, monitored.catalog
        run_monitor(
            rules,
            catalog,
            report,
            spec.inbox,
            spec.channels,
            supervisor.silent,
            stack.namespace,
            recording,
        )

    spec = ProcessSpec(name=NAME, main=main, names=[NAME], listens=True)
    return spec, recorder


def _host(stack: Stack, group: Sequence[Component]) -> ProcessSpec:
    """The process of some components."""
    names = [component.node_name for component in group]
    desired_state = DesiredState({name: name in stack.activate for name in names})
    stops_robot = any(component.stops_robot for component in group)

    def main(report: Report) -> None:
        host(
            list(group),
            desired_state,
            report,
            namespace=stack.namespace,
            first_start=spec.starts == 1,
            inbox=spec.inbox,
            channels=spec.channels,
            feeders={
                component.node_name: feeders_of(component, stack.components)
                for component in group
                if component.stops_robot
            },
        )

    spec = ProcessSpec(
        name=process_name(group),
        main=main,
        names=names,
        stops_robot=stops_robot,
        listens=stops_robot,
        allowed={component.node_name: component.longest_step for component in group},
    )
    return spec
