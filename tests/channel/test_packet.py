"""What is sent over a channel arrives whole, in its order, and never makes the sender wait."""

import os
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from kompass.channel.answer import Answer
from kompass.channel.life import Life, own_life
from kompass.channel.packet import INLINE, receive_packet, send_packet
from kompass.channel.pair import open_pair
from kompass.channel.request import Request

Ends = tuple[socket.socket, socket.socket]


@pytest.fixture
def ends() -> Iterator[Ends]:
    pair = open_pair()
    with socket.socket(fileno=pair.asker) as asker, socket.socket(fileno=pair.answerer) as answerer:
        yield asker, answerer


def test_packets_of_any_size_arrive_whole_and_in_their_order(ends: Ends) -> None:
    asker, answerer = ends
    before = len(list(Path("/proc/self/fd").iterdir()))
    for size in (1, 2, INLINE - 1, INLINE, INLINE + 1, 300_000, 5_000_000):
        packets = [os.urandom(size), b"after", os.urandom(size)]
        assert all(send_packet(asker, packet) for packet in packets)
        assert [receive_packet(answerer) for _ in packets] == packets
    assert len(list(Path("/proc/self/fd").iterdir())) == before


@pytest.mark.parametrize("size", [100, INLINE + 1])
def test_where_nobody_reads_the_sender_is_told_and_what_was_taken_stays(
    ends: Ends, size: int
) -> None:
    asker, answerer = ends
    taken = 0
    while taken < 100_000 and send_packet(asker, b"x" * size):
        taken += 1
    assert 100 < taken < 100_000
    for _ in range(taken):
        assert receive_packet(answerer, wait=False) == b"x" * size
    assert receive_packet(answerer, wait=False) == b""
    assert send_packet(asker, b"again")


def test_no_program_that_is_executed_gets_an_end(ends: Ends) -> None:
    assert [os.get_inheritable(end.fileno()) for end in ends] == [False, False]


def test_the_end_is_told_once_all_has_been_read(ends: Ends) -> None:
    asker, answerer = ends
    assert send_packet(asker, b"last")
    asker.close()
    assert receive_packet(answerer) == b"last"
    assert receive_packet(answerer) is None


def test_requests_and_answers_come_as_they_went() -> None:
    body = bytes(range(256)) + b"\n{}\n"
    life = own_life()
    assert life.pid == os.getpid()
    request = Request(7, life, Life(1, 2), 3.25, "a\nb", "é\n", body)
    assert Request.of_packet(request.to_packet()) == request
    assert not request.is_late(3.25)
    assert request.is_late(3.26)
    forever = request._replace(until=None)
    assert Request.of_packet(forever.to_packet()) == forever
    assert not forever.is_late(1e12)
    answer = Answer(7, life, 'no "such"\nthing', body)
    assert Answer.of_packet(answer.to_packet()) == answer
