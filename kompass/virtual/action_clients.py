"""``rclpy.action.ActionClient``, which recipes make on whatever node their components have."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import rclpy.action
from rclpy.action import ActionClient

from kompass.virtual.node import VirtualNode


class _OnAnyNode(ActionClient):  # type: ignore[misc]
    """On a node of virtual time it is one of virtual time."""

    def __new__(cls, node: Any, action_type: Any, action_name: str, **options: Any) -> Any:
        if not isinstance(node, VirtualNode):
            return super().__new__(cls)
        if options:
            raise TypeError(
                f"ActionClient({action_name!r}): {', '.join(options)} is not possible in virtual "
                "time; leave it out"
            )
        return node.create_action_client(action_type, action_name)


@contextmanager
def action_clients_on_any_node() -> Iterator[None]:
    """While it lasts, ``from rclpy.action import ActionClient`` fits nodes of both kinds."""
    before = rclpy.action.ActionClient
    rclpy.action.ActionClient = _OnAnyNode
    try:
        yield
    finally:
        rclpy.action.ActionClient = before
