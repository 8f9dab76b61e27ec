"""What a table would do as soon as it is applied: which of its rules are true already."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from kompass.rulebook.schema.report import Prospect
from kompass.rulebook.views.views import unknown_text
from kompass.rulebook.views.wording import describe_actions, seconds
from kompass.rules.engine.compiled_table import CompiledTable, LeafPlan, RulePlan
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
from kompass.rules.schema.describe import describe_signal
from kompass.rules.schema.events import Single
from kompass.rules.schema.table import Rule
from kompass.rules.schema.values import MISSING, Verdict, kind_of

QUICK = 1.0  # Hz from which on the next message of a topic is not worth waiting for
_MISSED = 2.0  # periods in which nothing came of a topic that is silent, not late
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
    rate
        Messages per second; 0 where no second one came.
    """

    message: Any
    received: float
    comes: bool
    rate: float = 0.0


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
    running = {rule_id for rule_id, _ in report.running}
    found = _Look(new, after, now, rates, heard, running)
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


class _World(NamedTuple):
    """A moment at which a rule is asked, as far as nothing but time and repetition changes it.

    Attributes
    ----------
    at
        Monotonic seconds.
    topic
        Index of the topic of which a message is arriving; -1 between messages.
    changes
        Whether that message brings other values than the last.
    """

    at: float
    topic: int = -1
    changes: bool = False


