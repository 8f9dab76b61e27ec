"""What a drill must come to is read exactly, refused in a sentence, and judged by how much."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kompass.drills.requirement import (
    COUNTS,
    NAMES,
    OPERATORS,
    SECONDS,
    SHARES,
    BadRequirement,
    Requirement,
    check_requirements,
    exit_code,
    parse_requirements,
)
from kompass.drills.summary import Summary, summarize
from tests.drills.drives import gave_up, recovered, touched, undisturbed


@pytest.fixture(scope="module")
def summary() -> Summary:
    """Of twenty drives that were disturbed nineteen recovered; three more were not; one touched."""
    return summarize(
        [
            *(recovered(f"r{n}") for n in range(18)),
            gave_up("g"),
            touched("t"),
            *(undisturbed(f"u{n}") for n in range(5)),
        ]
    )


def said(text: str, summary: Summary) -> list[str]:
    return [one.text for one in check_requirements(parse_requirements(text), summary)]


def test_what_is_met_and_what_is_not_is_told_with_how_much(summary: Summary) -> None:
    assert said("recovered >= 0.9, contacts == 0, gave_up <= 1, drives >= 30", summary) == [
        "recovered >= 0.9: met, it is 0.900 (18 of 20)",
        "contacts == 0: not met, it is 1, off by 1",
        "gave_up <= 1: met, it is 1",
        "drives >= 30: not met, it is 25, off by 5",
    ]
    assert said("recovery_median < 5 s", summary)[0].startswith(
        "recovery_median < 5: not met, it is 9"
    )


def test_a_whole_number_counts_and_a_decimal_shares(summary: Summary) -> None:
    assert said("recovered >= 18, recovered >= 90 %, recovered > 0.90", summary) == [
        "recovered >= 18: met, it is 18",
        "recovered >= 0.9: met, it is 0.900 (18 of 20)",
        "recovered > 0.9: not met, it is 0.900 (18 of 20)",
    ]
    assert said("came_through == 0.92, arrived >= 1.0", summary) == [
        "came_through == 0.92: met, it is 0.920 (23 of 25)",
        "arrived >= 1.0: not met, it is 0.200 (5 of 25), off by 0.8",
    ]


def test_nothing_is_met_by_nothing() -> None:
    none = summarize([undisturbed()])
    assert said("recovered >= 0.0, recovery_max < 99", none) == [
        "recovered >= 0.0: not met, for it is a share of the drives that a fault disturbed: none",
        "recovery_max < 99: not met, for no drive recovered",
    ]
    assert said("time_to_goal_max < 99", summarize([gave_up()])) == [
        "time_to_goal_max < 99: not met, for no drive came through"
    ]


def test_a_program_ends_with_one_when_anything_is_not_met(summary: Summary) -> None:
    def code(text: str) -> int:
        return exit_code(check_requirements(parse_requirements(text), summary))

    assert code("recovered >= 0.9") == 0
    assert code("recovered >= 0.9, contacts == 0") == 1


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "nothing is required; give for example 'recovered >= 0.95'"),
        (" , ", "nothing is required"),
        ("recovered >= 0.9,", "a comma with nothing beside it"),
        ("recoverd >= 0.9", "there is no 'recoverd'; did you mean 'recovered'? known are"),
        ("speed > 1", "known are came_through, arrived"),
        ("recovered = 1", "'=' is no comparison; for equal write =="),
        ("recovered => 1", "'=>' is no comparison; give one of >= <= == != > <"),
        ("recovered >= many", "'many' is no number of 0 or more"),
        ("recovered >= -1", "'-1' is no number of 0 or more"),
        ("recovered >= 1e3", "'1e3' is no number"),
        ("recovered >= nan", "'nan' is no number"),
        ("recovered >= 0.1234567891", "has too many digits; give at most 9"),
        ("recovered >= 1.5", "no share is above 1"),
        ("recovered >= 101 %", "no share is above 1"),
        ("contacts < 0.5", "contacts is a count, of nothing; give a whole number"),
        ("contacts < 5 %", "contacts is a count"),
        ("contacts < 5 s", "contacts is no time; leave out the 's'"),
        ("recovery_max < 5 %", "recovery_max is a time; give seconds"),
        ("recovered", "is no requirement; give a name, a comparison and a number"),
        ("0.9 <= recovered", "is no requirement"),
        ("recovered >= 0.9 and contacts == 0", "and a comma before the next"),
    ],
)
def test_what_cannot_be_meant_is_refused_in_a_sentence(text: str, why: str) -> None:
    with pytest.raises(BadRequirement) as refused:
        parse_requirements(text)
    assert why in str(refused.value)


def requirements() -> st.SearchStrategy[Requirement]:
    signs = st.sampled_from([*OPERATORS])
    whole = st.integers(0, 10**9 - 1).map(Fraction)
    shares = st.integers(0, 10**9).map(lambda n: Fraction(n, 10**9))
    decimals = st.integers(0, 10**15 - 1).map(lambda n: Fraction(n, 10**6))
    return st.one_of(
        st.builds(Requirement, st.sampled_from([*SHARES]), signs, shares, st.just("share")),
        st.builds(Requirement, st.sampled_from([*SHARES, *COUNTS]), signs, whole, st.just("count")),
        st.builds(Requirement, st.sampled_from([*SECONDS]), signs, decimals, st.just("seconds")),
    )


@given(st.lists(requirements(), min_size=1, max_size=4))
def test_what_is_written_is_read_back(made: list[Requirement]) -> None:
    text = ", ".join(map(str, made))
    assert parse_requirements(text) == tuple(made)


@given(st.text(max_size=40))
def test_any_text_is_read_or_refused(text: str) -> None:
    try:
        found = parse_requirements(text)
    except BadRequirement:
        return
    assert all(one.name in NAMES for one in found)
