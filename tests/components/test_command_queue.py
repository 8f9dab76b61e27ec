"""Commands hold as long as they say, and not longer."""

import math

import pytest
from kompass_interfaces.msg import TwistArray

from kompass.components.drive.command_queue import CommandQueue


def filled(count: int = 3) -> CommandQueue:
    queue = CommandQueue(timeout=0.3)
    queue.put([(0.1 * n, 0.0, 0.0) for n in range(1, count + 1)], time_step=0.1, now=10.0)
    return queue


def test_commands_follow_one_another_by_their_time_step() -> None:
    queue = filled()
    held = [queue.current(10.0 + t) for t in (0.0, 0.05, 0.15, 0.25)]
    assert held == [(v, 0.0, 0.0) for v in (0.1, 0.1, 0.2, 0.1 * 3)]


def test_the_last_command_holds_for_the_timeout_and_then_there_is_none() -> None:
    queue = filled()
    assert queue.current(10.55) == (0.1 * 3, 0.0, 0.0)
    assert queue.current(10.61) is None
    assert queue.is_stale(10.61)


def test_a_stream_that_ended_in_a_stop_is_not_stale() -> None:
    queue = CommandQueue(timeout=0.3)
    queue.put([(0.0, 0.0, 0.0)], time_step=0.1, now=10.0)
    assert not queue.is_stale(20.0)


def test_nothing_commanded_is_nothing_stale() -> None:
    queue = CommandQueue(timeout=0.3)
    assert queue.current(1.0) is None
    assert not queue.is_stale(1.0)


def test_a_new_list_replaces_the_old_one() -> None:
    queue = filled()
    queue.put([(0.0, 0.0, 1.0)], time_step=0.1, now=10.05)
    assert queue.current(10.06) == (0.0, 0.0, 1.0)


def test_lists_of_different_lengths_are_filled_with_zeros() -> None:
    queue = CommandQueue(timeout=0.3)
    message = TwistArray(time_step=0.1)
    message.linear_velocities.x = [0.2, 0.2]
    message.angular_velocities.z = [0.5]
    queue.put_array(message, now=0.0)
    assert queue.current(0.05) == (0.2, 0.0, 0.5)
    assert queue.current(0.15) == (0.2, 0.0, 0.0)


@pytest.mark.parametrize("time_step", [1e9, math.inf, math.nan, -1.0])
def test_a_list_that_would_hold_for_long_is_refused_and_nothing_is_carried_out(
    time_step: float,
) -> None:
    queue = filled()
    message = TwistArray(time_step=time_step)
    message.linear_velocities.x = [0.2]
    with pytest.raises(ValueError, match="time_step = "):
        queue.put_array(message, 10.0)
    assert queue.current(10.0) is None


def test_commands_that_are_no_numbers_are_refused_and_nothing_is_carried_out() -> None:
    queue = filled()
    with pytest.raises(ValueError, match="no finite numbers"):
        queue.put([(math.nan, 0.0, 0.0)], 0.0, 10.0)
    assert queue.current(10.0) is None
