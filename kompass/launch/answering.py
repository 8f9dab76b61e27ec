"""Answers what the monitor asks of components over their channel."""

from __future__ import annotations

import socket
import threading
from collections.abc import Mapping, Sequence
from functools import partial

from kompass.access.signed_services import NoSuchService
from kompass.bus.node import Executor
from kompass.channel.answer import Answer
from kompass.channel.channels import Send
from kompass.channel.life import Life, own_life
from kompass.channel.packet import receive_packet, send_packet
from kompass.channel.request import Request
from kompass.components.base.component import Component

Running = Sequence[tuple[Component, Executor]]


class Answering:
    """Each request is carried out on the thread of its component's executor.

    Parameters
    ----------
    life
        Of this process.
    running
        Its components, and their executors.
    send
        Sends an answer.
    """

    def __init__(self, life: Life, running: Running, send: Send) -> None:
        self._life, self._send = life, send
        self._running = {component.node_name: (component, each) for component, each in running}

    def take(self, packet: bytes) -> None:
        """Have what came over the channel carried out; what a dead process left is not for us."""
        request = Request.of_packet(packet)
        if request.answerer == self._life:
            component, executor = self._running[request.node]
            executor.create_task(self._answer, component, request)

    async def _answer(self, component: Component, request: Request) -> None:
        log = component.node.get_logger()
        if request.is_late(component.clock.monotonic()):
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
        if not self._send(answer.to_packet()):
            log.error(f"{request.service}: no answer: the monitor does not read")


def answer_over(channels: Mapping[str, int], running: Running) -> None:
    """Read from a channel, in a thread of its own, until the process ends.

    Parameters
    ----------
    channels
        File descriptors of our ends, by the name of the node that is asked: all the same.
    running
        Components of this process, and their executors.
    """
    (descriptor,) = set(channels.values())
    end = socket.socket(fileno=descriptor)
    answering = Answering(own_life(), running, partial(send_packet, end))

    def read() -> None:
        while (packet := receive_packet(end)) is not None:
            answering.take(packet)

    # Blocked in a read nearly always.
    threading.Thread(target=read, name="channel", daemon=True).start()
