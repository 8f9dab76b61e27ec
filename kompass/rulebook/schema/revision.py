"""A revision: one state of the table in the history."""

from typing import Literal

from kompass.rulebook.schema.diff_models import TableDiff
from kompass.rules.schema.model import Model

Origin = Literal["recipe", "edit", "rollback", "taken back", "merge"]


class Revision(Model):
    """Who put which table in force, when and why.

    Attributes
    ----------
    number
        1, 2, 3 …; never used twice.
    parent
        The revision that was in force before; None for the first.
    time
        Seconds since the epoch.
    recipe
        Hash of the recipe's own table when it was made.
    outcome
        What became of it: ``active`` and not yet confirmed, ``confirmed``, ``taken back`` (by the
        end of its probation, a crash loop or a person), or ``superseded``.
    restores
        For a rollback: the revision whose table it has.
    """

    number: int
    parent: int | None
    author: str
    role: str
    time: float
    reason: str
    origin: Origin
    table_hash: str
    recipe: str
    outcome: Literal["active", "confirmed", "taken back", "superseded"]
    restores: int | None = None
    diff: TableDiff = TableDiff()


class History(Model):
    """A stretch of the history, newest first."""

    active: int
    confirmed: int
    revisions: tuple[Revision, ...]
    more: bool  # older ones exist
