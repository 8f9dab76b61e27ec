"""What is probably not meant so: forbids nothing, and says what to do instead."""

from collections.abc import Iterable, Iterator, Mapping

from pydantic import JsonValue

from kompass.rulebook.lint.conflicts import contradictions
from kompass.rulebook.lint.context import LintContext, TopicFacts
from kompass.rulebook.lint.loops import loops, status_topics
from kompass.rulebook.schema.report import Finding
from kompass.rulebook.views.wording import seconds
from kompass.rules.checks.check_calls import nearest
from kompass.rules.checks.field_values import foregone
from kompass.rules.checks.problem import Problem
from kompass.rules.schema.actions import Action, CallService, CancelGoal, Publish, SendGoal
from kompass.rules.schema.conditions import (
    Absent,
    AllOf,
    CallableCondition,
    Changed,
    Compare,
    Condition,
    Leaf,
    Not,
    Rate,
    Received,
    TreePath,
    children,
    leaves,
    timeout_of,
    topic_of,
)
from kompass.rules.schema.describe import describe
from kompass.rules.schema.signals import path_text
from kompass.rules.schema.table import Rule, Table

_QUICK = 1.0  # Hz from which messages come by themselves and not because a person did something


def findings_of(problems: Iterable[Problem]) -> list[Finding]:
    """Return the problems of :func:`kompass.rules.checks.check.check_table` as errors."""
    return [
        Finding(
            level="error",
            code=problem.code,
            rule_id=problem.rule_id,
            field=problem.field,
            value=problem.value,
            text=problem.text,
            remedy=problem.remedy,
        )
        for problem in problems
    ]


def lint_table(table: Table, context: LintContext) -> list[Finding]:
    """Return what is to be thought about, rule by rule; disabled rules are left alone."""
    rules = [rule for rule in table.rules if rule.enabled]
    found = [finding for rule in rules for finding in _rule(rule, context)]
    found.extend(loops(rules, context))
    found.extend(contradictions(rules))
    place = {rule.id: index for index, rule in enumerate(table.rules)}
    return sorted(found, key=lambda finding: place[finding.rule_id])


def _lint(rule: Rule, code: str, field: str, value: JsonValue, text: str, remedy: str) -> Finding:
    return Finding(
        level="lint",
        code=code,
        rule_id=rule.id,
        field=field,
        value=value,
        text=text,
        remedy=remedy,
    )


def _rule(rule: Rule, context: LintContext) -> Iterator[Finding]:
    yield from _now(rule, context)
    yield from _level(rule, context)
    own_status = status_topics(context.components or ())
    yield from _once(rule)
    yield from _hiccup(rule, own_status)
    yield from _clear(rule)
    yield from _negated(rule, context)
    said: set[tuple[str, str]] = set()
    for where, leaf in _leaves(rule):
        yield from _foregone(rule, where, leaf, context)
        for finding in _leaf(rule, where, leaf, context, own_status):
            # Two leaves on one topic: what is said of the topic is said once.
            key = (finding.code, topic_of(leaf))
            if key not in said:
                said.add(key)
                yield finding
    for index, action in enumerate(rule.actions):
        yield from _target(rule, f"actions[{index}]", action, context)
        yield from _endless(rule, f"actions[{index}]", action)


# -- when it fires --------------------------------------------------------------------------------


def _now(rule: Rule, context: LintContext) -> Iterator[Finding]:
    if context.verdicts.get(rule.id) is not True or rule.event.trigger == "change":
        return
    hold = rule.event.hold
    when = f"{seconds(hold)} after it is applied" if hold else "as soon as it is applied"
    if rule.event.trigger == "edge" and not rule.event.first_true_is_edge:
        return
    yield _lint(
        rule,
        "true-now",
        "event.condition",
        describe(rule.event.condition),
        f"its condition is true right now: it fires {when}",
        "apply it in shadow first, or wait until the condition is false",
    )


def _level(rule: Rule, context: LintContext) -> Iterator[Finding]:
    event = rule.event
    if event.trigger != "level" or event.cooldown or event.once or event.max_rate or event.clear:
        return
    topics = {topic_of(leaf) for _, leaf in leaves(event.condition)}
    rates = [_facts(context, topic).rate for topic in topics]
    quick = any(rate is not None and rate > _QUICK for rate in rates)
    if _asks_for_messages(event.condition) and not quick:
        return  # a click, a goal: each message is meant to be answered
    fastest = max((rate for rate in rates if rate is not None), default=None)
    often = "with every message" if fastest is None else f"up to {fastest:.3g} times a second"
    yield _lint(
        rule,
        "no-cooldown",
        "event.cooldown",
        event.cooldown,
        f"while its condition is true it fires {often}",
        "give it a cooldown, or trigger 'edge' to fire once when it becomes true",
    )


