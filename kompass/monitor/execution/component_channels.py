"""Requests to the components of this stack, each over the channel to its process."""

from __future__ import annotations

import itertools
from typing import NamedTuple

from rclpy.task import Future

from kompass.access.gatekeeper import NotAdmitted
from kompass.bus.clock import Clock
from kompass.channel.answer import Answer
from kompass.channel.channels import Channels
from kompass.channel.life import Life
from kompass.channel.request import Request
from kompass.rclpy_ext.awaitables import Awaitables
from kompass.supervisor.news import ProcessNews

UP = ("active", "busy", "stuck")  # states of a process that has reached its loop


class DiedFirst(Exception):
    """The process that was asked is dead; the message says so."""


class _Open(NamedTuple):
    """A request that is not answered yet."""

    node: str
    life: Life
    answered: Future


class ComponentChannels:
    """Asks, and finds the request of an answer. On the thread of the monitor's executor.

    Parameters
    ----------
    channels
        Where there are any; who has none is not asked here.
    awaitables, clock
        Of that executor.
    """

    def __init__(self, channels: Channels | None, awaitables: Awaitables, clock: Clock) -> None:
        self._channels, self._awaitables, self._clock = channels, awaitables, clock
        self._lives: dict[str, Life] = {}  # of the processes that are up, by component
        self._open: dict[int, _Open] = {}
        self._numbers = itertools.count(1)

    def changed(self, news: ProcessNews) -> None:
        """Take the state of a process; what was asked of one that is dead fails at once."""
        life = Life(news.pid, news.born)
        for node in news.nodes:
            if news.state in UP:
                self._lives[node] = life
            else:
                self._lives.pop(node, None)
        is_dead = news.state in ("dead", "given up")
        for each in list(self._open.values()):
            if each.node in news.nodes and (is_dead or each.life != life):
                why = news.reason if is_dead else "its process was started anew"
                self._end(each, DiedFirst(f"{each.node} died before it answered: {why}"))

    def answered(self, packet: bytes) -> None:
        """Take what came over a channel."""
        answer = Answer.of_packet(packet)
        each = self._open.get(answer.number)
        # Answers to the monitor before this one, and to who does not wait any more, are nobody's.
        asker = None if self._channels is None else self._channels.life
        if each is not None and answer.asker == asker:
            self._end(each, NotAdmitted(answer.problem) if answer.problem else answer.body)

    async def ask(
        self, node: str, service: str, body: bytes, timeout: float | None, what: str
    ) -> bytes | None:
        """Ask a component.

        Parameters
        ----------
        node
            Name of the component.
        service
            The last part of the service's name.
        body
            The request as ROS serialises it; the answer too.
        timeout
            For how long to wait [s]; None for ever. After that the request is not begun any more.
        what
            Named in the error.

        Returns
        -------
        bytes or None
            None when it was not asked: there is no channel to it, its process is not up, or it does
            not read.

        Raises
        ------
        TimeoutError
            When there is no answer in time.
        DiedFirst
            When it died before it answered.
        NotAdmitted
            When the service gave no answer; the message says why.
        """
        channels, life = self._channels, self._lives.get(node)
        if channels is None or life is None or node not in channels.send:
            return None
        number = next(self._numbers)
        until = None if timeout is None else self._clock.monotonic() + timeout
        request = Request(number, channels.life, life, until, node, service, body)
        if not channels.send[node](request.to_packet()):
            return None
        each = self._open[number] = _Open(node, life, self._awaitables.future())
        try:
            return bytes(await self._awaitables.result(each.answered, timeout, what))
        finally:
            del self._open[number]

    def _end(self, each: _Open, answer: bytes | Exception) -> None:
        if each.answered.done():
            return
        if isinstance(answer, Exception):
            each.answered.set_exception(answer)
        else:
            each.answered.set_result(answer)
