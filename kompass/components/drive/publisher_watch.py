"""Whether nodes that have no business there publish on a topic."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
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


_PREFIX = 12  # bytes of an endpoint's id that name its process (RTPS 2.5, 9.3.1)


@dataclass
class _Process:
    """Publishes on a topic as a node of a name.

    Attributes
    ----------
    since
        When it was first seen.
    rival_since
        When another of that name came, or was found together with it.
    found_together
        Whether they were: then the other may be the older one.
    """

    since: float
    rival_since: float | None = None
    found_together: bool = False


class PublisherWatch:
    """Looks at the publishers of topics, several times a second at most.

    Publishers of one process count as one. So do, for a while, those of processes whose nodes have
    one name: a node whose process died and was started again is there twice for as long as DDS
    believes in the dead one. One that is still there long after another of its name came was alive
    when that came: one of the two is an intruder, also if it comes and goes.

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
        self._seen: dict[str, dict[tuple[str, bytes], _Process]] = {}
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
        """Names that nodes of two living processes have."""
        before = self._seen.get(topic, {})
        there = {(info.node_name, bytes(info.endpoint_gid[:_PREFIX])) for info in infos}
        self._seen[topic] = seen = {one: before.get(one) or _Process(now) for one in there}
        return {name for name, _ in there if _are_rivals(_of_name(seen, name), now)} - _NO_NAMES


def _of_name(seen: Mapping[tuple[str, bytes], _Process], name: str) -> list[_Process]:
    return [process for (node, _), process in seen.items() if node == name]


def _are_rivals(processes: Sequence[_Process], now: float) -> bool:
    """Whether some of these were alive together, and are there together now."""
    newest = max(process.since for process in processes)
    for process in processes:
        together = sum(other.since == process.since for other in processes) > 1
        if process.found_together and not together:  # the other was the dead one before it
            process.rival_since, process.found_together = None, False
        if process.rival_since is None and (together or process.since < newest):
            process.rival_since, process.found_together = now, together
    if len(processes) == 1:
        return False
    return any(
        process.rival_since is not None and now - process.rival_since >= NAMESAKES
        for process in processes
    )
