"""From the cut of a hand at the wheel to the zero twist that the robot is told.

The embedded robot of recipe 01 turns on the spot, driven by hand through the console. In turn the
page falls silent with its connection open, the console is held by SIGSTOP, and killed by SIGKILL,
and the cable between page and console is pulled out (which takes root, and network namespaces).
Counted is from the last word of the page, from the signal, or from the cable, to the first zero
twist on /cmd_vel. Aim: 100 of 100 within 250 ms.

.venv/bin/python benchmarks/hand_cut.py [ROUNDS OF PAGE] [OF SIGSTOP] [OF SIGKILL] [OF CABLE]
"""

from __future__ import annotations

import contextlib
import os
import random
import signal
import statistics
import sys
import time
from pathlib import Path
from typing import NamedTuple, TypeAlias

sys.path.insert(0, str(Path(__file__).parents[1]))
from geometry_msgs.msg import Twist

from tests.support.hand_page import HandPage
from tests.support.hosts import Host, two_hosts
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import Stack

PROMISED = 250.0  # ms
ROUNDS = (40, 20, 20, 20)
IN_A_ROW = 3  # deaths of one stack's console


class Cable(NamedTuple):
    """Between the robot's host and the page's."""

    near: Host
    far: Host


# What cuts the hand off: its own silence, a signal to the console, or the cable.
Kind: TypeAlias = signal.Signals | Cable | None


class Listener(Robot):
    """Notes when the robot is told what."""

    def __init__(self, domain: int) -> None:
        super().__init__(domain)
        self.told: list[tuple[float, Twist]] = []
        self.node.create_subscription(
            Twist, "/cmd_vel", lambda twist: self.told.append((time.monotonic(), twist)), 50
        )

    @property
    def is_free(self) -> bool:
        """Whether nobody has the wheel."""
        state = self.newest.get("/drive_state")
        return state is not None and not state.driven_by

    @property
    def turns(self) -> bool:
        """Whether the newest command is a turn."""
        return bool(self.told) and self.told[-1][1].angular.z > 0.5

    def zero_after(self, moment: float) -> float:
        """When the first zero twist came after a moment [ms]."""
        found: list[float] = []

        def told() -> bool:
            found[:] = [at for at, twist in list(self.told) if at >= moment and twist == Twist()]
            return bool(found)

        wait_until(told, 10, "a zero twist")
        return 1000 * (found[0] - moment)


def cut(stack: Stack, robot: Listener, kind: Kind, pause: float) -> float:
    """One hand at the wheel, cut off; ms to the zero twist."""
    wait_until(lambda: robot.is_free, 20, "a free wheel")
    console = stack.pid_of("console")
    with contextlib.ExitStack() as held:
        with kind.far.inside() if isinstance(kind, Cable) else contextlib.nullcontext():
            page = HandPage(stack.url)
        held.enter_context(page)
        page.take()
        page.hold(omega=0.8)
        wait_until(lambda: robot.turns, 10, "motion")
        time.sleep(pause)
        robot.told.clear()
        moment = time.monotonic()
        if kind is None:
            page.fall_silent()
            moment = page.last
        elif isinstance(kind, Cable):
            kind.far.plug(False)
            held.callback(kind.far.plug, True)
        else:
            os.kill(console, kind)
        taken = robot.zero_after(moment)
        page.fall_silent()
        if kind is signal.SIGSTOP:
            os.kill(console, signal.SIGCONT)
    if kind is signal.SIGKILL:
        wait_until(lambda: stack.pid_of("console") != console, 20, "another console")
    return taken


def cuts(kind: Kind, count: int, chance: random.Random) -> list[float]:
    """So many cuts of a kind [ms]; on a new stack now and then, for who dies often is given up."""
    taken: list[float] = []
    options = ("--host", kind.near.address) if isinstance(kind, Cable) else ()
    while len(taken) < count:
        stack = Stack.simulated(*options)
        robot = Listener(stack.domain)
        try:
            robot.ready()
            in_a_row = IN_A_ROW if kind is signal.SIGKILL else count
            taken += [
                cut(stack, robot, kind, chance.uniform(0.2, 0.5))
                for _ in range(min(in_a_row, count - len(taken)))
            ]
        finally:
            robot.close()
            stack.close()
    return taken


def main() -> None:
    rounds = [int(each) for each in sys.argv[1:]] or ROUNDS
    chance = random.Random(1)
    every: list[float] = []
    print("| cut | times | median | worst | within 250 ms |\n|---|---|---|---|---|")

    def tell(name: str, kind: Kind, count: int) -> None:
        taken = cuts(kind, count, chance)
        every.extend(taken)
        kept = sum(each <= PROMISED for each in taken)
        middle, worst = statistics.median(taken), max(taken)
        print(f"| {name} | {count} | {middle:.0f} ms | {worst:.0f} ms | {kept} |", flush=True)

    kinds = (("page", None), ("SIGSTOP", signal.SIGSTOP), ("SIGKILL", signal.SIGKILL))
    for (name, kind), count in zip(kinds, rounds, strict=False):
        if count:
            tell(name, kind, count)
    if len(rounds) > len(kinds) and rounds[-1]:
        with two_hosts() as (near, far), near.inside():
            tell("cable", Cable(near, far), rounds[-1])
    print(f"\n{sum(each <= PROMISED for each in every)} of {len(every)} within {PROMISED:.0f} ms")


if __name__ == "__main__":
    main()
