"""Services whose answers are made on another thread, while the executor goes on."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from rclpy.node import Node

from kompass.rclpy_ext.main_thread import MainThread


class _Later:
    """Stands for an answer that is on its way."""

    def __init__(self) -> None:
        self.header: Any = None


def create_deferred_service(
    node: Node,
    main: MainThread,
    worker: ThreadPoolExecutor,
    kind: Any,
    name: str,
    answer: Callable[[Any, Any], Any],
    failed: Callable[[Any, Exception], Any],
) -> Any:
    """Offer a service that is answered by a worker.

    The events executor (rclpy 7.1.6) takes what a callback returns for the response; what stands
    for one is kept back here until the response is there.

    Parameters
    ----------
    answer
        Takes request and response, returns the response; called on the worker.
    failed
        Takes the response and what ``answer`` raised; returns the response that says so.
    """

    def take(request: Any, response: Any) -> _Later:
        later = _Later()

        def work() -> None:
            try:
                made = answer(request, response)
            except Exception as error:  # noqa: BLE001 - becomes the answer
                node.get_logger().error(f"{name}: {type(error).__name__}: {error}")
                made = failed(kind.Response(), error)
            # By then the executor has told the header: it does so before it takes the next task.
            main.post(lambda: send(made, later.header))

        worker.submit(work)
        return later

    service = node.create_service(kind, name, take)
    send = service.send_response

    def send_response(response: Any, header: Any) -> None:
        if isinstance(response, _Later):
            response.header = header
        else:
            send(response, header)

    service.send_response = send_response
    return service
