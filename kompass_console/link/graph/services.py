"""Calls to services that are found by type, from any thread, each with a deadline."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Collection
from copy import copy
from typing import Any

from rclpy.node import Node

from kompass.access.signer import Signer
from kompass.rclpy_ext.reply import SEARCH_PERIOD, NoAnswer, Reply
from kompass.signing.canonical import PROOF
from kompass.signing.key import RobotKey
from kompass.store.robot_key import known_keys
from kompass_console.link.graph.discovery import Graph, of_type


async def found(there: Callable[[], object], within: float) -> None:
    """Wait until something is found whose stack, or the console, has just come; not for ever.

    Parameters
    ----------
    there
        What tells, by something that is true, that it was found.
    within
        Seconds at most.
    """
    deadline = time.monotonic() + within
    while not there() and time.monotonic() < deadline:
        await asyncio.sleep(SEARCH_PERIOD)


class ServicePool:
    """Clients for every service of one type on the graph, kept connected so that a call is one
    message there and one back.

    What has a field for a proof is signed, when we have the key of the robot.

    `refresh` runs on the link's thread; `call` on any. Nothing here waits for a lock that is
    held while something else is being done.
    """

    def __init__(self, node: Node, service_type: type[Any], type_name: str) -> None:
        self._node = node
        self._service_type = service_type
        self._type_name = type_name
        self._signed = PROOF in service_type.Request.get_fields_and_field_types()
        self._clients: dict[str, Any] = {}
        self._signers: dict[str, Signer] = {}

    @property
    def names(self) -> list[str]:
        return sorted(self._clients)

    def refresh(self, services: Graph) -> None:
        """Make clients for the services that are there now, and drop those of vanished ones."""
        found = of_type(services, self._type_name)
        clients = dict(self._clients)
        gone = [clients.pop(name) for name in list(clients) if name not in found]
        for name in found:
            if name not in clients:
                clients[name] = self._node.create_client(self._service_type, name)
        self._fit_signers(clients if self._signed else [])
        self._clients = clients
        for client in gone:
            self._node.destroy_client(client)

    async def call(self, request: Any, timeout: float, name: str | None = None) -> Any:
        """The answer of the named (None: the first) service of the pool.

        Raises
        ------
        NoAnswer
            When there is none, or after `timeout` seconds.
        """
        clients = self._clients
        name = min(clients, default=None) if name is None else name
        client = None if name is None else clients.get(name)
        if client is None or name is None:
            raise NoAnswer(f"no service of type {self._type_name} is there")
        answer: Reply[Any]
        if self._signed:
            # Each server has challenges of its own, so each is sent a request of its own.
            answer = self._signers[name].call(client, name, copy(request), timeout)
        else:
            answer = Reply.of_service(client, name, request, timeout)
        return await answer.answer()

    def key_of(self, name: str) -> RobotKey | None:
        """The key that the node of a service has, if it is among ours and was heard of."""
        signer = self._signers.get(name)
        return None if signer is None else signer.key

    def _fit_signers(self, names: Collection[str]) -> None:
        """Hear the challenges of the nodes that offer these services, and of no others."""
        signers = dict(self._signers)
        gone = [signers.pop(name) for name in list(signers) if name not in names]
        for name in names:
            if name not in signers:
                signers[name] = Signer(self._node, name.rpartition("/")[0], known_keys())
        self._signers = signers
        for signer in gone:
            signer.close()