class _Look:
    """A look at the rules right after a table was applied."""

    def __init__(
        self,
        table: CompiledTable,
        state: EngineState,
        now: float,
        rates: Mapping[str, float],
        heard: Mapping[str, Newest],
        running: Collection[str],
    ) -> None:
        self._table, self._state, self._now = table, state, now
        self._heard, self._running = heard, running
        self._rates = {**{name: each.rate for name, each in heard.items()}, **rates}

    def verdicts(self, plan: RulePlan) -> dict[int, Verdict]:
        """What its leaves say between two messages: none of them is arriving."""
        return self._in(plan, _World(self._now))

    def _in(self, plan: RulePlan, world: _World) -> dict[int, Verdict]:
        return {index: self._verdict(self._table.leaves[index], world) for _, index in plan.leaves}

    def _verdict(self, leaf: LeafPlan, world: _World) -> Verdict:
        condition, arrives = leaf.condition, leaf.topic == world.topic
        if isinstance(condition, Received):
            return None if self._state.seen[leaf.probe] is None else arrives
        if isinstance(condition, Changed):
            known = self._state.references[leaf.index] is not MISSING
            return (arrives and world.changes) if known else None
        at = world.at if self._falls_silent(leaf) else self._now
        if isinstance(condition, Absent):
            if arrives and not self._lacks_value(leaf):
                return False
            if self._name(leaf.topic) in self._heard:  # the table hears it from Apply on
                return at >= self._now + condition.seconds
        return verdict_at(self._table, self._state, leaf, at)

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
            moving = any(self._may_change(self._table.leaves[leaf].topic) for leaf in plan.changes)
            text = "true now; it fires when a value changes"
            return self._prospect(plan, "with a message" if moving else "with a change", text)
        if verdict is True and waits:
            text = "true now; it fires when it next becomes true"
            return self._prospect(plan, "when next true", text)
        if verdict is True:
            return self._fires(plan, verdicts)
        if verdict is None and waits and not self._moves_by_itself(plan):
            return None  # its first value makes it true without firing, or false
        return self._will_fire(plan)

    def _moves_by_itself(self, plan: RulePlan) -> bool:
        """Whether it may become false and true again while all values stay as they are."""
        return plan.pulses or any(self._table.leaves[index].timer >= 0 for _, index in plan.leaves)

    def _fires(self, plan: RulePlan, verdicts: Mapping[int, Verdict]) -> Prospect:
        hold = plan.hold
        lasts = any(
            self._table.leaves[index].timer >= 0 and verdict is True
            for index, verdict in verdicts.items()
        )
        if lasts or any(map(self._quick, plan.topics)):
            when = f"in {_exactly(hold)} after Apply" if hold else "at once after Apply"
            return self._prospect(plan, "soon", f"true now: it will fire {when}", hold)
        topics = " or ".join(f"/{self._name(topic)}" for topic in plan.topics)
        when = f"{_exactly(hold)} after" if hold else "with"
        text = f"true now: it will fire {when} the next message on {topics}"
        return self._prospect(plan, "with a message", text, hold)

    def _will_fire(self, plan: RulePlan) -> Prospect | None:
        """Tell of a rule that is not true yet, but need not wait for another value to be."""
        unknown: dict[int, Verdict] | None = None
        present = self.verdicts(plan)
        for world in self._worlds(plan):
            verdicts = self._in(plan, world)
            verdict = plan.evaluate(verdicts)
            # What is known now, and too old by then, is no question of now.
            missing = any(verdicts[leaf] is None is present[leaf] for leaf in verdicts)
            if verdict is None and missing and unknown is None:
                unknown = verdicts
            if verdict is not True or not self._triggers(plan, world):
                continue
            if world.at > self._now:
                return self._if_silent(plan, world)
            return self._with_message(plan, world)
        if unknown is None:
            return None
        why = self._unknown(plan, unknown)
        return self._prospect(plan, "unknown", f"not known yet whether it is true now: {why}")

    def _worlds(self, plan: RulePlan) -> Iterator[_World]:
        """The moments at which it can become true by itself, the present one first."""
        dues = {when for _, when in self._silences(plan) if when > self._now}
        for at in (self._now, *sorted(dues)):
            yield _World(at)
            for topic in filter(self._comes, plan.topics):
                yield _World(at, topic)
                if self._may_change(topic):
                    yield _World(at, topic, changes=True)

    def _triggers(self, plan: RulePlan, world: _World) -> bool:
        """Whether a rule fires for being true then."""
        if plan.rule.event.trigger == "change":
            return world.changes and any(
                self._table.leaves[leaf].topic == world.topic for leaf in plan.changes
            )
        if world.topic >= 0 or not plan.hold:
            return True
        return plan.evaluate(self._in(plan, _World(world.at + plan.hold))) is True

    def _with_message(self, plan: RulePlan, world: _World) -> Prospect:
        when = f"{_exactly(plan.hold)} after" if plan.hold else "with"
        text = f"fires {when} the next message on /{self._name(world.topic)}"
        if world.changes:
            return self._prospect(plan, "with a message", f"{text} that brings another value")
        return self._prospect(plan, "with a message", text, plan.hold)

    def _if_silent(self, plan: RulePlan, world: _World) -> Prospect:
        """Tell of a rule that fires unless somebody breaks a silence."""
        left = world.at - self._now + plan.hold
        names = dict.fromkeys(
            self._silent_name(leaf) for leaf, when in self._silences(plan) if when <= world.at
        )
        after = "after Apply"
        if world.topic >= 0:
            after += f" with a message on /{self._name(world.topic)}"
        text = f"will be true: it will fire in {_exactly(left)} {after}"
        text += f" if {' and '.join(names)} stays silent"
        return self._prospect(plan, "if silent", text, left)

    def _silent_name(self, leaf: LeafPlan) -> str:
        condition, name = leaf.condition, f"/{self._name(leaf.topic)}"
        if isinstance(condition, Absent) and self._lacks_value(leaf):
            return describe_signal(condition.signal)  # the topic itself may well speak
        return name

    def _silences(self, plan: RulePlan) -> Iterator[tuple[LeafPlan, float]]:
        """Leaves that time alone changes, and when, unless more comes than is to be expected."""
        for _, index in plan.leaves:
            leaf = self._table.leaves[index]
            if leaf.timer < 0 or not self._falls_silent(leaf):
                continue
            timer = self._table.timers[leaf.timer]
            when = due(timer, self._state)
            if timer.kind == "absent" and self._name(leaf.topic) in self._heard:
                when = self._now + timer.seconds
            if when is not None:
                yield leaf, when

    def _falls_silent(self, leaf: LeafPlan) -> bool:
        """Whether nothing is to be expected in time that keeps a leaf as it is."""
        topic = self._table.topics[leaf.topic]
        if topic.callable:
            return False
        rate, received = self._rates.get(topic.name, 0.0), self._state.received[leaf.topic]
        if received is None or not rate or self._now - received > _MISSED / rate:
            return True
        if leaf.timer < 0:
            return False
        seconds = self._table.timers[leaf.timer].seconds
        return self._lacks_value(leaf) or seconds <= _MISSED / rate

    def _lacks_value(self, leaf: LeafPlan) -> bool:
        """Whether the newest message of its topic does not have the value it asks for."""
        return (
            leaf.probe >= 0
            and self._state.received[leaf.topic] is not None
            and kind_of(self._state.values[leaf.probe]) == "none"
        )

    def _quick(self, topic: int) -> bool:
        """Whether the next message of a topic is not worth waiting for."""
        name = self._name(topic)
        newest = self._heard.get(name)
        if newest is not None:
            return newest.comes
        return self._table.topics[topic].callable or self._rates.get(name, 0.0) > QUICK

    def _comes(self, topic: int) -> bool:
        """Whether messages of a topic come by themselves, or one does."""
        name = self._name(topic)
        return name in self._heard or self._rates.get(name, 0.0) > 0.0

    def _may_change(self, topic: int) -> bool:
        name = self._name(topic)
        newest = self._heard.get(name)
        if newest is not None and newest.comes and not newest.rate:
            return False  # latched, and said once
        return self._comes(topic)

    def _name(self, topic: int) -> str:
        return self._table.topics[topic].name

    def _prospect(
        self, plan: RulePlan, fires: Any, text: str, left: float | None = None
    ) -> Prospect:
        if plan.rule.id in self._running and isinstance(plan.rule.event.mode, Single):
            text += ", unless its actions are still running then"
        if plan.rule.shadow:
            text += " (in shadow: it does nothing)"
        return Prospect(
            rule_id=plan.rule.id, fires=fires, seconds=left, acts=acts(plan.rule), text=text
        )

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
    verb = "is " if prospect.text.startswith("true now") else ""
    return f"'{name}' {verb}{prospect.text}"


def _exactly(duration: float) -> str:
    """A time that somebody may count along with: ``2.0 s``."""
    return f"{duration:.1f} s" if 1.0 <= duration < 9.95 else seconds(duration)
