"""How one action of a run ended."""

from __future__ import annotations

from typing import NamedTuple


class Outcome(NamedTuple):
    """One action, whether it did what it should, and what it said."""

    action: str
    ok: bool
    text: str
    seconds: float
