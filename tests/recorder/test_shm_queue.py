"""The monitor never waits for the recorder, and the recorder loses nothing unnoticed."""

import os
import signal

from kompass.recorder.shm_queue import ShmQueue
from tests.support.processes import wait_until


def test_frames_arrive_as_they_were_sent_and_in_order() -> None:
    queue = ShmQueue(capacity=4096)
    sent = []
    received = []
    for number in range(500):  # many times around
        raw = bytes([number % 256]) * (number % 700)
        assert queue.write(number, number % 3 == 0, f"topic{number}", "a/msg/B", raw)
        sent.append((number + 1, number, number % 3 == 0, f"topic{number}", "a/msg/B", raw))
        if number % 4 == 3:
            received += [tuple(frame) for frame in queue.read()]
            queue.commit()

    assert received == sent


def test_what_does_not_fit_is_refused_at_once_and_missing_numbers_tell() -> None:
    queue = ShmQueue(capacity=1000)
    taken = [queue.write(0, False, "scan", "", bytes(300)) for _ in range(5)]

    assert taken == [True, True, False, False, False] or taken == [True, True, True, False, False]
    count = sum(taken)
    assert [frame.sequence for frame in queue.read()] == list(range(1, count + 1))
    queue.commit()
    assert not queue.write(0, False, "map", "", bytes(2000)), "larger than the lane"
    assert queue.write(0, False, "scan", "", b"")
    assert [frame.sequence for frame in queue.read()] == [7]


def test_what_is_not_on_disk_is_read_again_by_the_next_reader() -> None:
    queue = ShmQueue(capacity=4096)
    for number in range(6):
        queue.write(number, False, "scan", "", b"x")
    assert len(queue.read()) == 6
    queue.commit()
    queue.write(6, False, "scan", "", b"y")
    assert [frame.now_ns for frame in queue.read()] == [6]

    queue.resume()

    assert [frame.now_ns for frame in queue.read()] == [6]


def test_frames_survive_the_death_of_their_writer_at_any_moment() -> None:
    queue = ShmQueue(capacity=1 << 20)
    read = 0
    for _ in range(5):
        pid = os.fork()
        if pid == 0:
            while True:
                queue.write(1, False, "scan", "t", os.urandom(200))
        wait_until(lambda: queue.fill > 0.01, 5, "the first frames")
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
        frames = queue.read()
        assert frames
        assert all(len(frame.raw) == 200 for frame in frames)
        queue.commit()
        read += len(frames)
        assert queue.write(2, True, "event", "", b"{}")
        (after,) = queue.read()
        assert (after.topic, after.raw) == ("event", b"{}")
        queue.commit()
    assert read > 100
