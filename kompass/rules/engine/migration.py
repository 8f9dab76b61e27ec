"""What of one table is the same in another: worked out beforehand, so that a swap need not search.

Lists have an entry for each item of the new table: the index of the same item in the old table, or
-1 for one that is new.
"""

from collections.abc import Collection, Iterable
from dataclasses import dataclass

from kompass.rules.engine.compiled_table import CompiledTable, LeafPlan, Probe, RulePlan, Timer


@dataclass(slots=True)
class Migration:
    """From one compiled table to another; not to be changed, and good for any state of the old.

    Attributes
    ----------
    topics, probes, leaves, timers, rules
        Where each item was; for ``rules`` those that go on as they were.
    rule_at, timer_at
        Where items of the old table are now; those that are no more are left out.
    new_probes, new_leaves, new_timers
        What must be worked out from the messages that were received.
    newly_watched
        Probes of which the old table did not ask when they last had a value.
    longer
        Topics of which another number of receive times is remembered than before.
    fresh
        Rules that start afresh, each with the old rule of the same id, if there is one.
    removed
        Rules of the old table that the new one does not have.
    """

    old: CompiledTable
    new: CompiledTable
    topics: list[int]
    probes: list[int]
    leaves: list[int]
    timers: list[int]
    rules: list[int]
    rule_at: dict[int, int]
    timer_at: dict[int, int]
    new_probes: list[Probe]
    new_leaves: list[LeafPlan]
    new_timers: list[Timer]
    newly_watched: list[Probe]
    longer: list[int]
    fresh: list[tuple[RulePlan, RulePlan | None]]
    carried: tuple[str, ...]
    reset: tuple[str, ...]
    added: tuple[str, ...]
    removed: list[RulePlan]


def plan_migration(
    old: CompiledTable, new: CompiledTable, reset: Collection[str] = ()
) -> Migration:
    """Work out what of ``old`` goes on in ``new``.

    Parameters
    ----------
    reset
        Ids of rules that are to start afresh even if they are unchanged.

    Raises
    ------
    KeyError
        If a rule to be reset is not in the new table.
    """
    for rule_id in reset:
        if rule_id not in new.by_id:
            raise KeyError(f"rule {rule_id!r} cannot be reset: the table has no such rule")
    topics = [_index(old.by_topic.get(plan.name)) for plan in new.topics]
    probes = _twins(old.probes, new.probes)
    leaves = _twins(old.leaves, new.leaves)
    timers = _twins(old.timers, new.timers)
    rules, fresh = _rules(old, new, frozenset(reset))
    return Migration(
        old=old,
        new=new,
        topics=topics,
        probes=probes,
        leaves=leaves,
        timers=timers,
        rules=rules,
        rule_at={was: now for now, was in enumerate(rules) if was >= 0},
        timer_at={was: now for now, was in enumerate(timers) if was >= 0},
        new_probes=[probe for probe, was in zip(new.probes, probes, strict=True) if was < 0],
        new_leaves=[leaf for leaf, was in zip(new.leaves, leaves, strict=True) if was < 0],
        new_timers=[timer for timer, was in zip(new.timers, timers, strict=True) if was < 0],
        newly_watched=[
            probe
            for probe, was in zip(new.probes, probes, strict=True)
            if probe.watched and was >= 0 and not old.probes[was].watched
        ],
        longer=[
            plan.index
            for plan, was in zip(new.topics, topics, strict=True)
            if was >= 0 and old.topics[was].history != plan.history
        ],
        fresh=fresh,
        carried=tuple(plan.rule.id for plan, was in zip(new.rules, rules, strict=True) if was >= 0),
        reset=tuple(plan.rule.id for plan, was in fresh if was is not None),
        added=tuple(plan.rule.id for plan, was in fresh if was is None),
        removed=[plan for plan in old.rules if plan.rule.id not in new.by_id],
    )


def _rules(
    old: CompiledTable, new: CompiledTable, reset: frozenset[str]
) -> tuple[list[int], list[tuple[RulePlan, RulePlan | None]]]:
    places: list[int] = []
    fresh: list[tuple[RulePlan, RulePlan | None]] = []
    for plan in new.rules:
        rule_id = plan.rule.id
        twin = old.by_id.get(rule_id)
        if twin is not None and twin.hash == plan.hash and rule_id not in reset:
            places.append(twin.index)
        else:
            places.append(-1)
            fresh.append((plan, twin))
    return places, fresh


def _twins(
    old: Iterable[Probe | LeafPlan | Timer], new: Iterable[Probe | LeafPlan | Timer]
) -> list[int]:
    known = {item.key: item.index for item in old}
    return [known.get(item.key, -1) for item in new]


def _index(plan: object) -> int:
    return getattr(plan, "index", -1)
