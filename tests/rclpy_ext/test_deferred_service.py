"""A service may take its time to answer, and holds up nobody meanwhile."""

import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from std_srvs.srv import Trigger

from kompass.rclpy_ext.deferred_service import answered_by_worker, create_deferred_service
from kompass.rclpy_ext.main_thread import MainThread
from tests.support.spinning import Spinning


@pytest.fixture
def worker() -> Iterator[ThreadPoolExecutor]:
    with ThreadPoolExecutor(1) as pool:
        yield pool


class Client:
    """Asks one service."""

    def __init__(self, spinning: Spinning, name: str) -> None:
        self._spinning = spinning
        self._client = spinning.node.create_client(Trigger, name)
        spinning.until(self._client.service_is_ready)

    def ask(self) -> Any:
        """A future of the response."""
        return self._client.call_async(Trigger.Request())

    def answer(self) -> Trigger.Response:
        asked = self.ask()
        self._spinning.until(asked.done)
        return asked.result()


def test_an_answer_that_waits_holds_up_nobody(spinning: Spinning) -> None:
    future = MainThread(spinning.executor).future()

    async def wait(_request: Any, response: Any) -> Any:
        response.message = await future
        return response

    create_deferred_service(spinning.node, Trigger, "waits", wait)
    asked = Client(spinning, "waits").ask()
    other = spinning.executor.create_task(lambda: "done meanwhile")
    spinning.until(other.done)
    spinning.rest(0.1)
    assert not asked.done()
    future.set_result("at last")
    spinning.until(asked.done)
    assert asked.result().message == "at last"


def test_a_worker_makes_the_answer_while_the_executor_goes_on(
    spinning: Spinning, worker: ThreadPoolExecutor
) -> None:
    go_on = threading.Event()

    def answer(_request: Any, response: Any) -> Any:
        go_on.wait(10)
        response.message = threading.current_thread().name
        return response

    deferred = answered_by_worker(MainThread(spinning.executor), worker, answer)
    create_deferred_service(spinning.node, Trigger, "works", deferred)
    asked = Client(spinning, "works").ask()
    spinning.rest(0.1)
    assert not asked.done()
    go_on.set()
    spinning.until(asked.done)
    assert asked.result().message != threading.current_thread().name


@pytest.mark.parametrize("by_worker", [True, False])
def test_what_goes_wrong_is_the_answer(
    spinning: Spinning, worker: ThreadPoolExecutor, by_worker: bool
) -> None:
    def fail(_request: Any, _response: Any) -> Any:
        raise ValueError("as expected")

    async def fail_here(request: Any, response: Any) -> Any:
        fail(request, response)

    def failed(response: Any, error: Exception) -> Any:
        response.message = str(error)
        return response

    main = MainThread(spinning.executor)
    answer = answered_by_worker(main, worker, fail) if by_worker else fail_here
    name = f"fails_{by_worker}".lower()
    create_deferred_service(spinning.node, Trigger, name, answer, failed)
    response = Client(spinning, name).answer()
    assert (response.success, response.message) == (False, "as expected")


def test_where_no_answer_is_made_the_node_goes_on(spinning: Spinning) -> None:
    tries: list[int] = []

    async def answer(_request: Any, response: Any) -> Any:
        tries.append(1)
        if len(tries) == 1:
            raise RuntimeError("as expected")
        response.success = True
        return response

    create_deferred_service(spinning.node, Trigger, "once", answer)
    client = Client(spinning, "once")
    first = client.ask()
    assert client.answer().success
    assert not first.done()
