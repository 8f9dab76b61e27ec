"""Let an action server forget goals that have ended."""

from __future__ import annotations

from typing import Any


async def expire_goals(server: Any) -> None:
    """Forget the goals of an rclpy action server that ended longer ago than its result timeout.

    The server's own timer for it does nothing under the events executor (rclpy 7.1.6): without
    this, each goal and its result are kept for good. To be run on the executor's thread.
    """
    known = len(server._goal_handles)
    if known:
        await server._execute_expire_goals(server._handle.expire_goals(known))
