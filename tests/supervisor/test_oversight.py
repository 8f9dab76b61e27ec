from __future__ import annotations

import pytest

from kompass.supervisor.liveness import LivenessLimits
from kompass.supervisor.news import ProcessNews
from kompass.supervisor.oversight import Life, Oversight, StartupError
from kompass.supervisor.restarts import DELAYS, Restarts

LIMITS = LivenessLimits(busy=0.5, stuck=2.5, hung=10.0, killed=3.0)
BUSY, SILENT, HUNG = 1.0, 2.5, 10.0  # s that a loop has not come round


class Listener:
    """Hears what is told, of processes that are overseen."""

    def __init__(self, retries: int = 1) -> None:
        self.heard: list[ProcessNews] = []
        self.oversight = Oversight(LIMITS, Restarts(retries), self.heard.append)

    @property
    def states(self) -> list[tuple[str, str]]:
        return [(news.name, news.state) for news in self.heard]


def life(*nodes: str, name: str = "controller", restarts: int = 0) -> Life:
    return Life(name, nodes or [name], 7, 8, restarts, 0.0, active=True)


def test_only_what_changes_is_told() -> None:
    listener, one = Listener(), life()

    for now, lag in enumerate((0.1, BUSY, BUSY, 0.1, 0.1)):
        listener.oversight.assess(one, float(now), 0.0, {"controller": lag})

    assert listener.states == [("controller", "busy"), ("controller", "active")]


def test_one_that_never_comes_round_is_spoken_for_soon_and_killed_later() -> None:
    listener, one = Listener(), life()

    looks = [
        listener.oversight.assess(one, float(now), 0.0, {"controller": float(now)})
        for now in range(14)
    ]

    assert [now for now, look in enumerate(looks) if look.kill] == [13]
    assert looks[13].kill == "it was stuck for 10 s"
    assert listener.states == [("controller", "busy"), ("controller", "stuck")]
    assert listener.heard[1].reason == "its loop has not come round for 3.0 s"


def test_one_that_stays_stuck_is_to_be_killed_and_one_that_comes_round_is_not() -> None:
    listener, one, other = Listener(), life(), life()

    looks = [listener.oversight.assess(one, now, 0.0, {"controller": HUNG}) for now in (0, 2, 3)]
    assert [bool(look.kill) for look in looks] == [False, False, True]
    for now, lag in ((0, HUNG), (2, 0.1), (4, HUNG), (6, HUNG), (6.5, SILENT), (9, HUNG)):
        assert not listener.oversight.assess(other, now, 0.0, {"controller": lag}).kill


def test_of_nodes_that_share_a_process_the_one_that_hangs_is_told_of() -> None:
    listener, one = Listener(), life("planner", "mapper", name="components")

    listener.oversight.assess(one, 1.0, 0.0, {"planner": SILENT, "mapper": 0.1})

    assert [(news.name, news.nodes, news.state) for news in listener.heard] == [
        ("planner", ["planner"], "stuck")
    ]


def test_that_a_signal_holds_it_is_told_at_once_and_once() -> None:
    listener, one = Listener(), life()
    one.stopped = 1.0

    for now in (1.0, 1.2, 1.4):
        listener.oversight.assess(one, now, now - 1.0, {"controller": None})

    assert [(news.state, news.stopped) for news in listener.heard] == [
        ("busy", True),
        ("stuck", True),
    ]


def test_one_that_is_held_before_it_works_is_told_of_and_killed_only_in_a_later_life() -> None:
    for died_before in (False, True):
        listener, one = Listener(), life()
        if died_before:
            listener.oversight.after_death(life(), 0.5, failed=True)
        one.active, one.stopped = False, 1.0

        kills = [listener.oversight.assess_start(one, now).kill for now in (1.1, 1.3, 4.2, 4.3)]
        one.stopped = None
        listener.oversight.assess_start(one, 4.4)

        assert [(news.state, news.stopped) for news in listener.heard] == [
            ("stuck", True),
            ("starting", False),
        ]
        assert [bool(kill) for kill in kills] == [False, False, False, died_before]


def test_a_death_is_told_with_the_will_behind_it_and_again_when_it_is_given_up() -> None:
    listener, one = Listener(), life()
    one.killed = "a restart was asked for"

    listener.oversight.bury(one, "the process was killed by SIGKILL")
    assert listener.oversight.after_death(one, 1.0, failed=True).delay == DELAYS[0]
    listener.oversight.bury(again := life(restarts=1), "the process was killed by SIGKILL")
    assert listener.oversight.after_death(again, 2.0, failed=True).delay is None

    assert [(news.state, news.reason) for news in listener.heard] == [
        ("dead", "a restart was asked for"),
        ("dead", "the process was killed by SIGKILL"),
        ("given up", "died 2 times in a row"),
    ]


def test_who_comes_later_hears_the_newest_of_each() -> None:
    listener = Listener()
    listener.oversight.tell(life(), "starting")
    listener.oversight.activate(life())
    listener.oversight.tell(life(name="monitor"), "starting")

    newest = {news.name: news.state for news in listener.oversight.newest}

    assert newest == {"controller": "active", "monitor": "starting"}


def test_what_never_worked_ends_the_stack() -> None:
    never = life()
    never.active = False

    with pytest.raises(StartupError, match="controller could not start"):
        Listener().oversight.after_death(never, 1.0, failed=True)
