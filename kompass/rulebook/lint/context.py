"""What lints must know of the running robot; the shell fills it in."""

from collections.abc import Collection, Mapping
from typing import NamedTuple

from kompass.rules.checks.catalog import ComponentSpec
from kompass.rules.engine.compiled_table import CompiledTable
from kompass.rules.engine.explain import verdict_of
from kompass.rules.engine.migration import migrate_state
from kompass.rules.engine.state import EngineState
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
        On the graph, by name without the leading slash.
    components
        Of the stack, by node name.
    verdicts
        What the conditions of new and changed rules would say if the table were in force now
        (:func:`verdicts_after`).
    publishes
        Topics that each component publishes on, without the leading slash.
    """

    topics: Mapping[str, TopicFacts] | None = None
    services: Collection[str] | None = None
    actions: Collection[str] | None = None
    components: Mapping[str, ComponentSpec] | None = None
    verdicts: Mapping[str, Verdict] = {}
    publishes: Mapping[str, Collection[str]] = {}


def verdicts_after(
    old: CompiledTable, state: EngineState, new: CompiledTable, now: float
) -> dict[str, Verdict]:
    """Return what the conditions of new and changed rules would say right after a swap.

    Unchanged rules go on as they were: nothing new is to be said of them. ``now`` is in monotonic
    seconds; nothing is changed.
    """
    state_after, report = migrate_state(old, state, new, now)
    return {
        rule_id: verdict_of(new, state_after, new.by_id[rule_id], now)
        for rule_id in (*report.added, *report.reset)
    }
