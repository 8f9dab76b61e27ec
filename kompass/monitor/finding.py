"""Which monitors there are: imports no messages, so that the search can begin at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from kompass.bus.node import Node

_FIND_SERVICE = "/get_rules"


def find_monitors(node: Node) -> list[str]:
    """Names of the monitors on the graph, with their namespaces, sorted."""
    named = dict(node.get_service_names_and_types())
    # A client makes a service's name appear as well.
    return [
        name for name in monitor_names(named) if node.count_services(f"{name}{_FIND_SERVICE}") > 0
    ]


def monitor_names(services: Mapping[str, Iterable[str]]) -> list[str]:
    """As `find_monitors`, from the services that are there and their types."""
    return sorted(
        name.removesuffix(_FIND_SERVICE)
        for name, types in services.items()
        if name.endswith(_FIND_SERVICE) and "kompass_interfaces/srv/GetRules" in types
    )
