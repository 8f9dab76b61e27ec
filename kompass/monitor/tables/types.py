"""Who asks for a change, what is answered, and what is in force."""

from __future__ import annotations

from typing import Literal, NamedTuple

from kompass.rules.schema.model import Model
from kompass.rules.schema.table import Table

ChangeOutcome = Literal["applied", "conflict", "refused", "failed"]
UNVERIFIED = "(unverified)"
MAX_TEXT = 1_000  # characters of a name or a reason


class Who(NamedTuple):
    """Who asks.

    Attributes
    ----------
    author
        Name, for the history.
    role
        ``viewer``, ``operator`` or ``engineer``.
    verified
        Whether the request was signed with the robot's key, so that the other two can be believed.
    """

    author: str
    role: str
    verified: bool = True

    @property
    def name(self) -> str:
        """The author as everybody is to read it, wherever it is kept or shown."""
        return self.author if self.verified else f"{self.author or self.role} {UNVERIFIED}"

    @property
    def barred(self) -> str:
        """Why this role may change nothing; empty if it may."""
        if self.role in ("operator", "engineer"):
            return ""
        return f"role {self.role[:50]!r} may look at rules and change nothing; ask an operator"

    def too_long(self, reason: str = "") -> str:
        """What is too long of what goes into the history; empty if nothing is."""
        for name, text in (("author", self.author), ("reason", reason)):
            if len(text) > MAX_TEXT:
                return f"{name} has {len(text)} characters, at most {MAX_TEXT}"
        return ""


class ChangeAnswer(NamedTuple):
    """What came of a request to change something.

    Attributes
    ----------
    message
        A sentence for a person.
    revision
        In force after it.
    body
        The same in full: a report or a conflict. None where there is no more to say.
    """

    outcome: ChangeOutcome
    message: str
    revision: int
    body: Model | None = None

    @property
    def ok(self) -> bool:
        """Whether what was asked for was done."""
        return self.outcome == "applied"


class InForce(NamedTuple):
    """The table in force, and what goes with it.

    Attributes
    ----------
    confirmed
        The revision to which probation and a restart go back.
    probation_ends
        Monotonic seconds; None when it stays.
    notice
        What an operator should know of it; empty for nothing.
    """

    table: Table
    revision: int
    confirmed: int
    probation_ends: float | None = None
    notice: str = ""
