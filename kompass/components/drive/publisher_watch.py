"""Whether nodes that have no business there publish on a topic."""

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

PERIOD = (
    0.2  # s between two looks; a look at all endpoints of a topic costs a tenth of a millisecond
)
# s for which a publisher may be without a name: what a node is called arrives after its publishers.
NAMELESS = 1.0
# s after which two processes with a node of one name are two nodes: DDS believes for 20 s in one
# that was killed, and it may have been started again at once.
NAMESAKES = 25.0
UNKNOWN = "a program without a node"
_NO_NAMES = frozenset({"", "_NODE_NAME_UNKNOWN_", "_CREATED_BY_BARE_DDS_APP_"})


class WatchedTopic(NamedTuple):
    """A topic, and who may publish on it.

    Attributes
    ----------
    owners
        Names of nodes that may.
    others
        How many other nodes may.
    """

    name: str
    owners: frozenset[str] = frozenset()
    others: int = 0


# Since when a process, known by the prefix of its endpoints' ids, publishes as a node of a name.
_Since = dict[tuple[str, bytes], float]
_PREFIX = 12  # bytes of an endpoint's id that name its process (RTPS 2.5, 9.3.1)


class PublisherWatch:
    """Looks at the publishers of topics, several times a second at most.

    Publishers of one process count as one. So do, for a while, those of processes whose nodes have
    one name: a node whose process died and was started again is there twice for as long as DDS
    believes in the dead one. After that one of the two is an intruder.

    Parameters
    ----------
    node
        Asks the graph.
    topics
        Says what to look at.
    """

    def __init__(self, node: Any, topics: Callable[[], Iterable[WatchedTopic]]) -> None:
        self._node, self._topics = node, topics
        self._looked = -float("inf")
        self._nameless_since: dict[str, float] = {}
        self._seen: dict[str, _Since] = {}
        self._intruders: dict[str, tuple[str, ...]] = {}

    def intruders(self, now: float) -> dict[str, tuple[str, ...]]:
        """The nodes that should not publish there, by topic; only topics that have some.

        Parameters
        ----------
        now
            Monotonic seconds.
        """
        if now - self._looked >= PERIOD:
            self._looked = now
            found = {topic.name: self._of(topic, now) for topic in self._topics()}
            self._intruders = {name: nodes for name, nodes in found.items() if nodes}
        return self._intruders

    def _of(self, topic: WatchedTopic, now: float) -> tuple[str, ...]:
        infos = self._node.get_publishers_info_by_topic(self._node.resolve_topic_name(topic.name))
        names = {info.node_name for info in infos}
        nodes = names - _NO_NAMES - topic.owners
        if names & _NO_NAMES:
            since = self._nameless_since.setdefault(topic.name, now)
            if now - since >= NAMELESS:
                nodes |= {UNKNOWN}
        else:
            self._nameless_since.pop(topic.name, None)
        namesakes = self._namesakes(topic.name, infos, now)
        intruders = nodes if len(nodes) > topic.others else set()
        return (*sorted(intruders), *sorted(f"another {name}" for name in namesakes))

    def _namesakes(self, topic: str, infos: Iterable[Any], now: float) -> set[str]:
        """Names that nodes of two processes have had for longer than a dead one is believed in."""
        before = self._seen.get(topic, {})
        there = {(info.node_name, bytes(info.endpoint_gid[:_PREFIX])) for info in infos}
        self._seen[topic] = since = {one: before.get(one, now) for one in there}
        settled = [name for (name, _), at in since.items() if now - at >= NAMESAKES]
        return {name for name in settled if settled.count(name) > 1} - _NO_NAMES
