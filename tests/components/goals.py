"""Goals for the action of a component that really runs."""

from typing import Any

from tests.components.alive import Alive


class Goals:
    """An action client of the test."""

    def __init__(self, alive: Alive, kind: type, name: str) -> None:
        self._alive, self._kind = alive, kind
        self._client = alive.action_client(kind, name)
        self.feedback: list[Any] = []
        alive.wait_until(self._client.server_is_ready, 10, f"the action {name}")

    def send(self, **fields: Any) -> Any:
        """Send a goal; its handle."""
        goal = self._kind.Goal(**fields)  # type: ignore[attr-defined]
        sent = self._alive.do(lambda: self._client.send_goal_async(goal, self.feedback.append))
        self._alive.wait_until(sent.done, 10, "the answer to the goal")
        return sent.result()

    def cancel(self, handle: Any) -> Any:
        """Ask for the end of a goal; the future answer."""
        return self._alive.do(handle.cancel_goal_async)

    def result(self, handle: Any) -> Any:
        """How a goal ended."""
        ended = self._alive.do(handle.get_result_async)
        self._alive.wait_until(ended.done, 10, "the end of the goal")
        return ended.result()
