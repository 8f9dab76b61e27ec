"""The monitor that is on the graph now."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node

from kompass.monitor.client import MonitorClient, NoMonitor
from kompass.monitor.finding import monitor_names
from kompass_console.link.graph.discovery import Graph


class MonitorLink:
    """Keeps a client connected, so that a call is one message there and one back.

    Parameters
    ----------
    connected
        Told of every new client, on the link's thread.
    """

    def __init__(self, node: Node, connected: Callable[[MonitorClient], None]) -> None:
        self._node, self._connected = node, connected
        self._client: MonitorClient | None = None

    @property
    def client(self) -> MonitorClient:
        """Of the monitor that is there; any thread.

        Raises
        ------
        NoMonitor
            When there is none.
        """
        if self._client is None:
            raise NoMonitor
        return self._client

    def refresh(self, services: Graph) -> None:
        """Connect with the monitor that is there now. On the link's thread."""
        name = next(iter(monitor_names(services)), None)
        old = self._client
        if name == (None if old is None else old.name):
            return
        self._client = None if name is None else MonitorClient(self._node, name)
        if self._client is not None:
            self._connected(self._client)
        if old is not None:
            old.close()
