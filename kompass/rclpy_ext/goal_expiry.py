"""Let an action server forget goals that have ended."""

from __future__ import annotations

from typing import Any


async def expire_goals(server: Any) -> None:
    """Forget the goals of an action server that ended longer ago than its result timeout.

    The server's own timer for it does nothing under the events executor (rclpy 7.1.6): without
    this, each goal and its result are kept for good.

    Parameters
    ----------
    server
        An :class:`rclpy.action.ActionServer`; this is to be run on the thread of its executor.
    """
    known = len(server._goal_handles)
    if known:
        await server._execute_expire_goals(server._handle.expire_goals(known))
