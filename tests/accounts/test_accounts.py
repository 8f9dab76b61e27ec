"""Accounts are kept whole, by whoever changes them, and nobody passes for somebody else."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from kompass_console.accounts.accounts import MOST, AccountRefused, Accounts, AccountsUnreadable
from kompass_console.accounts.passwords import LONGEST, SHORTEST, fits, hashed
from kompass_console.schema.roles import Role


@pytest.fixture
def accounts(tmp_path: Path) -> Accounts:
    return Accounts(tmp_path / "robots" / "accounts.json")


def test_who_was_added_is_there_for_every_process_and_for_its_owner_only(
    accounts: Accounts, tmp_path: Path
) -> None:
    file = tmp_path / "robots" / "accounts.json"
    other = Accounts(file)
    assert other.all() == ()
    made = accounts.add("Ava Berg", Role.OPERATOR, "hash")
    assert other.find("ava berg") == made
    assert other.find("  AVA   Berg ") == made
    assert file.stat().st_mode & 0o077 == 0
    assert file.parent.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize("name", ["ava", "AVA", "ａｖａ", " ava "])
def test_one_name_is_one_person_however_it_is_written(accounts: Accounts, name: str) -> None:
    accounts.add("Ava", Role.VIEWER, "hash")
    with pytest.raises(AccountRefused, match="there is an account Ava already"):
        accounts.add(name, Role.ENGINEER, "other")
    assert [each.role for each in accounts.all()] == [Role.VIEWER]


@pytest.mark.parametrize(
    ("name", "why"),
    [("", "empty"), ("  ", "empty"), ("a\x1b[2Jva", "cannot be seen"), ("a" * 300, "characters")],
)
def test_what_is_no_name_is_refused_in_a_sentence(accounts: Accounts, name: str, why: str) -> None:
    with pytest.raises(AccountRefused, match=why):
        accounts.add(name, Role.VIEWER, "hash")
    assert accounts.all() == ()


def test_a_change_names_who_there_is_when_it_means_nobody(accounts: Accounts) -> None:
    accounts.add("ava", Role.VIEWER, "hash")
    with pytest.raises(AccountRefused, match="no account 'ben'; there are: ava"):
        accounts.remove("ben")


def test_what_ends_sessions_ends_them_for_good(accounts: Accounts) -> None:
    keys = [
        accounts.add("ava", Role.ENGINEER, "hash").key,
        accounts.set_role("ava", Role.VIEWER).key,
        accounts.set_role("ava", Role.ENGINEER).key,  # as it was before
        accounts.set_password("ava", "hash").key,
        accounts.end_sessions("ava").key,
    ]
    accounts.add("ben", Role.VIEWER, "hash")
    assert len(set(keys)) == len(keys)
    found = accounts.find("ava")
    assert found is not None
    assert found.key == keys[-1]


def test_who_was_added_by_a_name_is_found_by_it_for_every_change(accounts: Accounts) -> None:
    decomposed = "Jose\u0301"
    accounts.add(decomposed, Role.VIEWER, "hash")
    assert accounts.set_role(decomposed, Role.OPERATOR).role is Role.OPERATOR
    accounts.remove(decomposed)
    assert accounts.all() == ()


def test_two_who_change_at_once_lose_nothing(accounts: Accounts, tmp_path: Path) -> None:
    names = [f"person {number}" for number in range(24)]

    def add(mine: list[str]) -> None:
        own = Accounts(tmp_path / "robots" / "accounts.json")
        for name in mine:
            own.add(name, Role.VIEWER, "hash")

    threads = [threading.Thread(target=add, args=(names[start::3],)) for start in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(each.name for each in accounts.all()) == sorted(names)


def test_there_is_an_end_to_accounts(accounts: Accounts, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kompass_console.accounts.accounts.MOST", 2)
    for name in ("ava", "ben"):
        accounts.add(name, Role.VIEWER, "hash")
    with pytest.raises(AccountRefused, match="remove one"):
        accounts.add("cleo", Role.VIEWER, "hash")
    assert MOST > 2


def test_a_broken_file_is_named_and_lets_in_who_was_let_in(
    accounts: Accounts, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    accounts.add("ava", Role.VIEWER, "hash")
    assert accounts.find("ava")
    file = tmp_path / "robots" / "accounts.json"
    file.write_text('{"accounts": [{"name": "ava", "role": "king"}]}')
    with pytest.raises(AccountsUnreadable, match=r"accounts\.0\.role"):
        Accounts(file)
    assert [each.name for each in accounts.all()] == ["ava"]
    assert "as they were" in caplog.text
    with pytest.raises(AccountRefused, match="mend it"):
        accounts.add("ben", Role.VIEWER, "hash")
    assert "king" in file.read_text()


def test_a_file_that_others_may_write_lets_nobody_in(accounts: Accounts, tmp_path: Path) -> None:
    accounts.add("ava", Role.VIEWER, "hash")
    file = tmp_path / "robots" / "accounts.json"
    file.chmod(0o666)
    with pytest.raises(AccountsUnreadable, match=r"mode 666.*chmod 600"):
        Accounts(file)


def test_a_password_fits_itself_alone_however_its_letters_were_typed() -> None:
    kept = hashed("grüne Katze im Regen")
    assert fits(kept, "gru\u0308ne Katze im Regen")
    assert not fits(kept, "grüne Katze im Regen ")
    assert not fits(None, "nobody")
    assert "Katze" not in kept


@pytest.mark.parametrize("length", [0, SHORTEST - 1, LONGEST + 1])
def test_a_password_of_the_wrong_length_is_refused(length: int) -> None:
    with pytest.raises(ValueError, match=f"has {length} characters"):
        hashed("x" * length)
