"""Hear for a moment what a table would look at that nobody has applied yet."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from rclpy.task import Future

from kompass.bus.node import Node
from kompass.message_types import ros_class
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rclpy_ext.qos import best_for
from kompass.rclpy_ext.unreadable import Unreadable, read_message
from kompass.rulebook.outlook import Newest

PATIENCE = 0.5  # s that a check waits for messages of topics that nobody listened to
KEPT = 10.0  # s for which a topic is listened to after it was last asked for
AT_ONCE = 16  # topics; whoever may check a table shall not have the monitor listen to all there is
_ENOUGH = 2  # messages that tell that more come by themselves


@dataclass
class _Preview:
    """One subscription, and the newest that came."""

    kind: type[Any]
    subscription: Any
    latched: bool
    asked: float
    count: int = 0
    raw: bytes = b""
    first: float = 0.0
    received: float = 0.0

    @property
    def settled(self) -> bool:
        """Whether waiting would tell nothing more."""
        return self.count >= (1 if self.latched else _ENOUGH)

    @property
    def rate(self) -> float:
        """Messages per second; 0 where they came all at once, or one did."""
        took = self.received - self.first
        return (self.count - 1) / took if took > 0.0 else 0.0


class Previews:
    """Subscriptions of a few seconds, whose messages no rule gets.

    Waiting for them is the executor's, which goes on meanwhile; no thread stands still for it.

    Parameters
    ----------
    node, main
        Subscribes, and its executor's thread.
    """

    def __init__(self, node: Node, main: MainThread) -> None:
        self._node, self._main = node, main
        self._open: dict[str, _Preview] = {}
        self._waiting: dict[Future, list[_Preview]] = {}

    async def hear(self, topics: Mapping[str, str]) -> None:
        """Listen to topics, and wait for what comes; on the executor's thread.

        It waits for a topic that it did not listen to, for :data:`PATIENCE` seconds at most.

        Parameters
        ----------
        topics
            Types (``package/msg/Name``) by name, without a leading slash.
        """
        asked = self._listen(topics)
        if all(each.settled for each in asked):
            return
        done = Future(executor=self._node.executor)
        self._waiting[done] = asked
        timer = self._node.create_timer(PATIENCE, partial(self._end, done))
        try:
            await done
        finally:
            self._node.destroy_timer(timer)

    def newest(self, topics: Iterable[str]) -> dict[str, Newest]:
        """The newest messages of topics, without those on which none came; called on a worker.

        It waits for nothing: :meth:`hear` has.
        """

        def copies() -> dict[str, _Preview]:
            now, found = self._node.clock.monotonic(), {}
            for name in topics:
                each = self._open.get(name)
                if each is not None and each.count:
                    each.asked = now
                    found[name] = replace(each)
            return found

        # Made a message of here, and only if it is asked for: most are replaced before that.
        found = {name: _newest(each) for name, each in self._main.call(copies).items()}
        return {name: newest for name, newest in found.items() if newest is not None}

    def tidy(self) -> None:
        """Listen no more to what was last asked for long ago; on the executor's thread."""
        until = self._node.clock.monotonic() - KEPT
        for name in [name for name, each in self._open.items() if each.asked < until]:
            self._node.destroy_subscription(self._open.pop(name).subscription)

    def _listen(self, topics: Mapping[str, str]) -> list[_Preview]:
        now = self._node.clock.monotonic()
        for name, type_name in topics.items():
            known = self._open.get(name)
            if known is not None:
                known.asked = now
            elif type_name and len(self._open) < AT_ONCE:
                self._begin(name, type_name, now)
        return [self._open[name] for name in topics if name in self._open]

    def _begin(self, name: str, type_name: str, now: float) -> None:
        full = self._node.resolve_topic_name(name)
        infos = [
            info
            for info in self._node.get_publishers_info_by_topic(full)
            if info.topic_type == type_name
        ]
        if not infos:
            return
        kind, offer = ros_class(type_name), best_for(infos)
        preview = _Preview(kind, None, offer.latched, now)
        preview.subscription = self._node.create_subscription(
            kind, name, partial(self._take, preview), offer.profile(1), raw=True
        )
        self._open[name] = preview

    def _take(self, preview: _Preview, raw: bytes) -> None:
        preview.count += 1
        preview.raw, preview.received = raw, self._node.clock.monotonic()
        if preview.count == 1:
            preview.first = preview.received
        for done, asked in list(self._waiting.items()):
            if all(each.settled for each in asked):
                self._end(done)

    def _end(self, done: Future) -> None:
        if self._waiting.pop(done, None) is not None:
            done.set_result(None)


def _newest(preview: _Preview) -> Newest | None:
    """The newest message; None where it is none of its type."""
    try:
        message = read_message(preview.raw, preview.kind)
    except Unreadable:
        return None
    return Newest(message, preview.received, preview.settled, preview.rate)
