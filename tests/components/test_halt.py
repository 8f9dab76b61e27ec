"""When zero is sent in the place of a drive manager."""

import pytest

from kompass.components.drive.halt import HALTING, HaltWatch
from kompass.supervisor.news import ProcessCondition, ProcessNews


def news(state: ProcessCondition, *, stopped: bool = False, node: str = "gate") -> ProcessNews:
    return ProcessNews(node, [node], state, stopped=stopped)


@pytest.mark.parametrize(
    "lost", [news("dead"), news("stuck"), news("busy"), news("busy", stopped=True)]
)
def test_zero_is_sent_from_its_loss_until_it_works_again(lost: ProcessNews) -> None:
    watch = HaltWatch(["gate"])
    assert not watch.halts(0.0)
    watch.note(lost, 0.0)
    assert watch.halts(0.0)
    watch.note(news("starting"), 5.0)
    assert watch.halts(100.0)
    watch.note(news("active"), 101.0)
    assert not watch.halts(101.0)


def test_a_gate_that_comes_up_for_the_first_time_is_not_spoken_for() -> None:
    watch = HaltWatch(["gate"])
    watch.note(news("starting"), 0.0)
    assert not watch.halts(0.0)


def test_the_loss_of_another_process_is_not_its_business() -> None:
    watch = HaltWatch(["gate"])
    watch.note(news("dead", node="mapper"), 0.0)
    assert not watch.halts(0.0)


def test_a_base_whose_gate_was_given_up_is_left_to_others_after_a_second() -> None:
    watch = HaltWatch(["gate"])
    watch.note(news("dead"), 0.0)
    watch.note(news("given up"), 10.0)
    assert watch.halts(10.0 + 0.9 * HALTING)
    assert not watch.halts(10.0 + 1.1 * HALTING)


def test_two_gates_are_spoken_for_one_by_one() -> None:
    watch = HaltWatch(["gate", "other"])
    watch.note(news("dead"), 0.0)
    watch.note(news("active", node="other"), 1.0)
    assert watch.halts(1.0)


def test_an_orderly_end_of_the_stack_needs_no_zero() -> None:
    watch = HaltWatch(["gate"])
    watch.note_end(0.0, orderly=True)
    assert not watch.halts(0.0)


@pytest.mark.parametrize("orderly", [True, False])
def test_the_end_of_a_stack_whose_gate_cannot_halt_gets_a_second_of_zeros(orderly: bool) -> None:
    watch = HaltWatch(["gate"])
    if orderly:
        watch.note(news("dead"), 0.0)  # it did not end, and was killed
    watch.note_end(1.0, orderly=orderly)
    assert watch.halts(1.0 + 0.9 * HALTING)
    assert not watch.halts(1.0 + 1.1 * HALTING)
