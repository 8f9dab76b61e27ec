"""What a table would do as soon as it is applied: which of its rules are true already."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from kompass.rulebook.schema.report import Prospect
from kompass.rulebook.views.views import unknown_text
from kompass.rulebook.views.wording import describe_actions, seconds
from kompass.rules.engine.compiled_table import CompiledTable, RulePlan
from kompass.rules.engine.explain import verdict_at
from kompass.rules.engine.firing import Sample
from kompass.rules.engine.migration import migrate_state
from kompass.rules.engine.readings import leaf_verdict
from kompass.rules.engine.schedule import due
from kompass.rules.engine.state import EngineState
from kompass.rules.engine.step import step
from kompass.rules.schema.actions import (
    Action,
    CallService,
    ClearAlarm,
    Log,
    RaiseAlarm,
    Reconfigure,
    UpdateParameters,
)
from kompass.rules.schema.conditions import Absent, Changed, Received
from kompass.rules.schema.table import Rule
from kompass.rules.schema.values import Verdict

QUICK = 1.0  # Hz from which on the next message of a topic is not worth waiting for
_NAMED = 3  # rules that the first line names


class Newest(NamedTuple):
    """The newest message of a topic that no rule in force looks at.

    Attributes
    ----------
    message
        As the engine would take it.
    received
        Monotonic seconds.
    comes
        Whether a table that is applied is given one soon: they come by themselves, or the topic is
        latched.
    """

    message: Any
    received: float
    comes: bool


class Outlook(NamedTuple):
    """A table, were it applied now.

    Attributes
    ----------
    verdicts
        What the conditions of new and changed rules would say, by rule id.
    prospects
        Those of them that are true now, or not known to be false.
    text
        All of it in one line; empty if there is no rule that is new or changed.
    """

    verdicts: Mapping[str, Verdict]
    prospects: tuple[Prospect, ...]
    text: str


def outlook(
    old: CompiledTable,
    state: EngineState,
    new: CompiledTable,
    now: float,
    *,
    rates: Mapping[str, float] = {},
    heard: Mapping[str, Newest] = {},
) -> Outlook:
    """Tell what the new and changed rules of a table would do, were it applied now.

    Parameters
    ----------
    old, state
        The table in force, and what the engine knows; neither is changed.
    new
        The table to come.
    now
        Monotonic seconds.
    rates
        Messages per second of the topics that the engine listens to, where known.
    heard
        Newest messages of topics that it does not listen to, by name.
    """
    after, report = migrate_state(old, state, new, now)
    for name, newest in heard.items():
        plan = new.by_topic.get(name)
        if plan is not None and after.received[plan.index] is None:
            step(new, after, Sample(name, newest.message), now)
            after.received[plan.index] = newest.received
    fresh = [new.by_id[rule_id] for rule_id in (*report.added, *report.reset)]
    found = _Look(new, after, now, rates, heard)
    enabled = [plan for plan in fresh if plan.rule.enabled]
    prospects = tuple(each for plan in enabled if (each := found.prospect(plan)) is not None)
    names = {plan.rule.id: plan.rule.name or plan.rule.id for plan in enabled}
    verdicts = {plan.rule.id: plan.evaluate(found.verdicts(plan)) for plan in fresh}
    return Outlook(verdicts, prospects, _first_line(prospects, names, found.actions(enabled)))


def acts(rule: Rule) -> bool:
    """Whether a rule may stop or move the robot, or something of it.

    What only tells does not, nor what only changes settings; of a function of the recipe, a method
    or a service nobody knows.
    """
    return not rule.shadow and any(map(_acts, rule.actions))


def _acts(action: Action) -> bool:
    if isinstance(action, CallService):
        return not action.service.startswith("monitor/")
    return not isinstance(action, Log | RaiseAlarm | ClearAlarm | UpdateParameters | Reconfigure)


class _Look:
    """A look at the rules right after a table was applied."""

    def __init__(
        self,
        table: CompiledTable,
        state: EngineState,
        now: float,
        rates: Mapping[str, float],
        heard: Mapping[str, Newest],
    ) -> None:
        self._table, self._state, self._now = table, state, now
        self._rates, self._heard = rates, heard

    def verdicts(self, plan: RulePlan) -> dict[int, Verdict]:
        """What its leaves say between two messages: none of them is arriving."""
        return {index: self._verdict(index) for _, index in plan.leaves}

    def _verdict(self, index: int) -> Verdict:
        leaf = self._table.leaves[index]
        if isinstance(leaf.condition, Received | Changed):
            return False
        return verdict_at(self._table, self._state, leaf, self._now)

    def actions(self, plans: Sequence[RulePlan]) -> dict[str, str]:
        """What rules do, in a line each."""
        return {plan.rule.id: describe_actions(plan.rule.actions) for plan in plans}

    def prospect(self, plan: RulePlan) -> Prospect | None:
        """What is to be expected of a rule; None if it is false, and stays so by itself."""
        verdicts = self.verdicts(plan)
        verdict = plan.evaluate(verdicts)
        event = plan.rule.event
        waits = event.trigger == "edge" and not event.first_true_is_edge
        if verdict is True and event.trigger == "change":
            return _prospect(plan, "with a change", "true now; it fires when a value changes")
        if verdict is True and waits:
            return _prospect(plan, "when next true", "true now; it fires when it next becomes true")
        if verdict is True:
            return self._fires(plan, verdicts)
        if waits or event.trigger == "change":
            return None
        if verdict is None:
            why = self._unknown(plan, verdicts)
            return _prospect(plan, "unknown", f"not known yet whether it is true now: {why}")
        return self._if_silent(plan, verdicts)

    def _fires(self, plan: RulePlan, verdicts: Mapping[int, Verdict]) -> Prospect:
        hold = plan.hold
        lasts = any(
            self._table.leaves[index].timer >= 0 and verdict is True
            for index, verdict in verdicts.items()
        )
        if lasts or any(map(self._comes, plan.topics)):
            when = f"in {_exactly(hold)} after Apply" if hold else "at once after Apply"
            return _prospect(plan, "soon", f"true now: it will fire {when}", hold)
        topics = " or ".join(f"/{self._table.topics[topic].name}" for topic in plan.topics)
        when = f"{_exactly(hold)} after" if hold else "with"
        text = f"true now: it will fire {when} the next message on {topics}"
        return _prospect(plan, "with a message", text, hold)

    def _comes(self, topic: int) -> bool:
        name = self._table.topics[topic].name
        newest = self._heard.get(name)
        if newest is not None:
            return newest.comes
        return self._table.topics[topic].callable or self._rates.get(name, 0.0) > QUICK

    def _if_silent(self, plan: RulePlan, verdicts: dict[int, Verdict]) -> Prospect | None:
        """Tell of a rule that fires unless somebody breaks a silence that nobody has broken yet."""
        ends = dict(self._silences(plan))
        if not ends or plan.evaluate({**verdicts, **dict.fromkeys(ends, True)}) is not True:
            return None
        left = max(max(ends.values()) - self._now, 0.0) + plan.hold
        names = dict.fromkeys(
            f"/{self._table.topics[self._table.leaves[index].topic].name}" for index in ends
        )
        silent = " and ".join(names)
        text = (
            f"will be true: it will fire in {_exactly(left)} after Apply if {silent} stays silent"
        )
        return _prospect(plan, "if silent", text, left)

    def _silences(self, plan: RulePlan) -> Iterator[tuple[int, float]]:
        for _, index in plan.leaves:
            leaf = self._table.leaves[index]
            if isinstance(leaf.condition, Absent) and self._state.received[leaf.topic] is None:
                when = due(self._table.timers[leaf.timer], self._state)
                if when is not None:
                    yield index, when

    def _unknown(self, plan: RulePlan, verdicts: Mapping[int, Verdict]) -> str:
        readings = [
            leaf_verdict(
                self._table,
                self._state,
                path,
                self._table.leaves[index],
                verdicts[index],
                self._now,
            )
            for path, index in plan.leaves
        ]
        return unknown_text(plan, readings)


def _prospect(plan: RulePlan, fires: Any, text: str, left: float | None = None) -> Prospect:
    if plan.rule.shadow:
        text += " (in shadow: it does nothing)"
    return Prospect(
        rule_id=plan.rule.id, fires=fires, seconds=left, acts=acts(plan.rule), text=text
    )


def _first_line(
    prospects: Sequence[Prospect], names: Mapping[str, str], actions: Mapping[str, str]
) -> str:
    """Say in one line what is true now; what fires comes first, and what acts before the rest."""
    if not names:
        return ""
    if not prospects:
        return "no new or changed rule is true now"
    order = {"soon": 0, "with a message": 1, "if silent": 2, "unknown": 3}
    ranked = sorted(prospects, key=lambda each: (order.get(each.fires, 4), not each.acts))
    said = [_about(each, names[each.rule_id]) for each in ranked[:_NAMED]]
    first = ranked[0]
    if len(ranked) == 1 and first.fires in ("soon", "with a message", "if silent"):
        said[0] += f" ({actions[first.rule_id]})"
    if len(ranked) > _NAMED:
        said.append(f"and {len(ranked) - _NAMED} more")
    return "; ".join(said)


def _about(prospect: Prospect, name: str) -> str:
    if prospect.fires == "unknown":
        return prospect.text.replace("whether it is", f"whether '{name}' is", 1)
    verb = "" if prospect.fires == "if silent" else "is "
    return f"'{name}' {verb}{prospect.text}"


def _exactly(duration: float) -> str:
    """A time that somebody may count along with: ``2.0 s``."""
    return f"{duration:.1f} s" if 1.0 <= duration < 9.95 else seconds(duration)
