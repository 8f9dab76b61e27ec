"""Answers that are under way: one future for asyncio and for threads, and each has an end."""

from __future__ import annotations

import asyncio
import contextlib
import math
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, InvalidStateError, wait
from typing import Any, Self, TypeVar

from rclpy.exceptions import InvalidHandle

SEARCH_PERIOD = 0.02  # s between two looks for a server that is not there yet

T = TypeVar("T")


class NoAnswer(Exception):
    """Nobody offers what was asked for, or there was no answer in time; ``why`` says which."""

    def __init__(self, why: str) -> None:
        super().__init__(why)
        self.why = why


class Reply(Future[T]):
    """What a server of ROS is going to answer; done on the thread that spins the node.

    A request that is sent before its server is connected is lost, and ROS tells nobody when that
    is: it is sent at once if that can be, else while somebody waits for the answer.

    Parameters
    ----------
    server
        Name of the server, for errors.
    limit
        Seconds that whoever waits gives it; None for no end.
    ready
        Whether the server is connected.
    send
        Sends the request. Takes what is to be called with rclpy's future of the answer when that
        is done; returns what forgets the request. Called once.
    read
        Makes the result of the server's answer, or raises what waiting is to raise.
    """

    def __init__(
        self,
        server: str,
        limit: float | None,
        *,
        ready: Callable[[], bool],
        send: Callable[[Callable[[Any], None]], Callable[[], object]],
        read: Callable[[Any], T],
    ) -> None:
        super().__init__()
        self._server, self._limit = server, limit
        self._ready, self._send, self._read = ready, send, read
        self._forget: Callable[[], object] | None = None
        self._sending = threading.Lock()
        self.set_running_or_notify_cancel()
        self.begin()

    @classmethod
    def of_service(
        cls,
        client: Any,
        name: str,
        request: Any,
        limit: float | None,
        read: Callable[[Any], T] = lambda answer: answer,
    ) -> Self:
        """Call a service by its name and a client of rclpy."""

        def send(answered: Callable[[Any], None]) -> Callable[[], object]:
            asked = client.call_async(request)
            asked.add_done_callback(answered)
            return lambda: client.remove_pending_request(asked)

        return cls(name, limit, ready=client.service_is_ready, send=send, read=read)

    def begin(self) -> bool:
        """Send the request if it was not sent and its server is connected.

        Returns
        -------
        bool
            Whether there is no more to be sent.
        """
        with self._sending:
            if self._forget is None and not self.done():
                try:
                    if self._ready():
                        self._forget = self._send(self._answered)
                except InvalidHandle:
                    self.set_exception(NoAnswer(f"{self._server} has just gone"))
            return self._forget is not None or self.done()

    async def answer(self) -> T:
        """Wait in asyncio; the result.

        Raises
        ------
        NoAnswer
            When there is none within the limit.
        Exception
            What ``read`` raises.
        """
        deadline = self._deadline()
        while not self.begin() and time.monotonic() < deadline:
            await asyncio.sleep(SEARCH_PERIOD)
        loop, arrived = asyncio.get_running_loop(), asyncio.Event()

        def tell(_: Future[T]) -> None:
            with contextlib.suppress(RuntimeError):  # nobody waits: the loop has been closed
                loop.call_soon_threadsafe(arrived.set)

        self.add_done_callback(tell)
        left = None if deadline == math.inf else max(0.0, deadline - time.monotonic())
        try:
            await asyncio.wait_for(arrived.wait(), left)
        except TimeoutError:
            self._give_up()
        return self.result()

    def wait(self, spin: Callable[[], object] | None = None) -> T:
        """Wait in this thread; the result. Raises as `answer` does.

        Parameters
        ----------
        spin
            Lets the node work for a moment; None where another thread does.
        """
        rest = spin or (lambda: wait([self], SEARCH_PERIOD))
        deadline = self._deadline()
        while not self.done():
            self.begin()
            if time.monotonic() >= deadline:
                self._give_up()
                break
            rest()
        return self.result()

    def _deadline(self) -> float:
        return math.inf if self._limit is None else time.monotonic() + self._limit

    def _answered(self, future: Any) -> None:
        with contextlib.suppress(InvalidStateError):  # given up in this very moment
            if future.cancelled():
                self.set_exception(NoAnswer(f"the call of {self._server} was cancelled"))
                return
            try:
                result = self._read(future.result())
            except Exception as error:  # noqa: BLE001 - raised where it is waited for
                self.set_exception(error)
            else:
                self.set_result(result)

    def _give_up(self) -> None:
        if self._forget is not None:
            self._forget()
        with contextlib.suppress(InvalidStateError):  # answered in this very moment
            self.set_exception(NoAnswer(f"{self._server} did not answer within {self._limit:g} s"))
