"""Callbacks that may raise, where rclpy would have the process die of it."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

from rclpy.executors import await_or_execute

T = TypeVar("T")


def guarded(
    callback: Callable[[Any], Any], otherwise: T, tell: Callable[[Exception], object]
) -> Callable[[Any], Awaitable[T]]:
    """Have a callback answer whatever happens in it.

    What a callback of an action raises ends the process by SIGSEGV under the events executor
    (rclpy 7.1.6, ``ros2/rclpy`` issue 1641).

    Parameters
    ----------
    callback
        A function or a coroutine function of one argument.
    otherwise
        The answer when it raises.
    tell
        Takes what it raises.
    """

    async def call(argument: Any) -> Any:
        try:
            return await await_or_execute(callback, argument)
        except Exception as error:  # noqa: BLE001 - is told of
            tell(error)
            return otherwise

    return call
