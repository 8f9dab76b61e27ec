"""The drive manager: what it says, STOP and its release."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from kompass_interfaces.msg import DriveState
from kompass_interfaces.srv import ReleaseStop, StopRobot
from rclpy.node import Node

from kompass.rclpy_ext.reply import NoAnswer
from kompass_console.link.graph.discovery import Graph, of_type
from kompass_console.link.graph.reader import Reader
from kompass_console.link.graph.services import ServicePool, found
from kompass_console.schema.models import DriveInfo
from kompass_console.schema.plain import LONGEST_LABEL, plain
from kompass_console.schema.world import Latest

AVAILABLE_WITHIN = 1.5  # s; the drive manager speaks on change and at 5 Hz
STOP_TIMEOUT = 1.0  # s
STOP_ASKED_AGAIN = 30.0  # s for which a STOP that nobody confirmed is asked for again
FOUND_WITHIN = 1.5  # s in which a service shows up of a stack that has just come
# A release is answered when it is on disk, for which the drive manager waits for 0.7 s, and may
# have to be signed anew. Nobody is in danger meanwhile.
RELEASE_TIMEOUT = 3.0  # s

_Said = tuple[bool, bool, str, str, str, str, str, int, float]


@dataclass(frozen=True, slots=True)
class DriveAnswer:
    """What the drive manager answered to STOP or release."""

    accepted: bool
    message: str


class DriveLink:
    """State and STOP of every drive manager on the graph (there should be one)."""

    def __init__(self, node: Node, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._said: Latest[_Said] = Latest()
        self._reader = Reader(node, DriveState, _said_of, self._store, latched=True)
        self._stops = ServicePool(node, StopRobot, "kompass_interfaces/srv/StopRobot")
        self._releases = ServicePool(node, ReleaseStop, "kompass_interfaces/srv/ReleaseStop")
        self._asking: asyncio.Task[None] | None = None
        self._pressed = 0  # STOPs from here

    def refresh(self, published: Graph, services: Graph) -> None:
        """Listen to the drive manager that is there now, and keep its services connected."""
        names = of_type(published, "kompass_interfaces/msg/DriveState")
        self._reader.follow(names[0] if names else None)
        self._stops.refresh(services)
        self._releases.refresh(services)

    def info(self) -> DriveInfo | None:
        """What it last said; None when it never said anything."""
        said = self._said.get()
        if said is None:
            return None
        age = said.age()
        stopped, standstill, stopped_by, reason, limited_by, driven_by, *_, speed_factor = (
            said.value
        )
        return DriveInfo(
            available=age < AVAILABLE_WITHIN,
            stopped=stopped,
            standstill=standstill,
            stopped_by=stopped_by,
            reason=reason,
            limited_by=limited_by,
            driven_by=driven_by,
            speed_factor=speed_factor,
            age=age,
        )

    @property
    def hand_session(self) -> str:
        """The word with which the wheel was taken, as it was last heard; empty when it is free."""
        said = self._said.get()
        return "" if said is None else said.value[6]

    @property
    def interruptions(self) -> int | None:
        """How often people pressed STOP or took the wheel; None when the robot never told."""
        said = self._said.get()
        return None if said is None else said.value[7]

    def since(self) -> Callable[[], bool]:
        """What tells whether STOP was pressed, or the wheel taken, after this call. Any thread.

        What was asked for before that must not begin after it, even if it was released meanwhile.
        """
        heard, pressed = self.interruptions, self._pressed

        def interrupted() -> bool:
            return self._pressed != pressed or (heard is not None and self.interruptions != heard)

        return interrupted

    async def stop(
        self, operator: str, reason: str, late: Callable[[DriveAnswer, float], object]
    ) -> DriveAnswer:
        """Latch STOP in every drive manager; accepted when all have said so.

        One that is not answered stands all the same: it is asked for again until it is answered,
        of whoever is there by then, for `STOP_ASKED_AGAIN` seconds. No release calls that off; a
        STOP that is pressed later takes its place.

        Parameters
        ----------
        operator, reason
            Who, and why.
        late
            Given the answer when it came after all, and how long after this call [s].

        Raises
        ------
        NoAnswer
            When none is found within `STOP_TIMEOUT`, or one does not answer within as much again.
        """
        self._pressed += 1
        if self._asking is not None:
            self._asking.cancel()
        request = StopRobot.Request(operator_name=operator, reason=plain(reason))
        pressed = time.monotonic()
        try:
            await found(lambda: self._stops.names, STOP_TIMEOUT)
            return await _ask_all(self._stops, request, STOP_TIMEOUT)
        except NoAnswer:
            if self._asking is not None:  # of one that was pressed meanwhile
                self._asking.cancel()
            self._asking = asyncio.create_task(self._ask_again(request, pressed, late))
            raise

    async def _ask_again(
        self, request: Any, pressed: float, late: Callable[[DriveAnswer, float], object]
    ) -> None:
        while time.monotonic() - pressed < STOP_ASKED_AGAIN:
            try:
                answer = await _ask_all(self._stops, request, STOP_TIMEOUT)
            except NoAnswer:
                await asyncio.sleep(0.1)  # it may have been refused at once
            else:
                late(answer, time.monotonic() - pressed)
                return

    async def release(self, operator: str) -> DriveAnswer:
        """Let the robot move again; as `stop`, but asked for once."""
        await found(lambda: self._releases.names, FOUND_WITHIN)
        request = ReleaseStop.Request(operator_name=operator)
        return await _ask_all(self._releases, request, RELEASE_TIMEOUT)

    def _store(self, said: _Said) -> None:
        before = self._said.get()
        self._said.set(said)
        if before is None or before.value[:-1] != said[:-1]:
            self._changed()


async def _ask_all(pool: ServicePool, request: Any, timeout: float) -> DriveAnswer:
    names = pool.names
    if not names:
        raise NoAnswer("no drive manager is there")
    answers = await asyncio.gather(*(pool.call(request, timeout, name) for name in names))
    refused = [a for a in answers if not a.success]
    return DriveAnswer(not refused, plain((refused or answers)[0].message))


def _said_of(message: Any) -> _Said:
    return (
        bool(message.stopped),
        bool(message.standstill),
        plain(message.stopped_by, LONGEST_LABEL),
        plain(message.reason),
        plain(message.limited_by),
        plain(message.driven_by, LONGEST_LABEL),
        plain(message.hand_session, LONGEST_LABEL),
        int(message.interruptions),
        float(message.speed_factor),
    )
