"""Many drives are counted right, and two tables compared honestly."""

from __future__ import annotations

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binomtest

from kompass.drills.chance import in_words, sign_test
from kompass.drills.compare import compare
from kompass.drills.drive import DriveResult
from kompass.drills.facts import DriveEnded, StopPressed
from kompass.drills.judge import judge
from kompass.drills.names import natural
from kompass.drills.report_json import TableName, make_report
from kompass.drills.requirement import check_requirements, parse_requirements
from kompass.drills.summary import summarize
from tests.drills.drives import (
    arriving,
    faulted,
    firing,
    gave_up,
    recovered,
    refused,
    scenario,
    touched,
    undisturbed,
)

OLD = TableName(name="in force", hash="0" * 64, rules=3)
MAKERS = (recovered, gave_up, touched)


def drives(*kinds: str) -> list[DriveResult]:
    makers = {"r": recovered, "g": gave_up, "t": touched, "u": undisturbed, "n": refused}
    return [makers[kind](f"1-{number}") for number, kind in enumerate("".join(kinds))]


def test_drives_are_counted_by_outcome() -> None:
    found = summarize([*drives("rrgt"), undisturbed("u")])
    assert {kind: n for kind, n in found.outcomes.items() if n} == {
        "arrived": 1, "recovered": 2, "gave_up": 1, "contact": 1,
    }  # fmt: skip
    assert (found.drives, found.disturbed, found.contacts) == (5, 4, 1)
    assert found.recovered == 2
    assert found.came_through == 3
    assert found.recovery_median == pytest.approx(9.0, abs=0.2)
    assert [(rule.rule_id, rule.firings, rule.drives) for rule in found.rules] == [
        ("stuck-unblock", 2, 2)
    ]
    assert [(f.name, f.drives, f.came_through) for f in found.faults] == [("way_blocked", 4, 2)]


@given(st.lists(st.sampled_from(MAKERS), max_size=8), st.randoms(use_true_random=False))
def test_sums_do_not_depend_on_the_order_of_drives(made: list[object], rng: random.Random) -> None:
    found = [make(f"1-{n}") for n, make in enumerate(made)]  # type: ignore[operator]
    shuffled = list(found)
    rng.shuffle(shuffled)
    assert summarize(found) == summarize(shuffled)
    assert sum(summarize(found).outcomes.values()) == len(found)


@given(st.lists(st.sampled_from(MAKERS), min_size=1, max_size=8))
def test_a_table_does_not_differ_from_itself(made: list[object]) -> None:
    found = [make(f"1-{n}") for n, make in enumerate(made)]  # type: ignore[operator]
    same = compare(found, found[::-1])
    assert same.verdict == "same"
    assert same.changes == ()
    assert same.sentence.startswith("No difference in ")
    assert (same.gained, same.lost, same.p_value) == (0, 0, 1.0)


@pytest.mark.parametrize(
    ("made", "sentence"),
    [
        (
            "r" * 16 + "g" * 3 + "u",
            "No difference in 20 drives; recovers in 16 of 19 under either.",
        ),
        ("gg", "No difference in two drives; recovers in 0 of 2 under either."),
        ("uuu", "No difference in three drives; no fault disturbed any."),
        (
            "nn",
            "No difference in two drives; no fault disturbed any; reaches its goals in 0 of 2.",
        ),
    ],
)
def test_where_nothing_differs_the_sentence_says_how_well_both_do(made: str, sentence: str) -> None:
    assert compare(drives(made), drives(made)).sentence == sentence


def test_the_sentence_says_what_matters() -> None:
    before = drives("r" * 41 + "g" * 9)
    after = [*drives("r" * 47 + "g" * 3)[:-1], touched("1-49")]
    found = compare(before, after)
    assert found.sentence == "Recovers in 47 of 50 instead of 41; one new contact."
    assert (found.gained, found.lost) == (6, 0)
    # Six of six is no chance; the contact is one, and shown first.
    assert found.verdict == "mixed"
    assert found.changes[0].scenario == "1-49"
    assert found.changes[0].change == "worse"
    assert "gave up and said why → touched something; one contact instead of none" in (
        found.changes[0].text
    )


