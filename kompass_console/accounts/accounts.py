"""All accounts of a robot: read when the file has changed, changed one at a time."""

from __future__ import annotations

import contextlib
import logging
import secrets
import stat
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from kompass_console.accounts.account import Account, account_name, same_person
from kompass_console.private_file import alone_in, replace_file
from kompass_console.schema.roles import Role

FILE = "accounts.json"
MOST = 200

_logger = logging.getLogger(__name__)
_Stamp = tuple[int, int, int]


class AccountRefused(Exception):
    """A change that cannot be made; the message says why, and what to do."""


class AccountsUnreadable(Exception):
    """The file cannot be read, or is no file of accounts; the message says what to do."""


class _Kept(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    accounts: tuple[Account, ...] = ()


class Accounts:
    """Who may log in by name. Any thread; other processes may change the file meanwhile.

    Parameters
    ----------
    file
        Need not exist; None for no accounts at all.
    now
        Epoch s.

    Raises
    ------
    AccountsUnreadable
        When the file is there and cannot be read.
    """

    def __init__(self, file: Path | None, now: Callable[[], float] = time.time) -> None:
        self._file = file
        self._now = now
        self._lock = threading.Lock()
        self._stamp: _Stamp | None = None
        self._accounts: tuple[Account, ...] = ()
        if file is not None:
            self._stamp = _stamp(file)
            self._accounts = _read(file)

    def all(self) -> tuple[Account, ...]:
        """As they are now, by name.

        A file that has become unreadable changes nothing: who was let in before still is.
        """
        if self._file is None:
            return ()
        with self._lock:
            try:
                stamp = _stamp(self._file)
                if stamp != self._stamp:
                    self._stamp = stamp
                    self._accounts = _read(self._file)
            except (AccountsUnreadable, OSError) as error:
                _logger.error("%s; the accounts are taken to be as they were", error)
            return self._accounts

    def find(self, name: str) -> Account | None:
        """The account that a typed name means."""
        try:
            wanted = account_name(name)
        except ValueError:
            return None
        return next((each for each in self.all() if same_person(each.name, wanted)), None)

    def add(self, name: str, role: Role, password: str) -> Account:
        """Let somebody in, with the hash of a password; on the disk when this returns.

        Raises
        ------
        AccountRefused
            When the name is no name or is taken, there are too many, or the disk does not take it.
            So do all changes below.
        """
        try:
            made = Account(
                name=account_name(name), role=role, password=password, created=self._now()
            )
        except ValueError as error:
            raise AccountRefused(str(error)) from None
        with self._changing() as accounts:
            if taken := next((a for a in accounts if same_person(a.name, made.name)), None):
                raise AccountRefused(
                    f"there is an account {taken.name} already; 'users passwd' gives it another "
                    "password, 'users role' another role"
                )
            if len(accounts) >= MOST:
                raise AccountRefused(f"there are {MOST} accounts; remove one that nobody needs")
            accounts.append(made)
        return made

    def set_password(self, name: str, password: str) -> Account:
        """Another password, by its hash; sessions of the account end."""
        return self._change(name, {"password": password})

    def set_role(self, name: str, role: Role) -> Account:
        """Another role; sessions of the account end."""
        return self._change(name, {"role": role})

    def end_sessions(self, name: str) -> Account:
        """End all sessions of an account."""
        return self._change(name, {})

    def remove(self, name: str) -> Account:
        """Let somebody in no more; sessions of the account end."""
        with self._changing() as accounts:
            index = self._index(accounts, name)
            return accounts.pop(index)

    def _change(self, name: str, change: dict[str, object]) -> Account:
        with self._changing() as accounts:
            index = self._index(accounts, name)
            ended = {"sessions": secrets.token_hex(8)}
            accounts[index] = accounts[index].model_copy(update=change | ended)
            return accounts[index]

    def _index(self, accounts: list[Account], name: str) -> int:
        with contextlib.suppress(ValueError):
            wanted = account_name(name)
            for index, account in enumerate(accounts):
                if same_person(account.name, wanted):
                    return index
        known = ", ".join(account.name for account in accounts)
        raise AccountRefused(
            f"there is no account {name!r}; "
            + (f"there are: {known}" if known else "there is none")
        )

    @contextlib.contextmanager
    def _changing(self) -> Iterator[list[Account]]:
        if self._file is None:
            raise AccountRefused("this robot keeps no accounts: there is no folder for them")
        try:
            with alone_in(self._file.parent):
                accounts = list(_read(self._file))
                yield accounts
                accounts.sort(key=lambda account: account.name.casefold())
                text = _Kept(accounts=tuple(accounts)).model_dump_json(indent=1)
                replace_file(self._file, text + "\n")
        except AccountsUnreadable as error:
            raise AccountRefused(str(error)) from None
        except OSError as error:
            raise AccountRefused(
                f"cannot write {self._file}: {error.strerror}; nothing has changed"
            ) from None


def _stamp(file: Path) -> _Stamp | None:
    """What changes with each new file; None where there is none."""
    try:
        found = file.stat()
    except FileNotFoundError:
        return None
    return found.st_mtime_ns, found.st_ino, found.st_size


def _read(file: Path) -> tuple[Account, ...]:
    try:
        if (mode := stat.S_IMODE(file.stat().st_mode)) & 0o077:
            raise AccountsUnreadable(
                f"{file} is open to others (mode {mode:o}): anybody may have been let in; look "
                f"through it with 'kompass-console users list' after chmod 600 {file}"
            )
        return _Kept.model_validate_json(file.read_bytes()).accounts
    except FileNotFoundError:
        return ()
    except OSError as error:
        raise AccountsUnreadable(f"cannot read {file}: {error.strerror}") from None
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        where = ".".join(map(str, first["loc"])) or "the whole"
        raise AccountsUnreadable(
            f"{file} is no file of accounts ({where}: {first['msg']}); mend it, or move it away "
            "and add the accounts again"
        ) from None
