"""Files of tests that take longest are given to the workers first."""

from tests.support.order import LONGEST, TESTS, rank


def test_every_file_that_has_a_place_exists_and_has_one() -> None:
    assert [name for name in LONGEST if not (TESTS / name).is_file()] == []
    assert len(set(LONGEST)) == len(LONGEST)


def test_the_longest_come_before_all_others() -> None:
    assert [rank(TESTS / name) for name in LONGEST] == list(range(len(LONGEST)))
    assert rank(TESTS / "test_order.py") == len(LONGEST)