@pytest.mark.parametrize(
    ("before", "after", "sentence"),
    [
        (
            "uuuu",
            "nnnn",
            "Reaches its goals in 0 of 4 instead of 4; no fault disturbed any drive.",
        ),
        (
            "nur",
            "uur",
            "Reaches its goals in 3 of 3 instead of 2; recovers in 1 of 1, as before.",
        ),
        (
            "uuuurrrg",
            "uunurrrr",
            "Reaches its goals in 7 of 8, as before; recovers in 4 of 4 instead of 3.",
        ),
    ],
)
def test_a_rule_that_holds_a_robot_back_which_nothing_disturbs_is_told_first(
    before: str, after: str, sentence: str
) -> None:
    assert compare(drives(before), drives(after)).sentence == sentence


def test_slower_ways_are_told() -> None:
    before = [recovered(f"1-{n}", halt=8.0) for n in range(6)]
    after = [
        drive.model_copy(update={"scenario": old.scenario})
        for n, old in enumerate(before)
        for drive in [recovered(f"1-{n}", halt=10.0)]
    ]
    found = compare(before, after)
    assert found.sentence == "Recovers in 6 of 6, as before; arrives 2.0 s later."
    assert (found.slower_pairs, found.faster_pairs) == (6, 0)
    assert found.verdict == "worse"
    assert found.chance.startswith("Of the time it takes: hardly chance: 6 of 6")
    assert found.changes[0].text == (
        "recovered in 11.0 s instead of 9.0 s; arrived after 31.0 s instead of 29.0 s"
    )
    few = compare(before[:2], after[:2])
    assert (few.verdict, few.chance[:33]) == ("may be chance", "Of the time it takes: may be chan")
    assert compare(after, before).sentence == "Recovers in 6 of 6, as before; arrives 2.0 s sooner."


def test_who_recovers_as_soon_and_arrives_later_is_slower_all_the_same() -> None:
    before = recovered(halt=8.0)
    (ended,) = before.goals
    assert ended.ended is not None
    late = before.model_copy(
        update={"goals": (ended.model_copy(update={"ended": ended.ended + 10.0}),)}
    )
    found = compare([before], [late])
    assert found.sentence == "Recovers in 1 of 1, as before; arrives 10.0 s later."
    assert [(one.change, one.text) for one in found.changes] == [
        ("worse", "arrived after 39.0 s instead of 29.0 s")
    ]


def test_a_small_difference_may_be_chance() -> None:
    found = compare(drives("rrrrrgg"), drives("rrrrrrg"))
    assert found.verdict == "may be chance"
    assert found.chance.startswith(
        "May be chance: 1 of 1 drives that come through under one table only point"
    )
    assert "in 100 % of such drills" in found.chance


def test_a_large_difference_is_hardly_chance() -> None:
    better = compare(drives("r" * 5 + "g" * 10), drives("r" * 15))
    assert better.verdict == "better"
    assert better.chance.startswith("Hardly chance: 10 of 10")
    worse = compare(drives("r" * 15), drives("r" * 5 + "g" * 10))
    assert worse.verdict == "worse"


def test_a_new_contact_is_worse_whatever_chance_says() -> None:
    found = compare(drives("rr"), drives("rt"))
    assert found.verdict == "worse"
    assert found.sentence == "Recovers in 1 of 2 instead of 2; one new contact."


def test_only_the_same_scenarios_are_compared() -> None:
    with pytest.raises(ValueError, match="'1-1' was driven under one table only"):
        compare(drives("r"), drives("rr"))
    with pytest.raises(ValueError, match="'1-0' is not the same under both tables"):
        compare([recovered("1-0", halt=8.0)], [recovered("1-0", halt=9.0)])
    with pytest.raises(ValueError, match="'1-0' is there twice"):
        compare([recovered(), recovered()], [recovered()])