def _asks_for_messages(condition: Condition) -> bool:
    """Whether it can be true only for the one message that arrives."""
    if isinstance(condition, AllOf):
        return any(map(_asks_for_messages, condition.conditions))
    return isinstance(condition, (Received, Changed))


def _once(rule: Rule) -> Iterator[Finding]:
    if rule.event.once and (rule.protected or rule.lane == "safety"):
        what = "protected" if rule.protected else "of the safety lane"
        yield _lint(
            rule,
            "once-safety",
            "event.once",
            True,
            f"a rule that is {what} fires once, and then guards nothing until the next start",
            "give it a cooldown instead",
        )


def _hiccup(rule: Rule, own_status: Mapping[str, str]) -> Iterator[Finding]:
    """Once, without a hold, on what comes and goes by itself when a machine is busy."""
    event = rule.event
    if not event.once or event.hold or event.trigger == "change":
        return
    for _, leaf in leaves(event.condition):
        status = isinstance(leaf, Compare) and topic_of(leaf) in own_status
        if status or isinstance(leaf, (Absent, Rate)):
            yield _lint(
                rule,
                "once-hiccup",
                "event.once",
                True,
                f"it fires once, and '{describe(leaf)}' may be true for a moment while the machine "
                "is busy: then it is used up, and the real failure fires nothing",
                "give it a hold, e.g. 1 s",
            )
            return


def _clear(rule: Rule) -> Iterator[Finding]:
    event = rule.event
    if event.clear is not None and event.clear == event.condition:
        yield _lint(
            rule,
            "never-clears",
            "event.clear",
            describe(event.clear),
            "it is to be armed again by what must be false for that",
            "give another bound, e.g. the same value with some distance",
        )


def _negated(rule: Rule, context: LintContext) -> Iterator[Finding]:
    silences = {topic_of(leaf) for _, leaf in leaves(rule.event.condition) if leaf.kind == "absent"}
    for path, leaf in _under_not(rule.event.condition):
        topic = topic_of(leaf)
        if timeout_of(leaf) is None or topic in silences or _facts(context, topic).latched:
            continue
        yield _lint(
            rule,
            "not-of-silence",
            _where("event.condition", rule.event.condition, path),
            describe(leaf),
            f"while /{topic} is silent, 'not {describe(leaf)}' is unknown and the rule does not "
            "fire",
            f"if silence is to count, add 'or absent' for /{topic}",
        )
        return


def _under_not(condition: Condition, at: TreePath = ()) -> Iterator[tuple[TreePath, Leaf]]:
    for index, child in enumerate(children(condition)):
        if isinstance(condition, Not):
            yield from leaves(child, (*at, index))
        else:
            yield from _under_not(child, (*at, index))


# -- what it looks at -----------------------------------------------------------------------------


def _leaves(rule: Rule) -> Iterator[tuple[str, Leaf]]:
    conditions = {"event.condition": rule.event.condition, "event.clear": rule.event.clear}
    for root, condition in conditions.items():
        if condition is not None:
            for path, leaf in leaves(condition):
                yield _where(root, condition, path), leaf


def _where(root: str, condition: Condition, path: TreePath) -> str:
    for index in path:
        step = ".condition" if isinstance(condition, Not) else f".conditions[{index}]"
        root, condition = root + step, children(condition)[index]
    return root


def _facts(context: LintContext, topic: str) -> TopicFacts:
    return (context.topics or {}).get(topic, TopicFacts())


