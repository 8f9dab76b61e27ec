"""A topic that is looked at now and then, as bytes: nobody is called for each of its messages."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rclpy.node import Node

from kompass.rclpy_ext.qos import FOR_ANY_PUBLISHER, best_for


class RawTopic:
    """A subscription of a node that no executor serves.

    What comes in between two looks is kept by DDS, as much of it as `depth` says, and costs this
    process no more than its bytes.

    Parameters
    ----------
    node
        For nothing else, and not on any executor.
    depth
        Messages that may wait; the oldest go first.
    """

    def __init__(self, node: Node, name: str, message_type: type[Any], depth: int = 1) -> None:
        self.name = name
        self._node = node
        self._type = message_type
        self._depth = depth
        self._qos = FOR_ANY_PUBLISHER
        self._subscription: Any = None

    def fit(self) -> None:
        """Take the quality of service that the publishers offer now."""
        infos = self._node.get_publishers_info_by_topic(self.name)
        qos = best_for(infos, self._qos)
        if self._subscription is not None and qos == self._qos:
            return
        self.close()
        self._qos = qos
        self._subscription = self._node.create_subscription(
            self._type, self.name, _never, qos.profile(self._depth), raw=True
        )

    def take(self) -> Iterator[bytes]:
        """What has come since, the oldest first and at most `depth`; taken as it is asked for."""
        if self._subscription is None:
            return
        with self._subscription.handle:
            for _ in range(self._depth):
                found = self._subscription.handle.take_message(self._type, True)
                if found is None:
                    return
                yield found[0]

    def close(self) -> None:
        """Hear nothing any more."""
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None


def _never(_: object) -> None:
    raise AssertionError("no executor serves this node")
