"""The longest files of tests are given to the workers first; what draws goes to one of them."""

import re

from tests.support.order import DRAWN, LAST, LONGEST, TESTS, rank, scope


def test_every_file_that_has_a_place_exists_and_has_one() -> None:
    placed = [*LONGEST, *LAST]
    assert [name for name in placed if not (TESTS / name).is_file()] == []
    assert len(set(placed)) == len(placed)


def test_the_longest_come_before_all_others_and_drives_after_them() -> None:
    assert [rank(TESTS / name) for name in LONGEST] == list(range(len(LONGEST)))
    others = rank(TESTS / "test_order.py")
    assert others == len(LONGEST)
    assert all(rank(TESTS / name) > others for name in LAST)


def test_what_draws_is_of_one_worker_and_all_else_is_given_out_by_the_file() -> None:
    assert {scope(f"tests/{name}::test_x[1]") for name in DRAWN} == {"drawn"}
    assert scope("tests/rules/test_model.py::test_x") == "tests/rules/test_model.py"


def test_whoever_draws_is_among_those_that_do() -> None:
    drawing = r"\.open\(TOKEN\)|await_scene\(|let_scene_in\(|def test_[^)]*\bpage: ConsolePage"
    for file in (TESTS / "browser").glob("test_*.py"):
        if re.search(drawing, file.read_text(encoding="utf-8")):
            assert f"browser/{file.name}" in DRAWN