@given(st.integers(0, 60), st.integers(0, 60))
def test_the_sign_test_is_the_exact_one(ups: int, downs: int) -> None:
    expected = 1.0 if ups + downs == 0 else binomtest(ups, ups + downs, 0.5).pvalue
    assert sign_test(ups, downs) == pytest.approx(expected, rel=1e-9)
    assert ("May be chance" in in_words(ups, downs, "that differ")) == (
        ups + downs > 0 and expected >= 0.05
    )


def test_no_number_of_pairs_is_negative() -> None:
    with pytest.raises(ValueError, match="give numbers of 0 or more"):
        sign_test(-1, 2)


def test_names_are_sorted_as_a_person_counts() -> None:
    names = ["7-10", "7-9", "7-1", "a", "10-1", "7-01"]
    assert sorted(names, key=natural) == ["a", "7-01", "7-1", "7-9", "7-10", "10-1"]


def test_what_gets_better_and_what_only_differs_is_told() -> None:
    found = compare(drives("tg"), drives("rr"))
    assert found.sentence == "Recovers in 2 of 2 instead of none; one contact fewer."
    assert [change.change for change in found.changes] == ["better", "better"]
    other = judge(
        recovered().scenario,
        [*firing("another", 12.0), *arriving([(9.0, 17.0)]), *faulted("way_blocked", 8.0, 16.0)],
    )
    (change,) = compare([recovered()], [other]).changes
    assert change.change == "other"
    assert change.text == (
        "another fired once instead of never, stuck-unblock fired never instead of once"
    )


def test_as_many_gained_as_lost_is_neither_better_nor_worse() -> None:
    found = compare(drives("rg"), drives("gr"))
    assert found.verdict == "mixed"
    assert found.sentence == "Recovers in 1 of 2, as before."


def test_the_same_firings_with_another_end_are_a_difference() -> None:
    failed = judge(
        recovered().scenario,
        [
            *firing("stuck-unblock", 12.0, ok=False),
            *arriving([(9.0, 17.0)]),
            *faulted("way_blocked", 8.0, 16.0),
        ],
    )
    (change,) = compare([recovered()], [failed]).changes
    assert change.text == "the same rules fired in another order or with another end"


def test_a_slower_way_of_an_undisturbed_robot_is_worse() -> None:
    slow = judge(undisturbed().scenario, arriving([(5.0, 7.0)]))
    found = compare([undisturbed()], [slow])
    assert found.sentence == "No fault disturbed any drive; arrives 2.0 s later."
    assert found.changes[0].text == "arrived after 23.0 s instead of 21.0 s"
    assert found.verdict == "may be chance"


def late(name: str, *, stopped: bool) -> DriveResult:
    """It had arrived when the wall came, and a rule may have pressed STOP for it."""
    *drive, _ = arriving()
    facts = [*drive, *faulted("way_blocked", 30.0, 38.0), DriveEnded(40.0)]
    stop = [StopPressed(30.5, "rule shy", "too near")] if stopped else []
    return judge(scenario(name, [("way_blocked", 30.0, 8.0)]), [*facts, *stop])


def test_a_robot_that_arrives_and_is_left_in_stop_is_told_of() -> None:
    before = [late(f"1-{n}", stopped=False) for n in range(20)]
    after = [late(f"1-{n}", stopped=True) for n in range(20)]
    found = compare(before, after)
    told = "Every fault began when the robot had arrived; ends with STOP in 20 of 20"
    assert found.sentence == f"{told} instead of none."
    assert found.verdict == "worse"
    assert {change.text for change in found.changes} == {"STOP at the end"}
    assert after[0].outcome == "arrived"
    assert after[0].why == (
        "Arrived; no fault disturbed it. STOP by rule shy was in force at the end: too near."
    )
    assert compare(after, before).verdict == "better"
    assert summarize(after).left_stopped == 20
    (checked,) = check_requirements(parse_requirements("left_stopped == 0"), summarize(after))
    assert not checked.met
    report = make_report(recipe="r.py", table=OLD, drives=after)
    assert report.sentence == f"{told}."
