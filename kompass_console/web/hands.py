"""The pages of this console on which somebody may drive by hand."""

from __future__ import annotations

from typing import Protocol


class Hand(Protocol):
    """A page with the wheel."""

    def asked(self, by: str) -> None:
        """Tell it that somebody asks for the wheel."""


class Hands:
    """Knows which page has the wheel, for whoever asks for it. On the web server's loop only."""

    def __init__(self) -> None:
        self._holder: Hand | None = None

    def took(self, hand: Hand) -> None:
        """A page has the wheel from now on."""
        self._holder = hand

    def gave(self, hand: Hand) -> None:
        """A page has it no more."""
        if self._holder is hand:
            self._holder = None

    def ask(self, by: str) -> bool:
        """Ask the page that has the wheel for it; False when it is none of this console's."""
        if self._holder is None:
            return False
        self._holder.asked(by)
        return True
