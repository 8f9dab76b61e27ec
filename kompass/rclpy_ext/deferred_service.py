"""Services that take their time to answer, while the executor goes on."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Any, Protocol

from rclpy.task import Future

from kompass.bus.node import Node
from kompass.rclpy_ext.main_thread import MainThread

# Takes request and response, gives the response to be sent.
DeferredAnswer = Callable[[Any, Any], Awaitable[Any]]
# Takes an empty response and what the answer raised; returns the response that says so.
FailedAnswer = Callable[[Any, Exception], Any]


class Worker(Protocol):
    """Does work that may block."""

    def submit(self, work: Callable[[], Any]) -> object:
        """Have it done."""


def create_deferred_service(
    node: Node,
    kind: Any,
    name: str,
    answer: DeferredAnswer,
    failed: FailedAnswer | None = None,
) -> Any:
    """Offer a service whose answer is a coroutine.

    The events executor hands what a callback returns straight to ``send_response`` (rclpy 7.1.6,
    ``ros2/rclpy`` issue 1473), also when that is a coroutine; the other executors await it
    themselves. So it is awaited here, in a task of the executor, where nobody has done so.

    Parameters
    ----------
    node
        Offers the service; must be in an executor by the time of the first request.
    kind
        Service type.
    name
        Of the service.
    answer
        A coroutine function.
    failed
        What to send when ``answer`` raises; left out, nothing is sent. Either way it is logged.

    Returns
    -------
    rclpy.service.Service
        The service.
    """

    async def respond(request: Any, response: Any) -> Any:
        try:
            return await answer(request, response)
        except Exception as error:
            if failed is None:
                raise
            node.get_logger().error(f"{name}: {type(error).__name__}: {error}")
            return failed(kind.Response(), error)

    service = node.create_service(kind, name, respond)
    defer_answers(node, service)
    return service


def defer_answers(node: Node, service: Any) -> None:
    """Let what answers a service be a coroutine function, as in `create_deferred_service`."""
    name, send = service.srv_name, service.send_response

    def send_response(response: Any, header: Any) -> None:
        if not isinstance(response, Awaitable):
            send(response, header)
            return

        async def send_when_ready() -> None:
            try:
                send(await response, header)
            except Exception as error:  # noqa: BLE001 - nobody awaits this task
                node.get_logger().error(f"{name}: no answer: {type(error).__name__}: {error}")

        node.executor.create_task(send_when_ready)

    service.send_response = send_response


def answered_by_worker(
    main: MainThread, worker: Worker, answer: Callable[[Any, Any], Any]
) -> DeferredAnswer:
    """Have answers made on a thread that may block.

    Parameters
    ----------
    main
        The thread of the node's executor.
    worker
        Calls ``answer``.
    answer
        Takes request and response, returns the response.

    Returns
    -------
    DeferredAnswer
        For :func:`create_deferred_service`; raises what ``answer`` raises.
    """

    async def respond(request: Any, response: Any) -> Any:
        made: Future = main.future()

        def work() -> None:
            try:
                result = answer(request, response)
            except Exception as error:  # noqa: BLE001 - raised where it is awaited
                made.set_exception(error)
            else:
                made.set_result(result)

        worker.submit(work)
        return await made

    return respond
