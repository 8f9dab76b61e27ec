"""What differs between two tables, and what two people changed at once."""

import json
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from difflib import SequenceMatcher
from typing import Any

from kompass.rulebook.schema.diff_models import FieldChange, RuleChange, TableDiff
from kompass.rulebook.schema.report import Conflict
from kompass.rulebook.views.wording import describe_action, describe_rule, seconds
from kompass.rules.schema.describe import describe
from kompass.rules.schema.events import Event, Mode
from kompass.rules.schema.table import Rule, Table, rule_hash


def diff_tables(
    before: Table,
    after: Table,
    *,
    before_revision: int | None = None,
    after_revision: int | None = None,
) -> TableDiff:
    """Return what differs, rule by rule.

    Rules that stay come in the order of ``after``, then those that were removed. Where a rule
    comes from (``source``) is no difference.
    """
    old = {rule.id: (place, rule) for place, rule in enumerate(before.rules)}
    moved = _moved([rule.id for rule in before.rules], [rule.id for rule in after.rules])
    changes: list[RuleChange] = []
    for place, rule in enumerate(after.rules):
        if rule.id not in old:
            changes.append(_added(rule))
            continue
        was_place, was = old[rule.id]
        change = _changed(was, rule, (was_place, place) if rule.id in moved else None)
        if change is not None:
            changes.append(change)
    staying = {rule.id for rule in after.rules}
    changes.extend(_removed(rule) for rule in before.rules if rule.id not in staying)
    return TableDiff(before=before_revision, after=after_revision, changes=tuple(changes))


def conflict(
    base: Table,
    theirs: Table,
    yours: Table,
    *,
    expected: int,
    revision: int,
    author: str,
    time: float,
    reason: str,
) -> Conflict:
    """Return what somebody who was too late must be told.

    Parameters
    ----------
    base, theirs, yours
        The table from which both began (revision ``expected``), the one in force (``revision``),
        and the one that was refused.
    author, time, reason
        Of the revision in force; seconds since the epoch.
    """
    their_diff = diff_tables(base, theirs, before_revision=expected, after_revision=revision)
    your_diff = diff_tables(base, yours, before_revision=expected)
    touched = {change.rule_id for change in their_diff.changes if change.kind != "moved"}
    return Conflict(
        expected=expected,
        revision=revision,
        author=author,
        time=time,
        reason=reason,
        theirs=their_diff,
        yours=your_diff,
        both=tuple(
            change.rule_id
            for change in your_diff.changes
            if change.rule_id in touched and change.kind != "moved"
        ),
    )


def field_changes(before: Rule, after: Rule) -> tuple[FieldChange, ...]:
    """Return the fields in which two versions of a rule differ."""
    return tuple(_fields("", _data(before), _data(after)))


def _data(rule: Rule) -> dict[str, Any]:
    return rule.model_dump(mode="json", exclude={"id", "source"})


def _fields(at: str, before: Any, after: Any) -> Iterator[FieldChange]:
    if before == after and type(before) is type(after):
        return
    if isinstance(before, dict) and isinstance(after, dict) and _same_kind(before, after):
        for key in dict.fromkeys((*before, *after)):
            yield from _fields(f"{at}.{key}" if at else key, before.get(key), after.get(key))
    elif _structured(before) and _structured(after):
        yield from _items(at, before, after)
    else:
        yield FieldChange(field=at, before=before, after=after)


def _same_kind(before: dict[str, Any], after: dict[str, Any]) -> bool:
    return before.get("kind") == after.get("kind")


def _structured(value: Any) -> bool:
    return isinstance(value, list) and any(isinstance(item, dict) for item in value)


def _items(at: str, before: list[Any], after: list[Any]) -> Iterator[FieldChange]:
    """Pair the items of two lists, so that one put in front does not change all behind it."""
    keys = [[json.dumps(item, sort_keys=True) for item in items] for items in (before, after)]
    matcher = SequenceMatcher(a=keys[0], b=keys[1], autojunk=False)
    for tag, a, a_end, b, b_end in matcher.get_opcodes():
        if tag == "equal":
            continue
        both = min(a_end - a, b_end - b)
        for offset in range(both):
            yield from _fields(f"{at}[{b + offset}]", before[a + offset], after[b + offset])
        for index in range(a + both, a_end):
            yield FieldChange(field=f"{at}[{index}]", before=before[index])
        for index in range(b + both, b_end):
            yield FieldChange(field=f"{at}[{index}]", after=after[index])


