"""Two tables on the same scenarios: what the change makes better, and what worse."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Literal, TypeAlias

from kompass.drills.chance import RARE, in_words, sign_test
from kompass.drills.drive import OUTCOMES, DriveResult, FiringResult
from kompass.drills.names import natural
from kompass.drills.summary import middle
from kompass.rules.schema.model import Model

NOTICED = 0.5  # s by which times must differ to be called faster or slower
Change: TypeAlias = Literal["better", "worse", "other"]
Verdict: TypeAlias = Literal["same", "better", "worse", "mixed", "may be chance"]


class DriveChange(Model):
    """A drive that differs under the two tables.

    Attributes
    ----------
    scenario
        Its name.
    change
        ``better`` and ``worse`` when the outcome is of another grade, a contact or a broken
        invariant more or less, STOP is left in force, the recovery or the whole way faster or
        slower by ``NOTICED``; the first of these that differs decides. Else ``other``.
    text
        How it differs.
    """

    scenario: str
    change: Change
    text: str


class Comparison(Model):
    """The drives of a proposed table beside those of another, pair by pair.

    Attributes
    ----------
    sentence
        The one that matters.
    chance
        A word on chance: of the difference in coming through; where there is none, of that in
        time; empty where there is neither.
    p_value
        Of the exact sign test on the pairs of which only one came through.
    pairs
        Scenarios that were driven under both.
    disturbed
        Those in which a fault disturbed the robot under one table or the other; of these
        ``through_before`` and ``through_after`` reached their goals without touching anything.
    calm_before, calm_after
        Those of the others that did: a rule may hold a robot back that nothing disturbs.
    gained, lost
        Pairs that came through under the proposed table only, and under the other only.
    stopped_before, stopped_after
        Drives at whose end STOP was in force, those that had arrived among them.
    spared
        Whether in all of them the faults began when the robot had arrived.
    slower
        Median of how much longer the ways took [s], over pairs that came through under both.
    """

    verdict: Verdict
    sentence: str
    chance: str
    p_value: float
    pairs: int
    disturbed: int
    through_before: int
    through_after: int
    calm_before: int
    calm_after: int
    gained: int
    lost: int
    contacts_before: int
    contacts_after: int
    broken_before: int
    broken_after: int
    stopped_before: int
    stopped_after: int
    spared: bool
    slower: float | None = None
    slower_pairs: int = 0
    faster_pairs: int = 0
    changes: tuple[DriveChange, ...] = ()


def compare(
    before: Sequence[DriveResult],
    after: Sequence[DriveResult],
    names: Mapping[str, str] = MappingProxyType({}),
) -> Comparison:
    """Compare the drives of a proposed table (``after``) with those of another.

    ``names`` are those by which people know rules; one that has none is called by its id.

    Raises
    ------
    ValueError
        They are not of the same scenarios, or one scenario is there twice.
    """
    pairs = list(_pairs(before, after))
    felt = [pair for pair in pairs if pair[0].disturbed or pair[1].disturbed]
    calm = [pair for pair in pairs if not (pair[0].disturbed or pair[1].disturbed)]
    gained = sum(b.came_through and not a.came_through for a, b in pairs)
    lost = sum(a.came_through and not b.came_through for a, b in pairs)
    delays = [
        b.time_to_goal - a.time_to_goal
        for a, b in pairs
        if a.time_to_goal is not None and b.time_to_goal is not None
    ]
    changes = [change for pair in pairs if (change := _change(*pair, names)) is not None]
    found = Comparison(
        verdict="same",
        sentence="",
        chance="",
        p_value=sign_test(gained, lost),
        pairs=len(pairs),
        disturbed=len(felt),
        through_before=sum(a.came_through for a, _ in felt),
        through_after=sum(b.came_through for _, b in felt),
        calm_before=sum(a.came_through for a, _ in calm),
        calm_after=sum(b.came_through for _, b in calm),
        gained=gained,
        lost=lost,
        contacts_before=sum(len(a.contacts) for a, _ in pairs),
        contacts_after=sum(len(b.contacts) for _, b in pairs),
        broken_before=sum(len(a.broken) for a, _ in pairs),
        broken_after=sum(len(b.broken) for _, b in pairs),
        stopped_before=sum(a.left_stopped for a, _ in pairs),
        stopped_after=sum(b.left_stopped for _, b in pairs),
        spared=bool(pairs) and all(a.spared and b.spared for a, b in pairs),
        slower=middle(sorted(delays)),
        slower_pairs=sum(delay >= NOTICED for delay in delays),
        faster_pairs=sum(delay <= -NOTICED for delay in delays),
        changes=tuple(sorted(changes, key=lambda one: (_ORDER[one.change], natural(one.scenario)))),
    )
    said = {
        "verdict": _verdict(found),
        "sentence": _sentence(found),
        "chance": _chance(found),
    }
    return found.model_copy(update=said)


_ORDER: dict[Change, int] = {"worse": 0, "better": 1, "other": 2}


def _pairs(
    before: Iterable[DriveResult], after: Iterable[DriveResult]
) -> Iterable[tuple[DriveResult, DriveResult]]:
    first, second = _by_name(before), _by_name(after)
    alone = sorted(first.keys() ^ second.keys())
    if alone:
        raise ValueError(
            f"scenario {alone[0]!r} was driven under one table only ({len(alone)} such); drive the "
            "same scenarios under both"
        )
    for name in sorted(first, key=natural):
        if first[name].scenario != second[name].scenario:
            raise ValueError(
                f"scenario {name!r} is not the same under both tables; drive the same ones"
            )
        yield first[name], second[name]


def _by_name(drives: Iterable[DriveResult]) -> dict[str, DriveResult]:
    found: dict[str, DriveResult] = {}
    for drive in drives:
        if drive.scenario.name in found:
            raise ValueError(f"scenario {drive.scenario.name!r} is there twice; rename one")
        found[drive.scenario.name] = drive
    return found


def _change(
    before: DriveResult, after: DriveResult, names: Mapping[str, str]
) -> DriveChange | None:
    """How a pair differs in what matters to people; None when it does not."""
    notes: list[str] = []
    votes: list[int] = [after.grade - before.grade]
    if before.outcome != after.outcome:
        notes.append(f"{OUTCOMES[before.outcome]} → {OUTCOMES[after.outcome]}")
    for name, old, new in (
        ("contact", len(before.contacts), len(after.contacts)),
        ("broken invariant", len(before.broken), len(after.broken)),
    ):
        if old != new:
            notes.append(f"{_several(new, name)} instead of {old or 'none'}")
        votes.append(new - old)
    if before.left_stopped != after.left_stopped and "stopped" not in (
        before.outcome,
        after.outcome,
    ):
        notes.append("STOP at the end" if after.left_stopped else "no STOP at the end")
    votes.append(after.left_stopped - before.left_stopped)
    if before.outcome == after.outcome == "recovered":
        assert before.recovery is not None
        assert after.recovery is not None
        delay = after.recovery - before.recovery
        if abs(delay) >= NOTICED:
            notes.append(f"recovered in {after.recovery:.1f} s instead of {before.recovery:.1f} s")
            votes.append(1 if delay > 0 else -1)
    if before.time_to_goal is not None and after.time_to_goal is not None:
        delay = after.time_to_goal - before.time_to_goal
        if abs(delay) >= NOTICED:
            notes.append(
                f"arrived after {after.time_to_goal:.1f} s instead of {before.time_to_goal:.1f} s"
            )
            votes.append(1 if delay > 0 else -1)
    if _did(before) != _did(after):
        notes.append(_other_firings(before, after, names))
    if not notes:
        return None
    # The gravest of what differs decides; so a contact is not made good by a faster recovery.
    decisive = next((vote for vote in votes if vote), 0)
    change: Change = "worse" if decisive > 0 else "better" if decisive < 0 else "other"
    return DriveChange(scenario=after.scenario.name, change=change, text="; ".join(notes))


def _did(drive: DriveResult) -> list[tuple[str, bool | None]]:
    return [(firing.rule_id, firing.ok) for firing in drive.firings if not firing.shadow]


def _other_firings(before: DriveResult, after: DriveResult, names: Mapping[str, str]) -> str:
    def count(firings: Iterable[FiringResult]) -> dict[str, int]:
        counted: dict[str, int] = {}
        for firing in firings:
            if not firing.shadow:
                counted[firing.rule_id] = counted.get(firing.rule_id, 0) + 1
        return counted

    old, new = count(before.firings), count(after.firings)
    notes = [
        f"{_called(rule, names)} fired {_times(new.get(rule, 0))} instead of "
        f"{_times(old.get(rule, 0))}"
        for rule in sorted(old.keys() | new.keys())
        if old.get(rule, 0) != new.get(rule, 0)
    ]
    return ", ".join(notes) or "the same rules fired in another order or with another end"


def _called(rule: str, names: Mapping[str, str]) -> str:
    """A name may be a sentence, so that it stands in quotation marks."""
    return f"“{names[rule]}”" if names.get(rule) else rule


def _verdict(found: Comparison) -> Verdict:
    graver = max(found.contacts_after - found.contacts_before, 0) + max(
        found.broken_after - found.broken_before, 0
    )
    if graver:
        # A contact is no matter of chance: this drive can be looked at.
        return "mixed" if found.gained > found.lost and found.p_value < RARE else "worse"
    if found.gained + found.lost:
        ups, downs = found.gained, found.lost
    else:
        kinds = [change.change for change in found.changes]
        ups, downs = kinds.count("better"), kinds.count("worse")
    if not ups + downs:
        return "same"
    if ups == downs:
        return "mixed"
    if sign_test(ups, downs) >= RARE:
        return "may be chance"
    return "better" if ups > downs else "worse"


def _chance(found: Comparison) -> str:
    if found.gained + found.lost:
        return in_words(found.gained, found.lost, "that come through under one table only")
    if found.slower_pairs + found.faster_pairs:
        said = in_words(found.faster_pairs, found.slower_pairs, "that take longer under one")
        return f"Of the time it takes: {said[0].lower()}{said[1:]}"
    return ""


def _sentence(found: Comparison) -> str:
    if not found.pairs:
        return "No drive was compared."
    parts: list[str] = []
    through = found.through_after + found.calm_after
    if not found.changes:
        # Neither table did better; whether both did well is another matter.
        parts.append(f"No difference in {_several(found.pairs, 'drive')}")
        if found.disturbed:
            parts.append(f"recovers in {found.through_after} of {found.disturbed} under either")
        else:
            parts.append(_undisturbed(found, "it" if found.pairs == 1 else "any"))
            if through < found.pairs:
                parts.append(f"reaches its goals in {through} of {found.pairs}")
        return "; ".join(parts) + "."
    if found.calm_after != found.calm_before:
        # Of a robot that nothing disturbs: what a rule does to it comes before all else.
        instead = _instead(found.through_before + found.calm_before, through)
        parts.append(f"reaches its goals in {through} of {found.pairs}{instead}")
    if found.disturbed:
        instead = _instead(found.through_before, found.through_after)
        parts.append(f"recovers in {found.through_after} of {found.disturbed}{instead}")
    else:
        parts.append(_undisturbed(found, "any drive"))
    if found.stopped_after != found.stopped_before:
        instead = _instead(found.stopped_before, found.stopped_after)
        parts.append(f"ends with STOP in {found.stopped_after} of {found.pairs}{instead}")
    if found.slower is not None and abs(found.slower) >= NOTICED:
        # Of the whole way, which is not the recovery: a fallback may drive faster ever after.
        parts.append(
            f"arrives {abs(found.slower):.1f} s {'later' if found.slower > 0 else 'sooner'}"
        )
    for name, old, new in (
        ("contact", found.contacts_before, found.contacts_after),
        ("broken invariant", found.broken_before, found.broken_after),
    ):
        if new > old:
            parts.append(_several(new - old, f"more {name}" if old else f"new {name}"))
        elif new < old:
            parts.append(_several(old - new, f"{name} fewer", f"{name}s fewer"))
    said = "; ".join(parts)
    return f"{said[0].upper()}{said[1:]}."


def _undisturbed(found: Comparison, what: str) -> str:
    if found.spared:
        return "every fault began when the robot had arrived"
    return f"no fault disturbed {what}"


def _instead(before: int, after: int) -> str:
    return f" instead of {before or 'none'}" if after != before else ", as before"


_WORDS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")


def _several(number: int, one: str, many: str = "") -> str:
    word = _WORDS[number] if number < len(_WORDS) else str(number)
    return f"{word} {one if number == 1 else many or one + 's'}"


def _times(number: int) -> str:
    return {0: "never", 1: "once", 2: "twice"}.get(number, f"{number} times")
