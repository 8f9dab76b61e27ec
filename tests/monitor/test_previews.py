"""A check hears what no rule in force looks at, for a moment, and then lets go of it."""

import threading
from collections.abc import Mapping
from typing import Any

import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float32

from kompass.monitor.inputs import previews as module
from kompass.monitor.inputs.previews import AT_ONCE, Previews
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rulebook.outlook import Newest
from tests.support.spinning import Spinning

pytestmark = pytest.mark.ros

FLOAT = "std_msgs/msg/Float32"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Asking:
    """Hears on the executor, and asks from a worker, as a check does."""

    def __init__(self, spinning: Spinning) -> None:
        self._spinning = spinning
        self.previews = Previews(spinning.node, MainThread(spinning.executor))

    def newest(self, *topics: str) -> Mapping[str, Newest]:
        heard = self._spinning.executor.create_task(
            self.previews.hear(dict.fromkeys(topics, FLOAT))
        )
        self._spinning.until(heard.done)
        found: list[Mapping[str, Newest]] = []
        worker = threading.Thread(target=lambda: found.append(self.previews.newest(topics)))
        worker.start()
        self._spinning.until(lambda: bool(found))
        worker.join()
        return found[0]


def test_a_latched_value_is_heard_at_once_and_a_silent_topic_is_not_waited_for(
    spinning: Spinning, monkeypatch: pytest.MonkeyPatch
) -> None:
    asking = Asking(spinning)
    publisher = spinning.node.create_publisher(Float32, "mode", LATCHED)
    publisher.publish(Float32(data=3.0))
    spinning.until(lambda: spinning.node.count_publishers("mode") == 1)
    (newest,) = asking.newest("mode").values()
    assert (newest.message.data, newest.comes) == (3.0, True)
    monkeypatch.setattr(module, "PATIENCE", 600.0)
    assert asking.newest("nobody_says") == {}


def test_what_comes_by_itself_is_told_from_what_was_said_once(spinning: Spinning) -> None:
    asking = Asking(spinning)
    made = [spinning.node.create_publisher(Float32, name, LATCHED) for name in ("chart", "load")]
    for publisher in made:
        publisher.publish(Float32(data=1.0))
    spinning.until(lambda: all(map(spinning.node.count_publishers, ("chart", "load"))))
    assert asking.newest("chart", "load")["load"].rate == 0.0
    made[1].publish(Float32(data=2.0))
    spinning.until(lambda: asking.newest("load")["load"].message.data == 2.0)
    newest = asking.newest("chart", "load")
    assert newest["chart"].rate == 0.0 < newest["load"].rate


def test_what_nobody_asks_for_any_more_is_let_go(
    spinning: Spinning, monkeypatch: pytest.MonkeyPatch
) -> None:
    asking = Asking(spinning)
    made: list[Any] = [spinning.node.create_publisher(Float32, "gear", LATCHED)]
    made[0].publish(Float32(data=3.0))
    spinning.until(lambda: spinning.node.count_publishers("gear") == 1)
    asking.newest("gear")
    asking.previews.tidy()
    assert spinning.node.count_subscribers("gear") == 1
    monkeypatch.setattr(module, "KEPT", 0.0)
    asking.previews.tidy()
    spinning.until(lambda: spinning.node.count_subscribers("gear") == 0)


def test_a_check_of_many_topics_has_few_of_them_listened_to(
    spinning: Spinning, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "PATIENCE", 60.0)  # all that it listens to has something to say
    asking = Asking(spinning)
    names = [f"many_{number}" for number in range(AT_ONCE + 4)]
    made = [spinning.node.create_publisher(Float32, name, LATCHED) for name in names]
    for publisher in made:
        publisher.publish(Float32(data=1.0))
    spinning.until(lambda: all(spinning.node.count_publishers(name) for name in names))
    assert len(asking.newest(*names)) == AT_ONCE
