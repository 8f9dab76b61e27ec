"""Answers what the monitor asks of components over their channel."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Mapping, Sequence

from kompass.access.signed_services import NoSuchService
from kompass.channel.answer import Answer
from kompass.channel.life import own_life
from kompass.channel.packet import receive_packet, send_packet
from kompass.channel.request import Request
from kompass.components.base.component import Component
from kompass.rclpy_ext.executor import TaskExecutor


class Answering:
    """One thread that reads; each request is carried out on the thread of its component's executor.

    Parameters
    ----------
    channels
        File descriptors of our ends, by the name of the node that is asked.
    running
        Components of this process, and their executors.
    """

    def __init__(
        self, channels: Mapping[str, int], running: Sequence[tuple[Component, TaskExecutor]]
    ) -> None:
        (descriptor,) = set(channels.values())
        self._end = socket.socket(fileno=descriptor)
        self._running = {component.node_name: (component, each) for component, each in running}
        self._life = own_life()
        # Blocked in a read nearly always.
        threading.Thread(target=self._read, name="channel", daemon=True).start()

    def _read(self) -> None:
        while (packet := receive_packet(self._end)) is not None:
            request = Request.of_packet(packet)
            if request.answerer == self._life:
                component, executor = self._running[request.node]
                executor.create_task(self._answer, component, request)

    async def _answer(self, component: Component, request: Request) -> None:
        log = component.node.get_logger()
        if request.is_late(time.monotonic()):
            # Held by a signal, or busy: whoever asked has been told that there was no answer.
            log.warning(f"{request.service}: asked too long ago, and not carried out")
            return
        body, problem = b"", ""
        try:
            body = await component.answer_call(request.service, request.body)
        except NoSuchService as error:
            problem = str(error)
        except Exception as error:  # noqa: BLE001 - becomes the answer
            problem = f"{type(error).__name__}: {error}"
            log.error(f"{request.service}: {problem}")
        answer = Answer(request.number, request.asker, problem, body)
        if not send_packet(self._end, answer.to_packet()):
            log.error(f"{request.service}: no answer: the monitor does not read")
