"""Which components a console knows of, on a graph that comes and goes."""

from unittest.mock import create_autospec

from rclpy.node import Node

from kompass_console.link.components import Components
from kompass_console.schema.models import ProcessInfo, ProcessPhase

STATUS = "automatika_ros_sugar/msg/ComponentStatus"
PLANNER = {"/planner/status": [STATUS]}
BOTH = PLANNER | {"/simulator/status": [STATUS]}


def process(state: ProcessPhase) -> ProcessInfo:
    return ProcessInfo(name="simulator", state=state, pid=7, restarts=0, reason="")


def test_who_was_only_spoken_for_is_no_component_once_it_is_well() -> None:
    known = Components(create_autospec(Node, instance=True), lambda: None)
    known.refresh(BOTH, lambda _: process("stuck"))
    assert known.names == ["planner", "simulator"]
    known.refresh(PLANNER, lambda _: process("dead"))
    assert known.names == ["planner", "simulator"], "one that died is not forgotten"
    known.refresh(PLANNER, lambda _: process("active"))
    assert known.names == ["planner"]
