"""A call of a function of the recipe, plain or ``async def``."""

from __future__ import annotations

import asyncio
import inspect
import threading
from collections.abc import Awaitable, Callable, Mapping
from typing import Any


class CallCancelled(Exception):
    """The call was cancelled before it came to its end."""


class RecipeCall:
    """Runs in the thread that calls :meth:`run`; what is to be awaited has an event loop there.

    A loop of its own for each call: a coroutine that blocks, against all advice, holds up nobody.

    Parameters
    ----------
    function
        Called once.
    kwargs
        By name.
    """

    def __init__(
        self, function: Callable[..., Any], kwargs: Mapping[str, Any] | None = None
    ) -> None:
        self._function, self._kwargs = function, kwargs or {}
        self._lock = threading.Lock()
        self._cancelled = False
        self._loop: asyncio.AbstractEventLoop | None = None
        self._task: asyncio.Task[Any] | None = None

    def run(self) -> Any:
        """Call the function, and return its result once it has one.

        Raises
        ------
        CallCancelled
            When :meth:`cancel` came first, or the coroutine cancelled itself.
        Exception
            What the function raises.
        """
        with self._lock:
            if self._cancelled:
                raise CallCancelled("cancelled before it began")
        result = self._function(**self._kwargs)
        if not inspect.isawaitable(result):
            return result
        with asyncio.Runner() as runner:
            try:
                return runner.run(self._awaited(result))
            except asyncio.CancelledError:
                raise CallCancelled("cancelled") from None

    def cancel(self) -> None:
        """End what awaits, where it does; a plain function runs to its end. From any thread."""
        with self._lock:
            self._cancelled = True
            if self._loop is not None and self._task is not None:
                self._loop.call_soon_threadsafe(self._task.cancel)

    async def _awaited(self, result: Awaitable[Any]) -> Any:
        with self._lock:
            self._loop, self._task = asyncio.get_running_loop(), asyncio.current_task()
            if self._cancelled and self._task is not None:
                self._task.cancel()
        try:
            return await result
        finally:
            with self._lock:
                self._loop = self._task = None
