"""A whole stack in virtual time, and a client that sees and drives its robot."""

from __future__ import annotations

import os
import runpy
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

from kompass.launch.stack import Stack, stacks_go_to
from kompass.launch.virtual_stack import USUAL, Embedded, VirtualStack
from kompass.rules.schema.table import Table
from kompass.simulation.faults.fault_names import parse_fault
from kompass.simulation.worlds.registry import world
from kompass.simulation.worlds.world import World as Place
from kompass.supervisor.news import ProcessNews
from kompass.virtual.process import World
from tests.support.keys import give_key
from tests.support.stack import RECIPE
from tests.support.tester import Tester
from tests.support.virtual_time import InVirtualTime, node_in

BRINGUP = 20.0  # s in which a stack must be up


class VirtualRobot(InVirtualTime, Tester):
    """Sees and drives the robot of a stack that runs in a world of its own.

    It says nothing of DDS, signals, or the supervisor's own process: ``tests/ros`` does.

    Parameters
    ----------
    recipe
        What runs.
    faults
        That the embedded robot has from the beginning, as after ``--fault``.
    place, start
        The world that it drives in, and where it is at first; where the world has it when left out.
    seed
        Of all that is left to chance.
    table
        The rules in force; the recipe's own when left out.
    embedded
        Which robot it is, and what map it has.
    remembers
        Whether its monitor keeps rules, places and missions.
    environment
        Variables while it runs.

    Attributes
    ----------
    stack
        The fate of its processes: ``kill``, ``stop`` and ``go_on``, by name.
    news
        What the supervisor has told of processes.
    folder
        Where its processes keep their files.
    """

    def __init__(
        self,
        recipe: Path = RECIPE,
        *faults: str,
        place: str = "hexagon",
        start: tuple[float, float, float] | None = None,
        seed: int = 0,
        table: Table | None = None,
        embedded: Embedded = USUAL,
        remembers: bool = False,
        **environment: str,
    ) -> None:
        self._remembers, self._embedded = remembers, embedded
        self._ending = ExitStack()
        try:
            where = world(place) if start is None else replace(world(place), start=start)
            self._start(recipe, faults, where, seed, table, environment)
        except BaseException:
            self.close()
            raise

    def _start(
        self,
        recipe: Path,
        faults: tuple[str, ...],
        place: Place,
        seed: int,
        table: Table | None,
        environment: dict[str, str],
    ) -> None:
        give_key()
        folder = self._ending.enter_context(tempfile.TemporaryDirectory(prefix="kompass-data-"))
        self.folder = Path(folder)
        given = {"KOMPASS_DATA_DIR": folder, "KOMPASS_ROBOT_NAME": "tested"} | environment
        self._ending.enter_context(_environment(given))
        self.world = self._ending.enter_context(World(seed))
        orders = [parse_fault(fault) for fault in faults]
        self.stack = VirtualStack(
            self.world,
            stack_of(recipe),
            place,
            seed=seed,
            table=table,
            orders=orders,
            folder=Path(folder) / "robot" if self._remembers else None,
            embedded=self._embedded,
            remembers=self._remembers,
        )
        self.news: list[ProcessNews] = []
        self.stack.on_news = self.news.append
        super().__init__(node_in(self.world, "independent_tester"))
        self.stack.start()
        self.wait_until(lambda: self.stack.is_up, BRINGUP, "a stack that is up")

    def close(self) -> None:
        """End the world."""
        self._ending.close()

    def logged(self, text: str) -> bool:
        """Whether a node has written a line that holds a text."""
        return any(text in entry.text for entry in self.world.log)

    def wait_for_line(self, text: str, timeout: float) -> None:
        """Wait until a node has written a line that holds a text."""
        self.wait_until(lambda: self.logged(text), timeout, f"'{text}' in the log")


def stack_of(recipe: Path) -> Stack:
    """What a recipe brings up; it is used up by one run."""
    stacks: list[Stack] = []
    kept = sys.argv, list(sys.path)
    sys.argv = [str(recipe)]
    sys.path.insert(0, str(recipe.parent))
    try:
        with stacks_go_to(stacks.append):
            runpy.run_path(str(recipe), run_name="__main__")
    finally:
        sys.argv, sys.path[:] = kept
    (stack,) = stacks
    return stack


@contextmanager
def _environment(given: dict[str, str]) -> Iterator[None]:
    kept = {name: os.environ.get(name) for name in given}
    os.environ.update(given)
    try:
        yield
    finally:
        for name, value in kept.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
