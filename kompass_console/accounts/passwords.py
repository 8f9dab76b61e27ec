"""Passwords: what is taken for one, and how it is proved (Argon2id, RFC 9106)."""

from __future__ import annotations

import functools
import unicodedata

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError

SHORTEST = 10
LONGEST = 200

# 64 MiB and three passes, as the RFC has it for little memory; in one thread, for the other
# processors are the robot's.
_hasher = PasswordHasher(parallelism=1)


def hashed(password: str) -> str:
    """What is kept of a password.

    Raises
    ------
    ValueError
        When it is too short or too long.
    """
    if not SHORTEST <= len(password) <= LONGEST:
        raise ValueError(
            f"the password has {len(password)} characters; give {SHORTEST} to {LONGEST}, "
            "three or four words for example"
        )
    return _hasher.hash(_prepared(password))


def fits(kept: str | None, password: str) -> bool:
    """Whether it is the password of which this was kept. Takes as long where none was kept (None),
    so that nobody can tell which names there are."""
    if len(password) > LONGEST:
        password = ""  # nobody has that one
    try:
        _hasher.verify(kept or _of_nobody(), _prepared(password))
    except (VerificationError, InvalidHashError):
        return False
    return kept is not None


@functools.cache
def _of_nobody() -> str:
    return _hasher.hash("nobody")


def _prepared(password: str) -> str:
    """As RFC 8265 has it compared: a letter with an accent is one, however it was typed."""
    return unicodedata.normalize("NFC", password)
