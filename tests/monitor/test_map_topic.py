"""The robot's map is what its planner plans on, and no grid of another kind."""

from collections.abc import Mapping
from typing import Any

import pytest

from kompass.components import Controller, LocalMapper, Planner
from kompass.monitor.introspection.component_specs import component_spec
from kompass.monitor.map_topic import map_topic
from kompass.ros import Topic

GRID = ["nav_msgs/msg/OccupancyGrid"]
LOCAL = "/local_map/occupancy_layer"


class Graph:
    """The topics of grids that there are, and the components of a recipe."""

    def __init__(self, *topics: str, plans_on: str = "/map") -> None:
        planner = Planner(inputs={"map": Topic(name=plans_on, msg_type="OccupancyGrid")})
        components = (planner, Controller(), LocalMapper("mapper"))
        self._specs = {one.node_name: component_spec(one) for one in components}
        self._topics = topics

    def components(self) -> Mapping[str, Any]:
        return self._specs

    def get_topic_names_and_types(self) -> list[tuple[str, list[str]]]:
        return [(topic, GRID) for topic in self._topics]


@pytest.mark.parametrize(
    ("graph", "found"),
    [
        (Graph(LOCAL), None),
        (Graph(LOCAL, "/map"), "map"),
        (Graph(LOCAL, "/floor", plans_on="/floor"), "floor"),
        (Graph(), None),
    ],
)
def test_it_is_what_the_planner_plans_on_and_never_the_local_map(
    graph: Any, found: str | None
) -> None:
    assert map_topic(graph, graph) == found
