"""Who dies again and again is given more and more rest, and is given up in the end."""

from kompass.supervisor.restarts import DELAYS, HEALTHY, Restarts


def test_the_rest_grows_and_then_the_process_is_given_up() -> None:
    restarts = Restarts(retries=7)
    delays = [restarts.after_death("a", 0.1) for _ in range(8)]
    assert delays == [*DELAYS, DELAYS[-1], DELAYS[-1], None]
    assert restarts.in_a_row("a") == 8


def test_a_healthy_life_wipes_the_slate_clean() -> None:
    restarts = Restarts(retries=1)
    assert restarts.after_death("a", 0.1) == DELAYS[0]
    assert restarts.after_death("a", HEALTHY + 1) == DELAYS[0]
    assert restarts.after_death("a", 0.1) is None


def test_processes_are_counted_apart() -> None:
    restarts = Restarts(retries=1)
    restarts.after_death("a", 0.1)
    assert restarts.after_death("b", 0.1) == DELAYS[0]
    assert restarts.ever_died("a")
    assert not restarts.ever_died("c")
