"""What the desk speaks of: who asks, what is answered, what is in force, and whom it needs."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal, NamedTuple, Protocol

from kompass.monitor.engine_loop import Swap
from kompass.rulebook.schema.revision import History, Origin, Revision
from kompass.rules.engine.compiled_table import CompiledTable
from kompass.rules.schema.model import Model
from kompass.rules.schema.table import Table

Outcome = Literal["applied", "conflict", "refused", "failed"]


MAX_TEXT = 1_000  # characters of a name or a reason


class Who(NamedTuple):
    """Who asks."""

    author: str
    role: str

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


class Answer(NamedTuple):
    """What the desk says; ``body`` says it in full."""

    outcome: Outcome
    message: str
    revision: int  # in force after it
    body: Model | None = None

    @property
    def ok(self) -> bool:
        """Whether what was asked for was done."""
        return self.outcome == "applied"


class Store(Protocol):
    """Where revisions are kept; what returns is durable."""

    def append(
        self,
        table: Table,
        *,
        author: str,
        role: str,
        reason: str,
        origin: Origin,
        restores: int | None = None,
        confirmed: bool = False,
        copied: bool = True,
    ) -> Revision: ...
    def keep_copy(self) -> None: ...
    def take_back(self, reason: str) -> Revision: ...
    def set_confirmed(self, number: int, *, author: str, role: str) -> Revision: ...
    def refuse(self, *, author: str, role: str, what: str, text: str) -> None: ...
    def reset_once(self, rule_id: str) -> None: ...
    def revision(self, number: int) -> Revision: ...
    def table(self, number: int) -> Table: ...
    def history(self, before: int = 0, count: int = 50) -> History: ...


class Engine(Protocol):
    """The engine, as another thread may use it."""

    def swap(
        self, table: CompiledTable, revision: int, reset: Collection[str], cancel: str
    ) -> Swap:
        """Put a table in force between two messages.

        ``cancel`` says why running actions of what changes are cancelled; empty lets them finish.
        """

    def prepare(self, table: CompiledTable) -> None:
        """Listen to the topics of a table that is about to come."""

    def running(self) -> frozenset[str]:
        """Ids of rules whose actions are running."""


class InForce(NamedTuple):
    """The table in force, and what goes with it.

    Attributes
    ----------
    confirmed
        The revision to which probation and a restart go back.
    probation_ends
        Monotonic seconds; None when it stays.
    """

    table: Table
    revision: int
    confirmed: int
    probation_ends: float | None = None
    notice: str = ""
