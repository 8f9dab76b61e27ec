"""The pages of this console on which somebody may drive by hand."""

from __future__ import annotations

import asyncio
import contextlib
from typing import Protocol


class Hand(Protocol):
    """A page with the wheel."""

    @property
    def session_id(self) -> str:
        """Of the log-in that it is a page of."""

    def asked(self, by: str) -> None:
        """Tell it that somebody asks for the wheel."""

    def lost_control(self, by: str) -> None:
        """Tell it that somebody else has control of the robot now, and so the wheel."""


class Hands:
    """Knows which page has the wheel, for whoever asks for it. On the web server's loop."""

    def __init__(self) -> None:
        self._holder: Hand | None = None
        self._loop: asyncio.AbstractEventLoop | None = None

    def took(self, hand: Hand) -> None:
        """A page has the wheel from now on."""
        self._holder, self._loop = hand, asyncio.get_running_loop()

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

    def lose(self, session_id: str, by: str) -> None:
        """A log-in has lost control: it gives the wheel up, if it has that. Any thread."""
        loop = self._loop
        if loop is not None and not loop.is_closed():
            with contextlib.suppress(RuntimeError):  # closed between the question and the call
                loop.call_soon_threadsafe(self._lose, session_id, by)

    def _lose(self, session_id: str, by: str) -> None:
        if self._holder is not None and self._holder.session_id == session_id:
            self._holder.lost_control(by)
