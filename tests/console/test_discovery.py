"""Of all topics on the graph, the right ones are read."""

from kompass_console.link.components import label_of
from kompass_console.link.graph.discovery import STATUS_TYPE, status_topics, stream_topic

ODOMETRY = ["nav_msgs/msg/Odometry"]
GRID = ["nav_msgs/msg/OccupancyGrid"]


def test_the_usual_name_wins() -> None:
    graph = {"/a_odom": ODOMETRY, "/odometry/filtered": ODOMETRY}
    assert stream_topic("odometry", graph, None) == "/odometry/filtered"


def test_another_name_of_the_right_type_will_do() -> None:
    assert stream_topic("odometry", {"/robot/odom": ODOMETRY}, None) == "/robot/odom"


def test_a_costmap_is_not_the_map() -> None:
    graph = {"/global_costmap/costmap": GRID, "/site/map": GRID, "/local": GRID}
    assert stream_topic("map", graph, None) == "/site/map"
    assert stream_topic("local_map", {"/local": GRID}, None) == "/local"
    assert stream_topic("map", {"/local": GRID}, None) is None


def test_a_given_topic_is_read_and_no_other() -> None:
    graph = {"/odometry/filtered": ODOMETRY, "/odom": ODOMETRY}
    assert stream_topic("odometry", graph, "/odom") == "/odom"
    assert stream_topic("odometry", graph, "/elsewhere") is None


def test_a_component_is_listed_once() -> None:
    graph = {
        "/planner/status": [STATUS_TYPE],
        "/planner_status": [STATUS_TYPE],
        "/old_status": [STATUS_TYPE],
        "/battery/status": ["std_msgs/msg/String"],
    }
    assert status_topics(graph) == {"planner": "/planner/status", "old": "/old_status"}


def test_operators_read_words_and_not_node_names() -> None:
    assert label_of("drive_manager") == "Drive"
    assert label_of("robot1/planner") == "Planner"
    assert label_of("battery_watch") == "Battery watch"
