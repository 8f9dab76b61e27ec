"""Which components a console knows of, on a graph that comes and goes."""

from unittest.mock import create_autospec

from rclpy.node import Node

from kompass_console.link.component_topics import ComponentTopics
from kompass_console.link.components import Components
from kompass_console.link.processes import restarted
from kompass_console.schema.models import ProcessInfo, ProcessPhase

STATUS = "automatika_ros_sugar/msg/ComponentStatus"
PLANNER = {"/planner/status": [STATUS]}
BOTH = PLANNER | {"/simulator/status": [STATUS]}


def process(
    state: ProcessPhase, name: str = "simulator", pid: int = 7, restarts: int = 0
) -> ProcessInfo:
    return ProcessInfo(name=name, state=state, pid=pid, restarts=restarts, reason="")


def test_who_was_only_spoken_for_is_no_component_once_it_is_well() -> None:
    known = Components(create_autospec(Node, instance=True), lambda: None)
    known.refresh(BOTH, lambda _: process("stuck"))
    assert known.names == ["planner", "simulator"]
    known.refresh(PLANNER, lambda _: process("dead"))
    assert known.names == ["planner", "simulator"], "one that died is not forgotten"
    known.refresh(PLANNER, lambda _: process("active"))
    assert known.names == ["planner"]


def test_a_process_that_was_started_again_is_known_by_its_count() -> None:
    before = [process("active"), process("dead", "planner", 1, 1)]
    after = [process("active"), process("active", "planner", 2, 2)]
    assert restarted(before, after) == ["planner"]
    assert restarted(after, after) == []
    assert restarted(after, before) == [], "a new stack counts anew"
    assert restarted([], after) == [], "nobody saw when"


def test_what_a_killed_component_has_to_publish_is_still_known() -> None:
    node = create_autospec(Node, instance=True)
    published = {"mapper": [("/local_map", ["x"]), ("/mapper/status", ["x"])], "controller": []}
    heard = {"mapper": [("/scan", ["x"])], "controller": [("/local_map", ["x"])]}
    node.get_publisher_names_and_types_by_node.side_effect = lambda name, _: published[name]
    node.get_subscriber_names_and_types_by_node.side_effect = lambda name, _: heard[name]
    topics = ComponentTopics(node, now=iter([0.0, 5.0]).__next__)
    topics.refresh(["controller", "mapper"])
    assert topics.outputs("mapper", []) == ["/local_map"], "what nobody reads is left out"
    published["mapper"] = []
    topics.refresh(["controller", "mapper"])
    assert topics.outputs("mapper", []) == ["/local_map"]
