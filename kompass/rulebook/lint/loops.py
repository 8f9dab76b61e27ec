"""Rules that make themselves fire again, alone or in a circle."""

from collections.abc import Collection, Iterable, Iterator, Sequence

from kompass.rulebook.lint.context import LintContext
from kompass.rulebook.schema.report import Finding
from kompass.rules.schema.actions import Publish, component_of
from kompass.rules.schema.conditions import leaves, topic_of
from kompass.rules.schema.table import Rule

# A loop with at least this much rest in it, in seconds, is a retry and not a runaway.
CALM = 1.0


def status_topics(components: Iterable[str]) -> dict[str, str]:
    """Return the topics on which components tell how they are, with the component of each."""
    found = {}
    for name in components:
        bare = name.removeprefix("/")
        found[f"{bare}/status"] = found[f"{bare}_status"] = name
    return found


def loops(rules: Sequence[Rule], context: LintContext) -> Iterator[Finding]:
    """Find rules that trigger themselves, and circles of rules that trigger each other."""
    listening: dict[str, list[int]] = {}
    for index, rule in enumerate(rules):
        for topic in {topic_of(leaf) for _, leaf in leaves(rule.event.condition)}:
            listening.setdefault(topic, []).append(index)
    edges: list[dict[int, str]] = []
    for rule in rules:
        targets: dict[int, str] = {}
        for topic, how in _affected(rule, listening, context):
            for index in listening.get(topic, ()):
                targets.setdefault(index, how)
        edges.append(targets)
    for index, rule in enumerate(rules):
        if index in edges[index] and _restless([rule]):
            yield _itself(rule, edges[index][index])
    for circle in _circles(edges):
        members = [rules[index] for index in circle]
        if _restless(members):
            yield _circle(members)


def _affected(
    rule: Rule, listening: Collection[str], context: LintContext
) -> Iterator[tuple[str, str]]:
    """Walk the topics on which actions of a rule make a message appear, and say by what."""
    for action in rule.actions:
        if isinstance(action, Publish):
            yield action.topic, f"it publishes on /{action.topic}"
        name = component_of(action)
        if name is None:
            continue
        for topic in status_topics([name]):
            if topic in listening:
                yield topic, f"it acts on {name}, whose status it looks at"
        for topic in context.publishes.get(name, ()):
            yield topic, f"it acts on {name}, which publishes on /{topic}"


def _restless(rules: Sequence[Rule]) -> bool:
    """Whether a loop of rules goes on fast and by itself."""
    if any(rule.event.once or rule.event.max_rate for rule in rules):
        return False
    # An edge ends with the condition staying true; a circle of edges may still swing.
    if len(rules) == 1 and rules[0].event.trigger == "edge":
        return False
    return sum(rule.event.cooldown + rule.event.hold for rule in rules) < CALM


def _itself(rule: Rule, how: str) -> Finding:
    return Finding(
        level="lint",
        code="self-trigger",
        rule_id=rule.id,
        field="actions",
        value=None,
        text=f"it may make itself fire again without rest: {how}",
        remedy=f"give it a cooldown of {CALM:g} s or more, or trigger 'edge'",
    )


def _circle(members: Sequence[Rule]) -> Finding:
    names = [rule.name or rule.id for rule in members]
    return Finding(
        level="lint",
        code="self-trigger",
        rule_id=members[0].id,
        field="actions",
        value=None,
        text=f"rules may make each other fire without rest: {' → '.join([*names, names[0]])}",
        remedy=f"give one of them a cooldown of {CALM:g} s or more",
    )


def _circles(edges: Sequence[Collection[int]]) -> list[list[int]]:
    """Return the groups of two or more nodes that reach each other (Tarjan 1972, iterative)."""
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    stack: list[int] = []
    on_stack: set[int] = set()
    found: list[list[int]] = []
    for root in range(len(edges)):
        if root in index:
            continue
        work = [(root, iter(sorted(edges[root])))]
        index[root] = low[root] = len(index)
        stack.append(root)
        on_stack.add(root)
        while work:
            node, targets = work[-1]
            for target in targets:
                if target not in index:
                    index[target] = low[target] = len(index)
                    stack.append(target)
                    on_stack.add(target)
                    work.append((target, iter(sorted(edges[target]))))
                    break
                if target in on_stack:
                    low[node] = min(low[node], index[target])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    group = []
                    while True:
                        member = stack.pop()
                        on_stack.discard(member)
                        group.append(member)
                        if member == node:
                            break
                    if len(group) > 1:
                        found.append(sorted(group))
    return found
