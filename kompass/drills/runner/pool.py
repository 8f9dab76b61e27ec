"""Calls, each in a process of its own, several at a time.

The standard library's pools keep their processes by a thread. Where Ctrl-C ends a process that is
just being started, that thread ends with it, and nobody tells the others that all is over. Here
whoever asks starts and hears them by itself, and ends those that it leaves.
"""

from __future__ import annotations

import os
import pickle
import signal
import tempfile
import threading
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import ForkServerProcess
from typing import Generic, TypeVar, cast

from kompass.drills.runner.lifeline import ASKS, end_children, end_with, keep_descendants

T = TypeVar("T")

# In every process: what would make two runs of one seed differ, or one slower.
ENVIRONMENT = {
    "PYTHONHASHSEED": "0",
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "KOMPASS_ROBOT_NAME": "drill",
    "KOMPASS_ROS_CONTROL": "read",
}

# What the process imports that all others are forked from: what drives are made with, what recipes
# import, which lies above, and at last what warms all of it up.
_PRELOADED = [
    "kompass.drills.runner.preloaded",
    "kompass.actions",
    "kompass.control",
    "kompass.ros",
]
_WARM = "kompass.drills.runner.warm"

_GOING = 5.0  # s that a process has to go once it has answered


class ProcessEnded(RuntimeError):
    """A process ended and had not answered.

    Attributes
    ----------
    code
        With which it did; the negative number of the signal that ended it. None if nobody knows.
    """

    code: int | None = None

    def __str__(self) -> str:
        return "a process ended and had not answered"


@dataclass(frozen=True, slots=True)
class Ended(Generic[T]):
    """A call that is over: what it returned, or what it raised."""

    index: int
    outcome: T | BaseException

    @property
    def result(self) -> T:
        """What it returned; raises what it raised."""
        if isinstance(self.outcome, BaseException):
            raise self.outcome
        return self.outcome


def in_processes(
    function: Callable[..., T], calls: Iterable[tuple[object, ...]], jobs: int, *also: str
) -> Generator[Ended[T], None, None]:
    """Call a function of a module with other arguments each time, ``jobs`` at a time.

    The processes end with this one, and with this generator; what they keep in temporary files
    goes with it, too. Call it from a thread that lasts.

    Parameters
    ----------
    calls
        Their arguments; taken as there is room.
    also
        Modules that the calls need besides.

    Yields
    ------
    ended : Ended
        In the order in which they end.
    """
    # Taken over by the process that all others are forked from.
    os.environ |= ENVIRONMENT | {ASKS: str(os.getpid())}
    context = get_context("forkserver")
    context.set_forkserver_preload([*_PRELOADED, *also, _WARM])
    waiting = enumerate(calls)
    live: dict[Connection, tuple[int, ForkServerProcess]] = {}
    with tempfile.TemporaryDirectory(prefix="kompass-drill-", ignore_cleanup_errors=True) as folder:
        try:
            while True:
                while len(live) < jobs and (call := next(waiting, None)) is not None:
                    index, arguments = call
                    ours, theirs = context.Pipe(duplex=False)
                    process = context.Process(
                        target=_answer, args=(theirs, folder, function, arguments)
                    )
                    started = True
                    with _undisturbed():
                        try:
                            with theirs:
                                process.start()
                            live[ours] = index, process
                        except (EOFError, OSError):  # it, or what it is forked from, has ended
                            ours.close()
                            started = False
                    if not started:
                        yield Ended(index, ProcessEnded())
                if not live:
                    return
                ready = wait(list(live))
                for ours in [one for one in live if one in ready]:
                    index, process = live[ours]
                    ended = Ended(index, cast("T | BaseException", _heard(ours)))
                    process.join(_GOING)
                    if isinstance(ended.outcome, ProcessEnded):
                        ended.outcome.code = process.exitcode
                    _leave(ours, process)
                    del live[ours]
                    yield ended
        finally:
            for ours, (_, process) in live.items():
                _leave(ours, process)


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Ctrl-C and SIGTERM come after what is inside.

    What is half asked for would have the process that all are forked from tell of an error; and
    a process that has begun and is not known of yet would be ended by nobody.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # signals come to the main thread
        return
    came: list[int] = []
    before = {
        number: signal.signal(number, lambda number, _: came.append(number))
        for number in (signal.SIGINT, signal.SIGTERM)
    }
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if came:
            signal.raise_signal(came[0])


def _heard(connection: Connection) -> object:
    try:
        return connection.recv()
    except (EOFError, OSError):
        return ProcessEnded()


def _leave(connection: Connection, process: ForkServerProcess) -> None:
    process.kill()
    process.join()
    process.close()
    connection.close()


def _answer(
    connection: Connection,
    folder: str,
    function: Callable[..., object],
    arguments: tuple[object, ...],
) -> None:
    """In a process of its own."""
    from kompass.drills.runner.preloaded import SERVER

    end_with(SERVER)
    keep_descendants()
    tempfile.tempdir = folder
    try:
        outcome = function(*arguments)
    except BaseException as error:  # noqa: BLE001 - it is told to who asked
        outcome = _as_it_travels(error)
    connection.send(outcome)
    end_children()


def _as_it_travels(error: BaseException) -> BaseException:
    """An error without what cannot be told to another process, or would be somebody's Ctrl-C."""
    if isinstance(error, KeyboardInterrupt):
        return RuntimeError("KeyboardInterrupt is raised")
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # noqa: BLE001 - whatever its own methods raise
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
