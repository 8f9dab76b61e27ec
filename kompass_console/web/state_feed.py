"""Tells every page the state: at once when it matters, ten times a second at most, newest wins."""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections.abc import Callable, Iterator

from kompass_console.schema.models import State

_PERIOD = 0.1  # s between two states, unless something that matters has changed
_BURST = 0.02  # s for each state in any case; two may come together


class StateListener:
    """One page's newest state, as JSON; a page that reads slowly skips the ones between."""

    def __init__(self) -> None:
        self._newest: str | None = None
        self._arrived = asyncio.Event()

    def put(self, state: str) -> None:
        self._newest = state
        self._arrived.set()

    async def get(self) -> str:
        """The newest state that has not been taken yet; waits for one."""
        await self._arrived.wait()
        self._arrived.clear()
        assert self._newest is not None  # set before the event
        return self._newest


class StateFeed:
    """Builds states while anybody listens, and hands each to every listener."""

    def __init__(self) -> None:
        self._listeners: set[StateListener] = set()
        self._urgent = asyncio.Event()
        self._someone = asyncio.Event()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._seq = 0

    @property
    def viewers(self) -> int:
        return len(self._listeners)

    def changed(self) -> None:
        """Something that matters has changed: tell the pages now. Any thread."""
        loop = self._loop
        if loop is not None and not loop.is_closed():
            with contextlib.suppress(RuntimeError):  # closed between the question and the call
                loop.call_soon_threadsafe(self._urgent.set)

    @contextlib.contextmanager
    def listen(self) -> Iterator[StateListener]:
        """A listener for as long as the block lasts; it gets a state at once."""
        listener = StateListener()
        self._listeners.add(listener)
        self._someone.set()
        self._urgent.set()
        try:
            yield listener
        finally:
            self._listeners.discard(listener)
            if not self._listeners:
                self._someone.clear()

    async def run(self, build: Callable[[int, int], State]) -> None:
        """Hand out what `build(seq, viewers)` makes, until cancelled."""
        self._loop = loop = asyncio.get_running_loop()
        before = -math.inf
        while True:
            await self._someone.wait()
            self._seq += 1
            state = build(self._seq, self.viewers).model_dump_json()
            for listener in self._listeners:
                listener.put(state)
            # That a goal is sent is followed in a moment by its being accepted: that one must not
            # wait because the other was told.
            now = loop.time()
            before, earliest = now, before + 2 * _BURST
            await asyncio.sleep(max(0.0, earliest - now))
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._urgent.wait(), now + _PERIOD - loop.time())
            self._urgent.clear()
