"""What lints must know of the running robot; the shell fills it in."""

from collections.abc import Collection, Mapping
from typing import NamedTuple

from kompass.rules.checks.catalog import Catalog, ComponentSpec
from kompass.rules.schema.values import Verdict


class TopicFacts(NamedTuple):
    """A topic on the graph.

    Attributes
    ----------
    type
        Message type of its publishers; empty if none is there.
    rate
        Messages per second as measured; None where nobody measured.
    latched
        Whether its publishers keep their last message for those who come later.
    """

    type: str = ""
    rate: float | None = None
    latched: bool = False
    publishers: int = 1


class LintContext(NamedTuple):
    """The robot now; None where the shell does not know, and nothing is said then.

    Attributes
    ----------
    topics, services, actions
        On the graph, by name without the leading slash; of the latter two the types they have.
    components
        Of the stack, by node name.
    verdicts
        What the conditions of new and changed rules would say if the table were in force now
        (:func:`kompass.rulebook.outlook.outlook`).
    publishes
        Topics that each component publishes on, without the leading slash.
    messages
        The message definitions that are installed.
    """

    topics: Mapping[str, TopicFacts] | None = None
    services: Mapping[str, Collection[str]] | None = None
    actions: Mapping[str, Collection[str]] | None = None
    components: Mapping[str, ComponentSpec] | None = None
    verdicts: Mapping[str, Verdict] = {}
    publishes: Mapping[str, Collection[str]] = {}
    messages: Catalog | None = None