def _leaf(
    rule: Rule, where: str, leaf: Leaf, context: LintContext, own_status: Mapping[str, str]
) -> Iterator[Finding]:
    if isinstance(leaf, CallableCondition) or context.topics is None:
        return
    topic = topic_of(leaf)
    at = where if isinstance(leaf, Rate) else f"{where}.signal"
    facts = context.topics.get(topic)
    if facts is None or not facts.publishers:
        if not isinstance(leaf, Absent):
            heard = [name for name, known in context.topics.items() if known.publishers]
            near = nearest(topic, heard, "start the node that publishes it")
            text = f"nobody publishes on /{topic}"
            yield _lint(rule, "no-topic", f"{at}.topic", topic, text, near)
        return
    kind = leaf.type if isinstance(leaf, Rate) else leaf.signal.type
    if kind and facts.type and kind != facts.type:
        yield _lint(
            rule,
            "other-type",
            f"{at}.type",
            kind,
            f"/{topic} carries {facts.type}: the rule would hear nothing",
            f"set the type to {facts.type}",
        )
    timeout = timeout_of(leaf)
    if timeout is not None and isinstance(leaf, Compare):
        yield from _timeout(rule, where, topic, timeout, facts, topic in own_status)
    if isinstance(leaf, Absent) and facts.rate and leaf.seconds < 2.0 / facts.rate:
        yield _lint(
            rule,
            "rate-vs-absence",
            f"{where}.seconds",
            leaf.seconds,
            f"messages on /{topic} come every {seconds(1 / facts.rate)}: it is absent that long "
            "again and again",
            f"set it to {_round_up(3.0 / facts.rate)} s or more",
        )
    if isinstance(leaf, (Compare, Changed)) and facts.rate and 0 < rule.event.hold < 1 / facts.rate:
        yield _lint(
            rule,
            "hold-vs-rate",
            "event.hold",
            rule.event.hold,
            f"messages on /{topic} come every {seconds(1 / facts.rate)}: a single one holds that "
            "long",
            f"set it to {_round_up(2.0 / facts.rate)} s or more",
        )


def _foregone(rule: Rule, where: str, leaf: Leaf, context: LintContext) -> Iterator[Finding]:
    """A bound beyond all that an integer can be."""
    if not isinstance(leaf, Compare) or leaf.signal.aggregate or leaf.tolerance:
        return
    found = context.messages and context.messages.field_type(leaf.signal.type, leaf.signal.path)
    known = foregone(found, leaf.operator, leaf.value) if found else None
    if known is not None:
        truth, what = known
        value: JsonValue = [*leaf.value] if isinstance(leaf.value, tuple) else leaf.value
        yield _lint(
            rule,
            "always-true" if truth else "never-true",
            f"{where}.value",
            value,
            f"'{path_text(leaf.signal.path)}' is {what}: this is {'always' if truth else 'never'} "
            "true",
            "give a value within these bounds",
        )


def _timeout(
    rule: Rule, where: str, topic: str, timeout: float, facts: TopicFacts, is_status: bool
) -> Iterator[Finding]:
    field = f"{where}.signal.timeout"
    slow = facts.rate is not None and facts.rate * timeout < 1.0
    if facts.latched and (slow or (facts.rate is None and not is_status)):
        yield _lint(
            rule,
            "latched-timeout",
            field,
            timeout,
            f"/{topic} is latched: its last message stays true, but counts for {seconds(timeout)} "
            "only",
            "set the timeout to null, so that the last message counts until the next",
        )
    elif facts.rate and timeout < 2.0 / facts.rate:
        yield _lint(
            rule,
            "rate-vs-timeout",
            field,
            timeout,
            f"messages on /{topic} come every {seconds(1 / facts.rate)} and count for "
            f"{seconds(timeout)}: the condition is unknown again and again",
            f"set the timeout to {_round_up(3.0 / facts.rate)} s or more",
        )


def _round_up(value: float) -> float:
    return float(f"{value * 1.05:.2g}")


# -- what it does ---------------------------------------------------------------------------------


def _target(rule: Rule, where: str, action: Action, context: LintContext) -> Iterator[Finding]:
    if isinstance(action, CallService):
        offered, name, field = context.services, action.service, "service"
        text, otherwise = f"no node offers the service /{name}", "start the node that offers it"
    elif isinstance(action, (SendGoal, CancelGoal)):
        offered, name, field = context.actions, action.action, "action"
        text, otherwise = f"no node serves the action /{name}", "start the node that serves it"
    else:
        return
    if offered is None:
        return
    if name not in offered:
        near = nearest(name, offered, otherwise)
        yield _lint(rule, f"no-{field}", f"{where}.{field}", name, text, near)
    elif not isinstance(action, CancelGoal) and action.type not in offered[name]:
        there = " and ".join(offered[name])
        yield _lint(
            rule,
            f"{field}-type",
            f"{where}.type",
            action.type,
            f"the {field} /{name} is there, but of type {there}",
            f"set the type to {there}",
        )


def _endless(rule: Rule, where: str, action: Action) -> Iterator[Finding]:
    if not isinstance(action, Publish) or action.rate is None or action.period is not None:
        return
    if action.timeout is None and rule.event.mode.kind in ("single", "queued"):
        yield _lint(
            rule,
            "endless",
            f"{where}.period",
            None,
            f"it publishes on /{action.topic} for ever: the rule stays busy and fires no more",
            "give a period, or mode 'restart'",
        )
