"""Tells each webhook in its own time: nobody waits for it, and no webhook for another."""

from __future__ import annotations

import asyncio
import json
import logging
import time
import uuid
from collections import deque
from collections.abc import Awaitable, Callable, Sequence

from kompass_console.schema.models import State
from kompass_console.schema.plain import plain
from kompass_console.webhooks.notice import Notice, NoticeFinder
from kompass_console.webhooks.post import NotTaken, post
from kompass_console.webhooks.settings import Webhook

PERIOD = 0.5  # s between two looks at the robot
PAUSES = (1.0, 5.0, 20.0, 60.0)  # s before a notice is tried again; then it is given up
WAITING = 50  # notices of one webhook; of more the oldest go

_logger = logging.getLogger(__name__)

Post = Callable[[Webhook, bytes], Awaitable[None]]


class Webhooks:
    """All webhooks of a console.

    Parameters
    ----------
    robot
        What the console calls the robot.
    sending
        How a body goes to a webhook.
    pauses
        Seconds before each further try.
    """

    def __init__(
        self,
        hooks: Sequence[Webhook],
        robot: str,
        *,
        sending: Post = post,
        pauses: Sequence[float] = PAUSES,
    ) -> None:
        self._robot = robot
        self._lines = [_Line(hook, sending, pauses) for hook in hooks]

    @property
    def problem(self) -> str:
        """Which webhooks do not take what they are told, as sentences; empty when all do."""
        return " ".join(line.problem for line in self._lines if line.problem)

    async def run(self, look: Callable[[], State]) -> None:
        """Tell of what happens until cancelled; without webhooks there is nothing to do."""
        if not self._lines:
            return
        finder = NoticeFinder()
        async with asyncio.TaskGroup() as sending:
            for line in self._lines:
                sending.create_task(line.run())
            while True:
                for notice in finder.look(look()):
                    self.tell(notice)
                await asyncio.sleep(PERIOD)

    def tell(self, notice: Notice) -> None:
        """Have a notice sent to whoever wants its kind. Never waits."""
        body = notice_body(self._robot, notice)
        for line in self._lines:
            if notice.kind in line.hook.kinds:
                line.put(body)


def notice_body(robot: str, notice: Notice) -> bytes:
    """What is sent of a notice; each time with another id."""
    said = {
        "version": 1,
        "id": uuid.uuid4().hex,
        "robot": robot,
        "time": round(time.time(), 3),
        "kind": notice.kind,
        "title": plain(notice.title),
        "body": plain(notice.body),
        "urgent": notice.urgent,
    }
    return json.dumps(said).encode()


class _Line:
    """What one webhook is still to be told."""

    def __init__(self, hook: Webhook, sending: Post, pauses: Sequence[float]) -> None:
        self.hook = hook
        self.problem = ""
        self._sending = sending
        self._pauses = pauses
        self._waiting: deque[bytes] = deque(maxlen=WAITING)
        self._some = asyncio.Event()
        self._lost = 0

    def put(self, body: bytes) -> None:
        self._lost += len(self._waiting) == WAITING
        self._waiting.append(body)
        self._some.set()

    async def run(self) -> None:
        while True:
            await self._some.wait()
            while self._waiting:
                await self._deliver(self._waiting.popleft())
            self._some.clear()

    async def _deliver(self, body: bytes) -> None:
        for pause in (*self._pauses, None):
            try:
                await self._sending(self.hook, body)
            except NotTaken as error:
                self._complain(plain(error))
                if pause is None or not error.again:
                    self._lost += 1
                    return
                await asyncio.sleep(pause)
            else:
                self._praise()
                return

    def _complain(self, why: str) -> None:
        begins = self.problem == ""
        self.problem = f"The webhook {self.hook.place} takes no notices: {why}."
        if begins:
            _logger.warning("%s It is tried again, and told of once.", self.problem)

    def _praise(self) -> None:
        if self.problem:
            missed = f"; {self._lost} got lost" if self._lost else ""
            _logger.warning("The webhook %s takes notices again%s.", self.hook.place, missed)
        self.problem, self._lost = "", 0