def _moved(before: Sequence[str], after: Sequence[str]) -> set[str]:
    """Return the least number of ids that must move to get from one order to the other."""
    place = {rule_id: index for index, rule_id in enumerate(before)}
    common = [rule_id for rule_id in after if rule_id in place]
    # Longest increasing subsequence by patience sorting: those in it stay where they are.
    tops: list[int] = []
    last: list[str] = []
    previous: dict[str, str | None] = {}
    for rule_id in common:
        pile = bisect_left(tops, place[rule_id])
        previous[rule_id] = last[pile - 1] if pile else None
        if pile == len(tops):
            tops.append(place[rule_id])
            last.append(rule_id)
        else:
            tops[pile], last[pile] = place[rule_id], rule_id
    stay: set[str] = set()
    at = last[-1] if last else None
    while at is not None:
        stay.add(at)
        at = previous[at]
    return set(common) - stay


def _added(rule: Rule) -> RuleChange:
    return RuleChange(
        rule_id=rule.id,
        name=rule.name,
        kind="added",
        semantic=True,
        summary=f"new: {describe_rule(rule)}",
    )


def _removed(rule: Rule) -> RuleChange:
    return RuleChange(
        rule_id=rule.id,
        name=rule.name,
        kind="removed",
        semantic=True,
        summary=f"removed: {describe_rule(rule)}",
    )


def _changed(was: Rule, rule: Rule, places: tuple[int, int] | None) -> RuleChange | None:
    fields = () if was is rule else field_changes(was, rule)
    if not fields and places is None:
        return None
    sentences = list(_sentences(was, rule))
    if places is not None:
        sentences.append(f"place {places[0] + 1} → {places[1] + 1}")
    return RuleChange(
        rule_id=rule.id,
        name=rule.name,
        kind="changed" if fields else "moved",
        semantic=rule_hash(was) != rule_hash(rule),
        summary="; ".join(sentences),
        fields=fields,
    )


_SWITCHES = {
    "enabled": ("switched off", "switched on"),
    "shadow": ("acts again", "in shadow: evaluated, does not act"),
    "protected": ("no longer protected", "protected"),
}


def _sentences(was: Rule, rule: Rule) -> Iterator[str]:
    for switch, words in _SWITCHES.items():
        if getattr(was, switch) != getattr(rule, switch):
            yield words[getattr(rule, switch)]
    if was.name != rule.name:
        yield f'name "{was.name}" → "{rule.name}"'
    yield from _event(was.event, rule.event)
    yield from _actions(was, rule)
    if was.severity != rule.severity:
        yield f"severity {was.severity.name.lower()} → {rule.severity.name.lower()}"
    if was.lane != rule.lane:
        yield f"lane {was.lane} → {rule.lane}"
    if was.note != rule.note:
        yield "note changed"


def _event(was: Event, event: Event) -> Iterator[str]:
    if was.condition != event.condition:
        before, after = describe(was.condition), describe(event.condition)
        yield f"when {before} → {after}" if before != after else "details of the condition"
    if was.trigger != event.trigger:
        yield f"trigger {was.trigger} → {event.trigger}"
    for name in ("hold", "cooldown"):
        a, b = getattr(was, name), getattr(event, name)
        if a != b:
            yield f"{name} {seconds(a)} → {seconds(b)}"
    if was.clear != event.clear:
        texts = ["none" if c is None else describe(c) for c in (was.clear, event.clear)]
        yield f"clears when {texts[0]} → {texts[1]}"
    if was.once != event.once:
        yield "once only" if event.once else "not only once"
    if was.mode != event.mode:
        yield f"while running: {_mode(was.mode)} → {_mode(event.mode)}"
    if was.max_rate != event.max_rate:
        yield f"limit {_limit(was)} → {_limit(event)}"
    if was.first_true_is_edge != event.first_true_is_edge:
        counts = "counts" if event.first_true_is_edge else "does not count"
        yield f"true from the start {counts} as becoming true"


def _mode(mode: Mode) -> str:
    words = {
        "single": "drop what comes",
        "restart": "start again",
        "queued": "let wait",
        "parallel": "run beside",
    }
    size = getattr(mode, "size", None)
    return words[mode.kind] + (f" (up to {size})" if size else "")


def _limit(event: Event) -> str:
    limit = event.max_rate
    return "none" if limit is None else f"{limit.count} in {seconds(limit.window)}"


def _actions(was: Rule, rule: Rule) -> Iterator[str]:
    if was.actions == rule.actions:
        return
    before, after = (
        [describe_action(a) for a in was.actions],
        [describe_action(a) for a in rule.actions],
    )
    if before == after:
        yield "details of the actions"
        return
    matcher = SequenceMatcher(a=before, b=after, autojunk=False)
    for tag, a, a_end, b, b_end in matcher.get_opcodes():
        gone, new = ", ".join(before[a:a_end]), ", ".join(after[b:b_end])
        if tag == "replace":
            yield f"then {gone} → {new}"
        elif tag == "delete":
            yield f"no longer {gone}"
        elif tag == "insert":
            yield f"then also {new}"
