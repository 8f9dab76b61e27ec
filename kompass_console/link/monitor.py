"""The monitor's services: the rule table, its history and its firings, asked and changed."""

from __future__ import annotations

from typing import Any

from kompass_interfaces.srv import (
    ApplyRules,
    CheckRules,
    ConfirmRules,
    DescribeGraph,
    ExplainRule,
    GetFirings,
    GetHistory,
    GetRules,
    ResetRule,
    RollbackRules,
    SaveRecording,
)
from rclpy.node import Node

from kompass_console.link.discovery import Graph
from kompass_console.link.services import NoAnswer, ServicePool

# Seconds to wait for an answer. Checking and applying compile the table; a recording is written.
_TIMEOUTS: dict[type[Any], float] = {
    GetRules: 5.0,
    CheckRules: 15.0,
    ApplyRules: 20.0,
    ConfirmRules: 5.0,
    RollbackRules: 20.0,
    ResetRule: 5.0,
    ExplainRule: 5.0,
    GetHistory: 5.0,
    GetFirings: 5.0,
    DescribeGraph: 10.0,
    SaveRecording: 60.0,
}


class Monitor:
    """Clients for every service of the monitor on the graph."""

    def __init__(self, node: Node) -> None:
        self._pools = {
            kind: ServicePool(node, kind, f"kompass_interfaces/srv/{kind.__name__}")
            for kind in _TIMEOUTS
        }

    def refresh(self, services: Graph) -> None:
        """Keep the services connected that are there now."""
        for pool in self._pools.values():
            pool.refresh(services)

    @property
    def there(self) -> bool:
        """Whether a monitor with a rule table is on the graph."""
        return bool(self._pools[GetRules].names)

    async def ask(self, request: Any) -> Any:
        """The answer to a request of one of the services, by the request's type.

        Raises NoAnswer when there is no monitor or it does not answer in time.
        """
        kind = _kind_of(request)
        pool = self._pools[kind]
        if not pool.names:
            raise NoAnswer("no monitor is there")
        return await pool.call(request, _TIMEOUTS[kind])


def _kind_of(request: Any) -> type[Any]:
    return next(kind for kind in _TIMEOUTS if isinstance(request, kind.Request))
