"""Answers of services come to asyncio and to threads alike, or end with a reason."""

import asyncio
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from std_srvs.srv import SetBool

from kompass.rclpy_ext.reply import NoAnswer, Reply
from tests.support.spinning import Spinning

pytestmark = pytest.mark.ros


@pytest.fixture
def ask(spinning: Spinning) -> Iterator[Callable[..., Reply[Any]]]:
    """Asks the service ``echo``, which may not be there."""
    client = spinning.node.create_client(SetBool, "echo")

    def asking(limit: float = 10.0, **more: Any) -> Reply[Any]:
        return Reply.of_service(client, "echo", SetBool.Request(data=True), limit, **more)

    yield asking
    spinning.node.destroy_client(client)


@pytest.fixture
def echo(spinning: Spinning) -> Iterator[None]:
    def answer(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        response.success, response.message = request.data, "heard"
        return response

    service = spinning.node.create_service(SetBool, "echo", answer)
    yield
    spinning.node.destroy_service(service)


def spin(spinning: Spinning) -> Callable[[], None]:
    return lambda: spinning.executor.spin_once(timeout_sec=0.02)


def test_a_thread_that_spins_waits_for_a_server_to_come(
    spinning: Spinning, ask: Callable[..., Reply[Any]], echo: None
) -> None:
    assert ask(read=lambda answer: answer.message).wait(spin(spinning)) == "heard"


def test_asyncio_waits_while_another_thread_spins(
    spinning: Spinning, ask: Callable[..., Reply[Any]], echo: None
) -> None:
    reply, ended = ask(), threading.Event()

    def run() -> None:
        while not ended.is_set():
            spinning.executor.spin_once(timeout_sec=0.02)

    thread = threading.Thread(target=run)
    thread.start()
    try:
        assert asyncio.run(reply.answer()).success
        assert ask().wait().success
    finally:
        ended.set()
        thread.join()


def test_what_reading_the_answer_raises_is_raised_where_it_is_waited_for(
    spinning: Spinning, ask: Callable[..., Reply[Any]], echo: None
) -> None:
    def refuse(answer: SetBool.Response) -> None:
        raise ValueError(answer.message)

    with pytest.raises(ValueError, match="heard"):
        ask(read=refuse).wait(spin(spinning))


def test_nobody_there_is_told_within_the_limit(
    spinning: Spinning, ask: Callable[..., Reply[Any]]
) -> None:
    with pytest.raises(NoAnswer, match=r"echo did not answer within 0\.1 s"):
        ask(limit=0.1).wait(spin(spinning))
    with pytest.raises(NoAnswer, match=r"echo did not answer within 0\.1 s"):
        asyncio.run(ask(limit=0.1).answer())


def test_a_client_that_goes_while_it_is_waited_for_is_told(spinning: Spinning) -> None:
    client = spinning.node.create_client(SetBool, "nowhere")
    reply: Reply[Any] = Reply.of_service(client, "nowhere", SetBool.Request(), 10.0)
    spinning.node.destroy_client(client)
    with pytest.raises(NoAnswer, match="nowhere has just gone"):
        reply.wait(spin(spinning))
