"""The keys of robots on disk: each made once, for its owner only, and the same for all who ask."""

import logging
import os
import secrets
import stat
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
        return read_key(Path(given))
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
    files = [Path(given)] if given else []
    try:
        files += sorted(data_dir(environment).glob(f"*/{FILE}"))
    except (StoreUnwritable, OSError) as error:
        _logger.debug("no keys of robots on this disk: %s", error)
    for path in files:
        try:
            keys.append(read_key(path))
        except UnusableKey as error:
            notice_once(str(error))
    return list({key.text: key for key in keys}.values())


def read_key(path: Path) -> RobotKey:
    """Read the file of a key.

    Raises
    ------
    UnusableKey
        When there is none, it is damaged, or others can read it.
    """
    try:
        with path.open("rb") as file:
            mode = stat.S_IMODE(os.fstat(file.fileno()).st_mode)
            text = file.read(_LONGEST).decode(errors="replace")
    except OSError as error:
        raise UnusableKey(f"the key {path} cannot be read: {error.strerror}") from None
    if mode & 0o077:
        raise UnusableKey(
            f"the key {path} can be read by others (mode {mode:o}): chmod 600 {path}; if somebody "
            "may have read it, delete it, and the robot makes a new one when it starts"
        )
    try:
        return RobotKey.read(text)
    except NoKey as error:
        raise UnusableKey(
            f"{path} is damaged: {error}; delete it, and the robot makes a new one when it starts"
        ) from None


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
