"""Damaged, foreign, newer, busy, full and read-only files: said clearly, and nothing is lost."""

import os
import shlex
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from kompass.rules.schema.table import Table
from kompass.store.backup import read_backup
from kompass.store.errors import StoreBusy, StoreCorrupt, StoreTooNew, StoreUnwritable
from kompass.store.store import RuleStore
from tests.rules.building import received, rule
from tests.store.tables import BY, RECIPE, Robot, edited, entry
from tests.support.disk import Databases


def grown(robot: Robot) -> Path:
    """A store with some history, closed; its main file."""
    robot.start()
    for number in range(20):
        robot.store.append(edited(str(number)), confirmed=True, **BY)
    robot.stop()
    return robot.folder / "rules.db"


@pytest.mark.parametrize(
    "how", ["not SQLite", "empty", "cut in half", "a page of zeros", "foreign"]
)
def test_a_damaged_file_is_set_aside_and_said(robot: Robot, how: str) -> None:
    file = grown(robot)
    good = file.read_bytes()
    damaged = {
        "not SQLite": b"hello" * 1000,
        "empty": b"",
        "cut in half": good[: len(good) // 2],
        "a page of zeros": good[:4096] + bytes(4096) + good[8192:],
        "foreign": None,
    }[how]
    if damaged is None:
        file.unlink()
        with sqlite3.connect(file) as other:
            other.execute("CREATE TABLE mine (x)")
        other.close()
        damaged = file.read_bytes()
    file.write_bytes(damaged)
    boot = robot.start()
    (aside,) = robot.folder.glob("rules.db.corrupt-*")
    assert aside.read_bytes() == damaged
    assert "rules.db was damaged" in boot.notice
    assert str(aside) in boot.notice
    # What was confirmed is in a file of its own too, and no number means another table now.
    assert boot.table == edited("19")
    assert "last confirmed revision 21, which is now revision 23" in boot.notice
    assert robot.store.append(edited("works"), confirmed=True, **BY).number == 24


def test_numbers_go_on_through_damage_upon_damage(robot: Robot) -> None:
    file = grown(robot)
    for number in (23, 25):
        file.write_bytes(b"hello")
        robot.start()
        assert robot.store.active == number
        robot.stop()


def test_a_copy_that_was_put_off_is_made_when_asked_for_and_at_the_end(robot: Robot) -> None:
    robot.start()
    for number, text in ((2, "x"), (3, "y")):
        robot.store.append(edited(text), confirmed=True, copied=False, **BY)
        before = read_backup(robot.folder)
        assert before is not None
        assert before.revision == number - 1
        if number == 2:
            robot.store.keep_copy()
    robot.stop()
    (robot.folder / "rules.db").write_bytes(b"hello")
    assert robot.start().table == edited("y")


def test_a_damaged_history_without_a_copy_ends_with_the_recipe(robot: Robot) -> None:
    file = grown(robot)
    file.write_bytes(b"hello")
    (robot.folder / "confirmed.json").write_text('{"half')
    boot = robot.start()
    assert boot.table == RECIPE
    assert "the recipe's table is in force" in boot.notice


def test_revisions_of_the_journal_keep_their_meaning_after_damage(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("x"), **BY)
    robot.store.record_firing(entry(revision=2))
    robot.stop()
    (robot.folder / "rules.db").write_bytes(b"hello")
    (robot.folder / "confirmed.json").unlink()
    assert robot.start().revision == 3


def test_after_damage_and_a_change_of_the_recipe_the_edits_are_offered(robot: Robot) -> None:
    file = grown(robot)
    file.write_bytes(b"hello")
    robot.recipe = Table(rules=(*RECIPE.rules, rule(received("map"), "map", source="recipe")))
    boot = robot.start()
    assert boot.table == robot.recipe
    assert boot.merge is not None
    assert "more" in [rule.id for rule in boot.merge.table.rules]


def test_a_history_deleted_by_a_person_is_not_brought_back(robot: Robot) -> None:
    file = grown(robot)
    file.unlink()
    boot = robot.start()
    assert (boot.table, boot.revision, boot.notice) == (RECIPE, 1, "")


def test_a_copy_that_cannot_be_written_does_not_stop_an_edit(
    robot: Robot, caplog: pytest.LogCaptureFixture
) -> None:
    robot.start()
    (robot.folder / "confirmed.json").unlink()
    (robot.folder / "confirmed.json").mkdir()
    robot.store.append(edited("x"), confirmed=True, **BY)
    assert "cannot write" in caplog.text
    robot.stop()
    assert robot.start().table == edited("x")


def test_a_database_that_is_gone_while_its_log_is_not_is_said(robot: Robot) -> None:
    robot.start()
    robot.store.append(edited("x"), confirmed=True, **BY)
    log = (robot.folder / "rules.db-wal").read_bytes()
    robot.crash()
    (robot.folder / "rules.db").unlink()
    (robot.folder / "rules.db-wal").write_bytes(log)
    assert "only its write-ahead log is left" in robot.start().notice
    (aside,) = robot.folder.glob("rules.db.corrupt-*-wal")
    assert aside.read_bytes() == log


def test_a_rule_that_was_tampered_with_is_not_put_in_force(robot: Robot) -> None:
    file = grown(robot)
    other = sqlite3.connect(file)
    other.executescript(
        "DROP TRIGGER rules_stay; UPDATE rules SET json = replace(json, '\"19\"', '\"99\"');"
    )
    other.close()
    boot = robot.start()
    assert boot.table == edited("18")  # the newest that is whole
    assert "revision 21 is damaged: rule 2 is not what was written" in boot.notice
    with pytest.raises(StoreCorrupt, match="revision 21 is damaged"):
        robot.store.table(21)


def test_a_damaged_journal_does_not_touch_the_revisions(robot: Robot) -> None:
    grown(robot)
    (robot.folder / "journal.db").write_bytes(b"no journal at all")
    boot = robot.start()
    assert boot.table == edited("19")
    assert "journal.db was damaged" in boot.notice
    robot.store.record_firing(entry())
    assert len(robot.store.journal().firings) == 1


def test_a_file_of_a_newer_release_is_left_alone(robot: Robot) -> None:
    file = grown(robot)
    other = sqlite3.connect(file)
    other.execute("PRAGMA user_version = 99")
    other.close()
    before = file.read_bytes()
    with pytest.raises(
        StoreTooNew, match=r"newer release \(schema 99, this one knows 1\); install"
    ):
        robot.start()
    assert file.read_bytes() == before
    assert not list(robot.folder.glob("*.corrupt-*"))


def test_a_second_writer_is_told_who_the_first_is(robot: Robot) -> None:
    robot.start()
    with pytest.raises(StoreBusy, match=rf"in use by process {os.getpid()}; .*--data-dir"):
        RuleStore.open(robot.folder)
    robot.crash()
    robot.start()


@pytest.mark.parametrize("place", ["/proc/kompass", "/dev/null/robot"])
def test_a_folder_that_cannot_be_written_is_named(place: str) -> None:
    with pytest.raises(StoreUnwritable, match=rf"cannot write {place}.*--data-dir"):
        RuleStore.open(Path(place))


def test_on_a_full_disk_the_old_table_stays(databases: Databases, robot: Robot) -> None:
    robot.start()
    databases.fill("rules.db")
    good = 1
    try:
        for _ in range(100):
            good = robot.store.append(edited("x" * 1000), confirmed=True, **BY).number
    except StoreUnwritable as error:
        assert "full; free some space" in str(error)  # noqa: PT017 - not the first one need fail
    assert robot.store.active == robot.store.confirmed == good < 100
    databases.make_room("rules.db")
    robot.store.append(edited("there is room again"), confirmed=True, **BY)
    robot.stop()
    assert robot.start().table == edited("there is room again")


def test_on_a_disk_that_became_read_only_the_old_table_stays(
    databases: Databases, robot: Robot
) -> None:
    robot.start()
    databases.write_protect("rules.db")
    with pytest.raises(StoreUnwritable, match="make the disk and the file writable"):
        robot.store.append(edited("x"), **BY)
    with pytest.raises(StoreUnwritable):
        robot.store.take_back("x")
    assert (robot.store.active, robot.store.confirmed) == (1, 1)
    assert robot.store.table(1) == RECIPE


def test_a_journal_on_a_full_disk_loses_entries_and_says_so(
    databases: Databases, robot: Robot, caplog: pytest.LogCaptureFixture
) -> None:
    robot.start()
    robot.store.flush()
    databases.fill("journal.db")
    for _ in range(50):
        robot.store.record_firing(entry(text="x" * 10_000))
    robot.store.flush()
    assert robot.store.lost_entries > 0
    assert "entries of the journal are lost" in caplog.text
    robot.store.append(edited("x"), confirmed=True, **BY)  # the revisions do not suffer
    databases.make_room("journal.db")
    kept = robot.store.record_firing(entry(text="again"))
    assert robot.store.journal(count=1).firings == (kept,)


@pytest.mark.parametrize("ended", ["stopped", "killed"])
def test_a_start_on_a_full_disk_has_the_confirmed_table_and_is_noted_when_there_is_room(
    tmp_path: Path, ended: str
) -> None:
    # SQLite looks through /proc, so all of it happens where the small disk is mounted.
    mount = f"mount -t tmpfs -o size=512k none {tmp_path}"
    inside = ("unshare", "--user", "--map-root-user", "--mount", "sh", "-c")
    if subprocess.run([*inside, mount], check=False, capture_output=True).returncode:
        pytest.skip("this machine lets nobody mount a disk of their own")
    python = shlex.join([sys.executable, str(Path(__file__).with_name("full_disk.py"))])
    command = [*inside, f"{mount} && exec {python} {tmp_path} {ended}"]
    ran = subprocess.run(command, check=False, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
