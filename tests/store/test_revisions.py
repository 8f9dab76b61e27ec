"""What is stored of revisions."""

import sqlite3
from pathlib import Path

import pytest

from kompass.rules.schema.table import Table
from kompass.store.errors import NoSuchRevision, StaleRevision, StoreClosed
from kompass.store.store import RuleStore
from tests.rules.building import received, rule
from tests.store.tables import BY, RECIPE, Robot, edited


def test_a_revision_says_who_when_why_and_what(robot: Robot) -> None:
    robot.start()
    made = robot.store.append(edited("x"), reason="the cat", **BY)
    assert made == robot.store.revision(2)
    assert (made.author, made.role, made.reason, made.origin) == (
        "ava",
        "engineer",
        "the cat",
        "edit",
    )
    assert (made.parent, made.time, made.outcome) == (1, robot.clock.now, "active")
    assert (made.diff.before, made.diff.after) == (1, 2)
    assert [(c.rule_id, c.kind) for c in made.diff.changes] == [("more", "added")]
    assert robot.store.table(2) == edited("x")


def test_everything_is_there_after_a_restart(robot: Robot) -> None:
    robot.start()
    for number in range(5):
        robot.store.append(edited(str(number)), confirmed=True, **BY)
    before = robot.store.history()
    robot.stop()
    robot.start()
    assert robot.store.history() == before
    assert [robot.store.table(n) for n in range(2, 7)] == [edited(str(n)) for n in range(5)]


def test_history_comes_in_pages_newest_first(robot: Robot) -> None:
    robot.start()
    for number in range(6):
        robot.store.append(edited(str(number)), **BY)
    page = robot.store.history(count=3)
    assert ([r.number for r in page.revisions], page.more) == ([7, 6, 5], True)
    page = robot.store.history(before=5, count=10)
    assert ([r.number for r in page.revisions], page.more) == ([4, 3, 2, 1], False)
    assert (page.active, page.confirmed) == (7, 1)


def test_a_page_of_large_changes_is_cut_and_goes_on_where_it_ended(robot: Robot) -> None:
    robot.start()
    for number in range(6):
        robot.store.append(edited(str(number)), **BY)
    found, before = [], 0
    while True:
        page = robot.store.history(before, 50, largest=1)  # one alone has more than that
        found += [revision.number for revision in page.revisions]
        assert len(page.revisions) == 1
        if not page.more:
            break
        before = found[-1]
    assert found == [7, 6, 5, 4, 3, 2, 1]
    whole = robot.store.history(0, 50, largest=1_000_000)
    assert ([r.number for r in whole.revisions], whole.more) == (found, False)


def test_a_change_from_an_old_revision_is_refused(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("first"), parent=1, **BY)
    with pytest.raises(StaleRevision, match="began from revision 1, and 2 is in force"):
        robot.store.append(edited("second"), parent=1, **BY)
    assert robot.store.active == 2
    assert len(robot.store.history().revisions) == 2


def test_only_the_revision_in_force_can_be_confirmed(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("a"), **BY)
    robot.store.append(edited("b"), **BY)
    with pytest.raises(StaleRevision, match="revision 2 is not in force, 3 is"):
        robot.store.set_confirmed(2, **BY)
    assert robot.store.set_confirmed(3, **BY).outcome == "confirmed"
    assert robot.store.set_confirmed(3, **BY).outcome == "confirmed"  # twice does no harm
    assert robot.outcomes() == {3: "confirmed", 2: "superseded", 1: "confirmed"}


def test_taking_back_restores_the_confirmed_table_as_a_new_revision(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("a"), **BY)
    back = robot.store.take_back("nobody confirmed revision 2 within 60 s")
    assert (back.number, back.origin, back.restores, back.outcome) == (
        3,
        "taken back",
        1,
        "confirmed",
    )
    assert robot.store.table(3) == RECIPE
    assert (robot.store.active, robot.store.confirmed) == (3, 3)
    assert robot.outcomes()[2] == "taken back"


def test_a_rollback_says_what_it_restores(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("a"), confirmed=True, **BY)
    robot.store.append(edited("b"), **BY)
    back = robot.store.append(robot.store.table(2), origin="rollback", restores=2, **BY)
    assert (back.restores, robot.store.table(back.number)) == (2, edited("a"))
    assert robot.outcomes()[3] == "taken back"


def test_a_revision_that_does_not_exist_is_named(robot: Robot) -> None:
    robot.start()
    with pytest.raises(NoSuchRevision, match="there is no revision 9; there are 1 to 1"):
        robot.store.table(9)
    with pytest.raises(NoSuchRevision, match="no revision 0"):
        robot.store.revision(0)


def test_revisions_cannot_be_rewritten(robot: Robot) -> None:
    robot.start()
    robot.stop()
    other = sqlite3.connect(robot.folder / "rules.db")
    for statement in (
        "UPDATE revisions SET author = 'eve'",
        "DELETE FROM revisions",
        "UPDATE rules SET json = '{}'",
        "UPDATE tables SET rules = '[]'",
    ):
        with pytest.raises(sqlite3.IntegrityError, match="never"):
            other.execute(statement)
    other.close()


def test_an_edit_of_one_rule_of_many_stores_one_rule(robot: Robot) -> None:
    rules = [rule(received(f"t{n}"), f"r{n}", note="x" * 1000) for n in range(200)]
    robot.start()
    robot.store.append(Table(rules=tuple(rules)), confirmed=True, **BY)
    robot.stop()
    size = (robot.folder / "rules.db").stat().st_size
    robot.start()
    for number in range(10):
        rules[number] = rules[number].model_copy(update={"note": f"changed {number}"})
        robot.store.append(Table(rules=tuple(rules)), confirmed=True, **BY)
    robot.stop()
    assert (robot.folder / "rules.db").stat().st_size - size < size


def test_a_closed_store_says_so(tmp_path: Path) -> None:
    store = RuleStore.open(tmp_path / "robot")
    store.close()
    store.close()
    with pytest.raises(StoreClosed, match="is closed"):
        store.history()


def test_names_of_robots_make_folders_that_differ() -> None:
    from kompass.store.paths import safe_name

    assert safe_name("tb3-hexagon") == "tb3-hexagon"
    names = [
        "",
        ".",
        "..",
        "../etc",
        "a/b",
        "a_b",
        "a b",
        "Böse",
        "böse",
        "x" * 300,
        "-rf",
        "~",
        "a\0b",
    ]
    safe = [safe_name(name) for name in names]
    assert len(set(safe)) == len(names)
    assert all("/" not in s and not s.startswith((".", "-")) and len(s) < 100 for s in safe)


@pytest.mark.parametrize(
    ("environment", "folder"),
    [
        ({"KOMPASS_DATA_DIR": "/data", "HOME": "/home/ava"}, "/data/r2"),
        ({"XDG_STATE_HOME": "/state", "HOME": "/home/ava"}, "/state/kompass/r2"),
        ({"XDG_STATE_HOME": "relative", "HOME": "/home/ava"}, "/home/ava/.local/state/kompass/r2"),
        ({"HOME": "/home/ava"}, "/home/ava/.local/state/kompass/r2"),
    ],
)
def test_the_folder_of_a_robot(environment: dict[str, str], folder: str) -> None:
    from kompass.store.paths import robot_folder

    assert robot_folder({**environment, "KOMPASS_ROBOT_NAME": "r2"}) == Path(folder)
