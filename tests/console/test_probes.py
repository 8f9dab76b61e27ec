"""Conditions that are being written are judged as the rules' engine judges, whatever is sent."""

from __future__ import annotations

import json
import time
from typing import Any, cast

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.node import Node
from sensor_msgs.msg import LaserScan

from kompass.rules.schema.conditions import AnyOf, Compare, Condition, Not, Rate
from kompass.rules.schema.signals import Signal
from kompass_console.api.probe import PageProbes
from kompass_console.link.rules.probes import ConditionProbe
from kompass_console.link.rules.topic_watch import ReceivedMessage, TopicListener, TopicWatch
from kompass_console.schema.rule_models import ProbeReading
from tests.support.patience import patient


class Topics:
    """In the place of the topic watch: what was said last, and who listens."""

    def __init__(self, said: dict[str, ReceivedMessage] | None = None) -> None:
        self.said = said or {}
        self.listeners: list[TopicListener] = []

    def open(
        self, listener: TopicListener, wanted: dict[str, str | None]
    ) -> dict[str, ReceivedMessage]:
        self.listeners.append(listener)
        return {topic: self.said[topic] for topic in wanted if topic in self.said}

    def close(self, listener: TopicListener) -> None:
        self.listeners.remove(listener)


def watch(topics: Topics) -> TopicWatch:
    return cast(TopicWatch, topics)


def nearest(operator: Any, value: float, **signal: Any) -> Compare:
    return Compare(
        signal=Signal(
            topic="scan",
            type="sensor_msgs/msg/LaserScan",
            path=("ranges",),
            aggregate="min",
            **signal,
        ),
        operator=operator,
        value=value,
    )


def scan(*ranges: float) -> LaserScan:
    return LaserScan(ranges=list(ranges))


def reading(condition: Condition, topics: Topics) -> ProbeReading:
    return ConditionProbe("a", condition, None, watch(topics)).reading()


def test_what_a_topic_said_last_is_judged_at_once_with_its_age() -> None:
    topics = Topics({"scan": ReceivedMessage(scan(0.5, 0.2), time.monotonic() - 0.4)})
    told = reading(nearest("<", 0.3), topics)
    assert told.verdict is True
    assert round(cast(float, told.leaves[0].value), 3) == 0.2
    assert 0.4 <= cast(float, told.leaves[0].age) < 0.4 + patient(0.2)


def test_a_value_that_is_too_old_is_unknown() -> None:
    topics = Topics({"scan": ReceivedMessage(scan(0.2), time.monotonic() - 3.0)})
    assert reading(nearest("<", 0.3), topics).verdict is None
    assert reading(Not(condition=nearest("<", 0.3)), topics).verdict is None
    assert reading(nearest("<", 0.3, timeout=None), topics).verdict is True


def test_each_message_counts_and_the_newest_is_shown() -> None:
    topics = Topics()
    either = AnyOf(
        conditions=(nearest("<", 0.3), Rate(topic="scan", above=100.0, window=0.1, type=None))
    )
    probe = ConditionProbe("a", either, nearest(">", 1.0), watch(topics))
    assert probe.reading().verdict is None
    for distance in (0.1, 2.0):
        probe.hear("scan", scan(distance), time.monotonic())
    told = probe.reading()
    assert [leaf.verdict for leaf in told.leaves] == [False, None]
    assert (told.clear_verdict, told.clear_leaves[0].value) == (True, 2.0)
    probe.close()
    assert topics.listeners == []


def test_a_page_that_looks_elsewhere_leaves_its_topics() -> None:
    topics = Topics()
    page = PageProbes(watch(topics))
    for value in (0.1, 0.2, 0.3):
        page.take(json.dumps({"condition": nearest("<", value).model_dump(mode="json")}))
    assert len(topics.listeners) == 1
    assert [told.leaves[0].text for told in page.readings()] == ["min(scan.ranges) < 0.3"]
    page.take(json.dumps({"condition": None}))
    assert topics.listeners == []
    assert page.readings() == []


anything = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["kind", "signal", "conditions", "topic", "type", "value"]), inner
        )
    ),
    max_leaves=8,
)


@settings(max_examples=100, deadline=None)
@given(condition=anything.filter(lambda each: each is not None))
def test_what_is_no_condition_is_refused_in_a_sentence(condition: Any) -> None:
    page = PageProbes(watch(Topics()))
    page.take(json.dumps({"id": "x", "condition": condition}))
    told = page.readings()
    assert [(each.id, bool(each.error)) for each in told] == [("x", True)]


@settings(max_examples=100, deadline=None)
@given(text=st.text() | st.binary().map(lambda raw: raw.decode(errors="replace")))
def test_no_text_brings_the_probe_down(text: str) -> None:
    page = PageProbes(watch(Topics()))
    page.take(text)
    page.readings()


@pytest.mark.parametrize("topic", ["\0", "a\0b", "a//b", "a b", "a\u200bb"])
def test_a_topic_that_ros_cannot_have_is_refused_in_a_sentence(topic: str) -> None:
    topics = Topics()
    probes = PageProbes(watch(topics))
    signal = {"topic": topic, "type": "std_msgs/msg/Bool", "path": ["data"]}
    condition = {"kind": "compare", "operator": "==", "value": True, "signal": signal}
    probes.take(json.dumps({"id": "a", "condition": condition}))
    (reading,) = probes.readings()
    assert "is not valid; give a name such as 'scan'" in reading.error
    assert not topics.listeners


@pytest.mark.parametrize("topic", ["1scan", "a-b", "~", "ä", "x" * 300])
def test_a_topic_that_nobody_can_listen_to_is_not_opened(topic: str) -> None:
    node = cast(Node, None)  # nothing is asked of it
    probes = PageProbes(TopicWatch(node, lambda work: work()))
    signal = {"topic": topic, "type": "std_msgs/msg/Bool", "path": ["data"]}
    condition = {"kind": "compare", "operator": "==", "value": True, "signal": signal}
    probes.take(json.dumps({"id": "a", "condition": condition}))
    (reading,) = probes.readings()
    assert "is no name of a topic: " in reading.error
    assert reading.error.endswith(".")
