"""A person who may log in: name, role, and what proves the password."""

from __future__ import annotations

import hashlib
import unicodedata
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from kompass_console.schema.plain import LONGEST_NAME
from kompass_console.schema.roles import Role

Time = Annotated[float, Field(allow_inf_nan=False)]


def account_name(text: str) -> str:
    """A name as it is kept and shown: compatibility forms folded, blanks single.

    Raises
    ------
    ValueError
        When it is empty, too long, or holds what cannot be seen.
    """
    name = " ".join(unicodedata.normalize("NFKC", text).split())
    if not name:
        raise ValueError("the name is empty; give one, for example ava")
    if len(name) > LONGEST_NAME:
        raise ValueError(f"the name has {len(name)} characters; {LONGEST_NAME} at most")
    if not name.isprintable():
        raise ValueError(f"the name {name!a} holds what cannot be seen; leave that out")
    return name


def same_person(one: str, other: str) -> bool:
    """Whether two names mean one account: capitals do not count."""
    return one.casefold() == other.casefold()


class Account(BaseModel):
    """One person.

    Attributes
    ----------
    password
        As Argon2 writes it down, with salt and parameters.
    created
        Epoch s.
    sessions
        Another word each time that all sessions end; no clock, for a robot's may go back.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: Annotated[str, AfterValidator(account_name)]
    role: Role
    password: str
    created: Time
    sessions: str = ""

    @property
    def key(self) -> bytes:
        """What sessions of this account are signed with: another one for another password or role,
        so that a change of either ends them, also when it is changed back."""
        secret = "\0".join((self.name, self.role, self.password, self.sessions))
        return hashlib.sha256(b"kompass-console account " + secret.encode()).digest()
