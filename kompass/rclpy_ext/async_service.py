"""A service whose callback is a coroutine, on whatever executor spins the node."""

from collections.abc import Awaitable, Callable
from typing import Any

from rclpy.lifecycle import LifecycleNode


def create_async_service(
    node: LifecycleNode, kind: Any, name: str, callback: Callable[[Any, Any], Awaitable[Any]]
) -> Any:
    """Offer a service that may take seconds to answer, while the node goes on with its work.

    The events executor hands what a callback returns straight to ``send_response`` (rclpy 7.1.6),
    also when that is a coroutine; the other executors await it themselves. So it is awaited here,
    in a task of the executor, where nobody has done so.

    Parameters
    ----------
    callback
        Takes request and response, returns the response; must not raise.
    """
    service = node.create_service(kind, name, callback)
    send = service.send_response

    def send_response(response: Any, header: Any) -> None:
        if not isinstance(response, Awaitable):
            send(response, header)
            return

        async def answer() -> None:
            try:
                send(await response, header)
            except Exception as error:  # noqa: BLE001 - told; it would end the process (rclpy 7.1.6)
                node.get_logger().error(f"{name}: no answer: {type(error).__name__}: {error}")

        node.executor.create_task(answer)

    service.send_response = send_response
    return service
