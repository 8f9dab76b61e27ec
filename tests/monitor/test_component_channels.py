"""What the monitor asks of a component is answered by that life of it, to this life of ours."""

import os
import socket
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest

from kompass.access.gatekeeper import NotAdmitted
from kompass.bus.clock import SYSTEM
from kompass.channel.answer import Answer
from kompass.channel.channels import Channels
from kompass.channel.life import own_life
from kompass.channel.packet import receive_packet, send_packet
from kompass.channel.pair import open_pair
from kompass.channel.request import Request
from kompass.monitor.execution.component_channels import ComponentChannels, DiedFirst
from kompass.monitor.incoming import incoming
from kompass.rclpy_ext.awaitables import Awaitables
from kompass.rclpy_ext.executor import Task
from kompass.rclpy_ext.timers import Timers
from kompass.supervisor.news import ProcessCondition, ProcessNews
from tests.support.spinning import Spinning

pytestmark = pytest.mark.ros


class Asking:
    """The monitor's end of the channel to a component, and the end of that."""

    def __init__(self, spinning: Spinning) -> None:
        self.spinning = spinning
        pair = open_pair()
        self.end = socket.socket(fileno=pair.asker)
        self.other = socket.socket(fileno=pair.answerer)
        awaitables = Awaitables(Timers(spinning.node), spinning.executor)
        channels = Channels(own_life(), {"lamp": partial(send_packet, self.end)})
        self.channels = ComponentChannels(channels, awaitables, SYSTEM)

    def news(self, state: ProcessCondition, pid: int = 7, reason: str = "") -> None:
        self.channels.changed(ProcessNews("lamp", ["lamp"], state, pid, reason=reason, born=70))

    def ask(self, body: bytes = b"on", timeout: float | None = None) -> Callable[[], Any]:
        """Ask the lamp; what is returned waits for the answer."""
        results: list[Any] = []
        ends: list[BaseException | None] = []

        async def ask() -> None:
            results.append(
                await self.channels.ask("lamp", "switch", body, timeout, "no answer from lamp")
            )

        Task(ask(), ends.append)

        def result() -> Any:
            self.spinning.until(lambda: ends)
            if ends[0] is not None:
                raise ends[0]
            return results[0]

        return result

    def asked(self) -> Request:
        packet = receive_packet(self.other, wait=False)
        assert packet, "nothing was asked"
        return Request.of_packet(packet)

    def close(self) -> None:
        self.other.close()
        self.end.close()


@pytest.fixture
def asking(spinning: Spinning) -> Iterator[Asking]:
    made = Asking(spinning)
    yield made
    made.close()


def test_the_answer_is_for_whoever_asked_and_no_namesake(asking: Asking) -> None:
    asking.news("active")
    result = asking.ask()
    request = asking.asked()
    assert request.asker == own_life()
    assert (request.answerer.pid, request.answerer.born) == (7, 70)
    assert (request.node, request.service, request.body) == ("lamp", "switch", b"on")
    assert request.until is None
    of_another = own_life()._replace(pid=own_life().pid + 1)
    asking.channels.answered(Answer(request.number, of_another, "", b"not mine").to_packet())
    asking.channels.answered(Answer(request.number + 1, own_life(), "", b"later").to_packet())
    asking.channels.answered(Answer(request.number, own_life(), "", b"mine").to_packet())
    asking.channels.answered(Answer(request.number, own_life(), "", b"again").to_packet())
    assert result() == b"mine"
    asking.channels.answered(Answer(request.number, own_life(), "", b"too late").to_packet())


def test_what_the_service_says_of_itself_is_raised(asking: Asking) -> None:
    asking.news("active")
    result = asking.ask()
    number = asking.asked().number
    asking.channels.answered(Answer(number, own_life(), "there is none", b"").to_packet())
    with pytest.raises(NotAdmitted, match="there is none"):
        result()


def test_who_does_not_answer_in_time_is_given_until_then(asking: Asking) -> None:
    asking.news("active")
    before = time.monotonic()
    result = asking.ask(timeout=0.2)
    until = asking.asked().until
    assert until is not None
    assert before + 0.2 <= until <= time.monotonic() + 0.2
    with pytest.raises(TimeoutError, match=r"no answer from lamp within 0\.2 s"):
        result()


@pytest.mark.parametrize("states", [(), ("starting",), ("active", "dead"), ("active", "given up")])
def test_who_is_not_up_is_not_asked(asking: Asking, states: tuple[ProcessCondition, ...]) -> None:
    for state in states:
        asking.news(state)
    assert asking.ask()() is None
    assert receive_packet(asking.other, wait=False) == b""


@pytest.mark.parametrize("state", ["active", "busy", "stuck"])
def test_who_is_up_is_asked_whatever_it_does(asking: Asking, state: ProcessCondition) -> None:
    asking.news(state)
    asking.ask()
    assert asking.asked().service == "switch"


def test_who_does_not_read_is_not_asked_this_way(asking: Asking) -> None:
    asking.news("active")
    packets = 0
    while send_packet(asking.end, b"x" * 1000):
        packets += 1
    assert asking.ask()() is None
    for _ in range(packets):
        receive_packet(asking.other)
    assert receive_packet(asking.other, wait=False) == b""


def test_the_death_of_who_was_asked_is_told_at_once(asking: Asking) -> None:
    asking.news("active")
    result = asking.ask(timeout=1000.0)
    asking.news("busy")
    asking.news("dead", reason="the process was killed by SIGKILL")
    with pytest.raises(DiedFirst) as raised:
        result()
    text = "lamp died before it answered: the process was killed by SIGKILL"
    assert str(raised.value) == text


def test_so_it_is_when_only_its_successor_is_heard_of(asking: Asking) -> None:
    asking.news("active")
    result = asking.ask()
    asking.news("active", pid=8)
    with pytest.raises(DiedFirst, match=r"lamp died before it answered: .* started anew"):
        result()
    asking.ask()
    assert asking.asked().answerer.pid == 7
    assert asking.asked().answerer.pid == 8


def test_what_a_process_has_said_is_heard_before_its_death() -> None:
    pair = open_pair()
    inbox, outbox = os.pipe()
    with socket.socket(fileno=pair.asker) as ours, socket.socket(fileno=pair.answerer) as other:
        heard = incoming(inbox, [ours])
        for number in range(3):
            assert send_packet(other, f"answer {number}".encode())
        os.write(outbox, b"it died\nit lives\nit d")
        assert [next(heard) for _ in range(5)] == [
            *(b"answer 0", b"answer 1", b"answer 2"),
            *("it died", "it lives"),
        ]
        os.write(outbox, b"ied\n")
        assert next(heard) == "it died"
        os.close(outbox)
        assert list(heard) == []
    os.close(inbox)
