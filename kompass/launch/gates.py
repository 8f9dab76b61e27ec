"""What stands between commands and wheels, who feeds it, and who halts the robot in its place."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from geometry_msgs.msg import Twist, TwistStamped
from kompass_interfaces.msg import TwistArray

from kompass.components.base.component import Component
from kompass.components.drive.halt import HALT_NODE, run_halt
from kompass.rclpy_ext.topic import Topic
from kompass.supervisor.process import ProcessSpec, Report

COMMANDS = (Twist, TwistStamped, TwistArray)
TO_THE_BASE = (Twist, TwistStamped)


def feeders_of(gate: Component, components: Sequence[Component]) -> frozenset[str]:
    """Names of the components by which a gate drives: who publishes or asks what it carries out."""
    taken = set(_topics(gate, "in", COMMANDS))
    return frozenset(
        other.node_name
        for other in components
        if other is not gate
        and (other.asks_for_motion or taken & set(_topics(other, "out", COMMANDS)))
    )


class Halting(NamedTuple):
    """What is to be halted when gates cannot: their names, their command topics, the base."""

    gates: list[str]
    topics: list[Topic]
    frame: str


def halting(components: Sequence[Component]) -> Halting | None:
    """What is to be halted; None where there is no gate.

    Raises
    ------
    ValueError
        When a component has the name of the node that does it.
    """
    if any(component.node_name == HALT_NODE for component in components):
        raise ValueError(
            f"component_name = '{HALT_NODE}' is the name of the node that halts the robot when the "
            "drive manager dies; choose another"
        )
    gates = [component for component in components if component.stops_robot]
    topics = list(
        dict.fromkeys(topic for gate in gates for topic in _topics(gate, "out", TO_THE_BASE))
    )
    if not topics:
        return None
    return Halting([gate.node_name for gate in gates], topics, gates[0].frames.robot_base)


def halt_process(components: Sequence[Component], namespace: str = "") -> list[ProcessSpec]:
    """The process that sends zero when a gate cannot; none where there is no gate."""
    wanted = halting(components)
    if wanted is None:
        return []

    def main(report: Report) -> None:
        run_halt(*wanted, report, spec.inbox, namespace)

    spec = ProcessSpec(HALT_NODE, main, names=[HALT_NODE], listens=True, outlives=True)
    return [spec]


def _topics(component: Component, direction: str, kinds: tuple[type, ...]) -> Iterator[Topic]:
    """Its topics of these message types."""
    keys = component.inputs_keys if direction == "in" else component.outputs_keys
    get = component.get_in_topic if direction == "in" else component.get_out_topic
    for key in keys:
        topic = get(key)
        for one in topic if isinstance(topic, list) else [topic]:
            if one is not None and one.ros_msg_type in kinds:
                yield one
