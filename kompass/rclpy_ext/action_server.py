"""An action server that forgets goals that have ended."""

from __future__ import annotations

from rclpy.action import ActionServer


class ForgetfulActionServer(ActionServer):  # type: ignore[misc]  # rclpy has no types
    """An action server under the events executor.

    rclpy's timer for what has ended does nothing there (7.1.6): each goal and its result would be
    kept for good.
    """

    async def expire_goals(self) -> None:
        """Forget the goals that ended longer ago than the result timeout.

        To be run on the thread of its executor.
        """
        known = len(self._goal_handles)
        if known:
            await self._execute_expire_goals(self._handle.expire_goals(known))
