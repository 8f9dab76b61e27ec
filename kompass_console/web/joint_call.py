"""One call for all who ask for the same thing at the same time."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable
from typing import Generic, TypeVar

T = TypeVar("T")


class JointCall(Generic[T]):
    """However many ask and however often: one call at a time, and a pause between two.

    Whoever asks gets the answer of a call that began after they asked, so that nobody is told of
    how things were before. The first one does not wait. Lives on one event loop.

    Parameters
    ----------
    pause
        Seconds at least from the beginning of one call to that of the next.
    """

    def __init__(self, pause: float, *, now: Callable[[], float] = time.monotonic) -> None:
        self._pause = pause
        self._now = now
        self._begun = float("-inf")
        self._under_way: asyncio.Task[T] | None = None
        self._next: asyncio.Task[T] | None = None

    async def ask(self, call: Callable[[], Awaitable[T]]) -> T:
        """The answer of a call that begins from now on; `call` makes it if nobody else does.

        Raises
        ------
        Exception
            What the call raises, for everybody who waited for it.
        """
        if self._next is None:
            self._next = asyncio.create_task(self._carry_out(call, self._under_way))
        # Who goes away does not take the call with them: others wait for it.
        return await asyncio.shield(self._next)

    async def _carry_out(
        self, call: Callable[[], Awaitable[T]], before: asyncio.Task[T] | None
    ) -> T:
        if before is not None:
            await asyncio.wait({before})
        if (rest := self._begun + self._pause - self._now()) > 0.0:
            await asyncio.sleep(rest)
        self._under_way, self._next = self._next, None
        self._begun = self._now()
        return await call()
