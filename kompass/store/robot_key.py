"""The keys of robots on disk: each made once, for its owner only, and the same for all who ask."""

import logging
import os
import secrets
import stat
import struct
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from kompass.settings import notice_once
from kompass.signing.key import NoKey, RobotKey
from kompass.store.durable import sync_folder
from kompass.store.errors import StoreUnwritable
from kompass.store.paths import data_dir, robot_folder
from kompass.store.private import private_folder, private_opener

FILE = "robot.key"
GIVEN = "KOMPASS_ROBOT_KEY"  # a file to take the key from
_LONGEST = 200  # bytes of a file that may be a key
_ROOT = 0
# POSIX access control lists as Linux hands them out: a version, and entries of tag, rights, id.
_ACL, _ACL_HEADER = "system.posix_acl_access", 4
_ACL_OWNER, _ACL_USER, _ACL_MASK, _ACL_OTHER = 0x01, 0x02, 0x10, 0x20

_logger = logging.getLogger("kompass.store")
# What this process has; whoever is forked from it has the same, also where no disk takes it.
_had: dict[Path | None, RobotKey] = {}


class UnusableKey(Exception):
    """A file of a key cannot be used; the message says why, and what to do."""


def robot_key(environment: Mapping[str, str] = os.environ) -> RobotKey:
    """The key of the robot that the environment names, made when there is none.

    It is in the file that ``KOMPASS_ROBOT_KEY`` names, else in the robot's folder. Where nothing
    can be kept, it lives as long as the stack: this process and its forks have it.

    Raises
    ------
    UnusableKey
        When its file is damaged, or not for its owner alone.
    """
    if given := environment.get(GIVEN):
        return read_key(Path(given), given=True)
    try:
        path = robot_folder(environment) / FILE
    except StoreUnwritable:
        path = None
    if path not in _had:
        _had[path] = _kept(path)
    return _had[path]


def known_keys(environment: Mapping[str, str] = os.environ) -> list[RobotKey]:
    """Every key that this user has here: of this stack, the one given, of the robots on this disk.

    One that cannot be used is told, and left out.
    """
    keys = list(_had.values())
    given = environment.get(GIVEN)
    files = [(Path(given), True)] if given else []
    try:
        files += [(path, False) for path in sorted(data_dir(environment).glob(f"*/{FILE}"))]
    except (StoreUnwritable, OSError) as error:
        _logger.debug("no keys of robots on this disk: %s", error)
    for path, was_given in files:
        try:
            keys.append(read_key(path, given=was_given))
        except UnusableKey as error:
            notice_once(str(error))
    return list({key.text: key for key in keys}.values())


def read_key(path: Path, *, given: bool = False) -> RobotKey:
    """Read the file of a key.

    Parameters
    ----------
    given
        Somebody named the file; it is not the one that the robot makes for itself. The remedies
        differ.

    Raises
    ------
    UnusableKey
        When there is none, it is no regular file, it is damaged, it belongs to a stranger, or
        others can read it.
    """
    try:
        with open(path, "rb", opener=_without_waiting) as file:
            _check(path, file.fileno(), given)
            text = file.read(_LONGEST).decode(errors="replace")
    except OSError as error:
        raise UnusableKey(f"the key {path} cannot be read: {error.strerror}") from None
    try:
        return RobotKey.read(text)
    except NoKey as error:
        remedy = (
            "bring the robot's key there again, or name no file, and the robot has one of its own"
            if given
            else "delete it, and the robot makes a new one when it starts"
        )
        raise UnusableKey(f"{path} is damaged: {error}; {remedy}") from None


def _without_waiting(path: str, flags: int) -> int:
    """A pipe would keep us until somebody writes into it."""
    return os.open(path, flags | os.O_NONBLOCK)


def _check(path: Path, descriptor: int, given: bool) -> None:
    """Refuse a file that somebody else may have written, or can read.

    Raises
    ------
    UnusableKey
        With the remedy.
    """
    status = os.fstat(descriptor)
    if not stat.S_ISREG(status.st_mode):
        raise UnusableKey(f"the key {path} is no regular file; name the file that holds the key")
    if status.st_uid not in _trusted():
        raise UnusableKey(
            f"the key {path} belongs to another user ({status.st_uid}), who knows and may change "
            f"it: chown {os.geteuid()} {path}, if the key is known to be the right one"
        )
    mode = stat.S_IMODE(status.st_mode)
    if _others_read(descriptor, mode):
        remedy = (
            "put a new one there and wherever it was brought"
            if given
            else "delete it, and the robot makes a new one when it starts"
        )
        raise UnusableKey(
            f"the key {path} can be read by others (mode {mode:o}): chmod 600 {path}; if somebody "
            f"may have read it, {remedy}"
        )


def _trusted() -> tuple[int, int]:
    return (os.geteuid(), _ROOT)


def _others_read(descriptor: int, mode: int) -> bool:
    """Whether anybody but us and root may do anything with a file.

    Where there is an access control list, the group's bits of the mode are its mask and name
    nobody. systemd's credentials are root's, and open to the unit's user by such a list.
    """
    try:
        listed = os.getxattr(descriptor, _ACL)
    except OSError:
        return bool(mode & 0o077)
    mask = mode >> 3
    for tag, allowed, whom in struct.iter_unpack("<HHI", listed[_ACL_HEADER:]):
        if tag in (_ACL_OWNER, _ACL_MASK) or (tag == _ACL_USER and whom in _trusted()):
            continue
        if allowed & (0o7 if tag == _ACL_OTHER else mask):
            return True
    return False


def _kept(path: Path | None) -> RobotKey:
    """The key in a file, which is made where there is none."""
    if path is None:
        return RobotKey.new()
    if not path.exists():
        try:
            _make(path)
        except OSError as error:
            _logger.warning(
                "the robot's key cannot be kept in %s (%s): only the console that this stack "
                "starts has it",
                path,
                error.strerror,
            )
            return RobotKey.new()
    return read_key(path)


def _make(path: Path) -> None:
    """Write a new key; whole from the first moment, and never over one that is there by then.

    Raises
    ------
    OSError
        When it cannot be written.
    """
    private_folder(path.parent)
    writing = path.with_name(f"{path.name}.{secrets.token_hex(8)}")
    try:
        with open(writing, "x", opener=private_opener) as file:
            file.write(f"{RobotKey.new().text}\n")
            file.flush()
            os.fsync(file.fileno())
        with suppress(FileExistsError):  # another process was faster: its key is the robot's
            os.link(writing, path)
        sync_folder(path.parent)
    finally:
        writing.unlink(missing_ok=True)
