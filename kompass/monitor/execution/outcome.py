"""How one action of a run ended."""

from __future__ import annotations

from typing import NamedTuple


class Outcome(NamedTuple):
    """One action, whether it did what it should, and what it said.

    ``problem`` is why it failed, without the name of the action; empty when it did not.
    """

    action: str
    ok: bool
    text: str
    seconds: float
    problem: str = ""
