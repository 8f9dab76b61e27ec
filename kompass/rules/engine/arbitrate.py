"""Two rules that want the same component: the more severe one gets it.

Rules of equal severity do not exclude each other; their actions run one after the other.
"""

from collections.abc import Sequence
from typing import NamedTuple

from kompass.rules.engine.firing import Firing
from kompass.rules.schema.actions import Action, component_of
from kompass.rules.schema.table import Severity


class Running(NamedTuple):
    """A run in progress."""

    rule_id: str
    run_id: int
    severity: Severity
    components: frozenset[str]


class Outranked(NamedTuple):
    """A firing that is not carried out, and the run that has its component instead."""

    firing: Firing
    component: str
    winner_rule_id: str


class Arbitration(NamedTuple):
    """What is to be done about some firings.

    Attributes
    ----------
    start
        Firings to carry out, the most severe first, else in their order.
    outranked
        Firings to record as outranked and to report as ``RunEnded`` and not ok.
    preempted
        Runs in progress that must be cancelled for those that start.
    """

    start: tuple[Firing, ...]
    outranked: tuple[Outranked, ...]
    preempted: tuple[Running, ...]


def components_of(actions: Sequence[Action]) -> frozenset[str]:
    """Return the components that a list of actions acts on."""
    return frozenset(c for c in map(component_of, actions) if c is not None)


def arbitrate(firings: Sequence[Firing], running: Sequence[Running]) -> Arbitration:
    """Settle who gets which component.

    Parameters
    ----------
    firings
        What the engine has just returned.
    running
        The runs in progress. Those that a firing cancels itself may be left in.
    """
    cancelled = {(f.rule_id, run) for f in firings for run in f.cancels}
    holders = [r for r in running if (r.rule_id, r.run_id) not in cancelled]
    start: list[Firing] = []
    outranked: list[Outranked] = []
    preempted: list[Running] = []
    for firing in sorted(firings, key=lambda f: -f.severity):
        wanted = components_of(firing.actions)
        stronger = [h for h in holders if h.severity > firing.severity and h.components & wanted]
        if stronger:
            winner = max(stronger, key=lambda h: h.severity)
            component = min(winner.components & wanted)
            outranked.append(Outranked(firing, component, winner.rule_id))
            continue
        weaker = [h for h in holders if h.severity < firing.severity and h.components & wanted]
        preempted.extend(weaker)
        holders = [h for h in holders if h not in weaker]
        holders.append(Running(firing.rule_id, firing.run_id, firing.severity, wanted))
        start.append(firing)
    return Arbitration(tuple(start), tuple(outranked), tuple(preempted))
