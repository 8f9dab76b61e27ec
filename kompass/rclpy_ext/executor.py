"""Run coroutines on an rclpy executor without polling, and cancel them for real.

The events executor (rclpy 7.1.6) calls a task again and again while it waits: one coroutine that
awaits a future keeps a core busy (``ros2/rclpy`` issue 1405). It also cannot cancel one: the
cancelled task is called for ever. Here a coroutine is resumed by the future that it waits for, and
by nothing else.
"""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable, Coroutine, Generator
from typing import Any, Protocol

import rclpy
from rclpy.context import Context
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.task import Future

from kompass.bus.node import Node

LONGEST_WAIT = 1.0  # s, for what comes next
# What the middleware raises, without a public name in rclpy: mostly that whoever asked has gone
# before the answer came.
MIDDLEWARE_ERRORS = (
    rclpy_implementation.RCLError,
    rclpy_implementation.RMWError,  # of bytes that are no message of their type
    rclpy_implementation.InvalidHandle,
)


class Cancelled(BaseException):
    """Thrown into a coroutine that is cancelled; its ``finally`` blocks run."""


class Task:
    """A coroutine on its way; begins at once, on the executor's thread.

    Parameters
    ----------
    coroutine
        Awaits futures of rclpy.
    ended
        Called once, with the exception that ended it (:class:`Cancelled` too) or None.
    """

    def __init__(
        self,
        coroutine: Coroutine[Future, None, Any],
        ended: Callable[[BaseException | None], None],
    ) -> None:
        self._coroutine: Coroutine[Future, None, Any] | None = coroutine
        self._ended = ended
        self._awaited: Future | None = None
        self._stepping = False
        self._cancelled = False
        self._advance(None)

    @property
    def done(self) -> bool:
        """Whether it has come to its end."""
        return self._coroutine is None

    def cancel(self) -> None:
        """End it where it waits; of one that has ended, nothing is done."""
        if not self._cancelled:
            self._cancelled = True
            if not self._stepping:
                self._advance(Cancelled())

    def _resume(self, future: Future) -> None:
        # A future that was awaited before a cancellation may still call back.
        if future is self._awaited:
            self._advance(None)

    def _advance(self, error: BaseException | None) -> None:
        if self._coroutine is None:
            return
        self._awaited, self._stepping = None, True
        try:
            run = self._coroutine
            awaited = run.send(None) if error is None else run.throw(error)
        except StopIteration:
            self._finish(None)
        except BaseException as problem:  # noqa: BLE001 - handed to whoever started it
            self._finish(problem)
        else:
            self._stepping = False
            if self._cancelled and error is None:
                self._advance(Cancelled())
                return
            self._awaited = awaited
            awaited.add_done_callback(self._resume)

    def _finish(self, error: BaseException | None) -> None:
        self._coroutine = None
        self._ended(error)


def _await(future: Future) -> Generator[Future, None, Any]:
    while not (future.done() or future.cancelled()):
        yield future
    return future.result()


# rclpy's own yields None, which says nothing of what is waited for; its tasks do not look at it.
Future.__await__ = _await


class TimerQueue(Protocol):
    """What is due at times, without a timer of ROS."""

    def fire(self) -> float:
        """Do what is due; the time until it is to be called again [s]."""


class TaskExecutor(rclpy_implementation.EventsExecutor):  # type: ignore[misc]
    """The events executor, with coroutines that cost nothing while they wait.

    What a coroutine raises is raised where it is awaited; of one that nobody awaits, rclpy writes
    it to the terminal. What a function raises comes out of :meth:`spin_once`, as from a callback.
    rclpy's own would have the process die of SIGSEGV (7.1.6, ``ros2/rclpy`` issue 1641): it looks
    for the logger of its only node with an index into a set.

    Its nodes must be :class:`kompass.rclpy_ext.node.NodeOnDDS`.

    Parameters
    ----------
    context
        The process's own when left out.
    """

    def __init__(self, context: Context | None = None) -> None:
        super().__init__(context or rclpy.get_default_context())
        self._raised: Exception | None = None
        self._timers: list[TimerQueue] = []

    def add_timers(self, timers: TimerQueue) -> None:
        """Fire these whenever they are due."""
        self._timers.append(timers)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Fire the timers that are due, and handle what comes next.

        Parameters
        ----------
        timeout_sec
            Wait so long at most [s], and less when a timer is due before. Without a timeout
            rclpy's own would spin at full load and fire no timer of ROS (7.1.6); here None is
            :data:`LONGEST_WAIT`.

        Raises
        ------
        Exception
            What a callback, or the function of a task, has raised.
        """
        if timeout_sec is None:
            timeout_sec = LONGEST_WAIT
        for timers in self._timers:
            timeout_sec = min(timeout_sec, timers.fire())
        super().spin_once(timeout_sec=timeout_sec)
        if self._raised is not None:
            error, self._raised = self._raised, None
            raise error

    def spin_on(self, node: Node, timeout_sec: float) -> None:
        """As :meth:`spin_once`; what the middleware refuses is told in the node's log.

        A client that dies, or a publisher of broken messages, is no reason to end a program.
        """
        try:
            self.spin_once(timeout_sec=timeout_sec)
        except MIDDLEWARE_ERRORS as error:
            where = "".join(traceback.format_tb(error.__traceback__)[-1:]).strip()
            node.get_logger().error(f"the middleware refused something: {error} ({where})")

    def create_task(self, callback: Any, *args: Any, **kwargs: Any) -> Future:
        """Have a function or a coroutine run.

        Parameters
        ----------
        callback
            A function, a coroutine function or a coroutine.
        *args, **kwargs
            Given to the function.

        Returns
        -------
        rclpy.task.Future
            Of its result.
        """
        if inspect.iscoroutinefunction(callback):
            callback = callback(*args, **kwargs)
        result = Future(executor=self)
        if not inspect.iscoroutine(callback):

            def call() -> None:
                try:
                    result.set_result(callback(*args, **kwargs))
                except Exception as error:  # noqa: BLE001 - raised by spin_once
                    result.set_exception(error)
                    result.exception()  # it is told of: rclpy need not, when nobody awaits it
                    self._raised = error

            super().create_task(call)
            return result

        async def run() -> None:
            result.set_result(await callback)

        def ended(error: BaseException | None) -> None:
            # To be raised where it is awaited. Raised here it would end the process (rclpy 7.1.6).
            if error is not None:
                result.set_exception(error)

        def begin() -> None:
            Task(run(), ended)

        super().create_task(begin)
        return result
