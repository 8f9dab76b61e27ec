"""Drives in processes of their own, several at a time."""

from __future__ import annotations

import os
import random
import runpy
import signal
import sys
import tempfile
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from kompass.algorithms.footprint import Footprint
from kompass.drills.draw import check_targets, expand_faults
from kompass.drills.runner.pool import ProcessEnded, in_processes
from kompass.drills.runner.repeated import difference
from kompass.drills.scenario import Scenario
from kompass.printable import printable
from kompass.rules.schema.table import Table
from kompass.simulation.physics.robot_model import SENSORS, robot_like, robot_model

if TYPE_CHECKING:
    from kompass.launch.stack import Stack
    from kompass.robot import RobotConfig

_ALIKE = 0.03  # m by which bodies may differ
NICENESS = 19  # whatever else runs on the machine goes first


@dataclass(frozen=True)
class Order:
    """One drive to be made.

    Attributes
    ----------
    recipe
        File of the recipe.
    scenario
        What is to happen.
    table
        The rules in force; None for those of the recipe.
    recording
        File to write the drive to, which must not exist; None for none.
    """

    recipe: Path
    scenario: Scenario
    table: Table | None = None
    recording: Path | None = None


class DriveFailed(RuntimeError):
    """A drive could not be made; the message says which, and why."""


class _Made(NamedTuple):
    """A drive, as it comes out of its process.

    Attributes
    ----------
    result
        As JSON.
    facts
        Each as text; none where they were not asked for.
    """

    result: str
    facts: tuple[str, ...] = ()


def make_drives(
    orders: Sequence[Order], jobs: int, differs: Callable[[str], object] | None = None
) -> Generator[tuple[int, str], None, None]:
    """Make drives, each in a process of its own.

    Parameters
    ----------
    orders
        The drives.
    jobs
        How many at a time.
    differs
        When given, the first drive is made twice, and this is told once both are there: a sentence
        if the second is not the same, for then there is something in the recipe that no seed
        decides; nothing ("") if it is.

    Yields
    ------
    index : int
        Of the order.
    result : str
        The :class:`kompass.drills.drive.DriveResult` as JSON. In the order in which they end.

    Raises
    ------
    DriveFailed
        When one cannot be made; the others are not waited for.
    """
    twice = differs is not None and bool(orders)
    calls = [(order, twice and not index) for index, order in enumerate(orders)]
    places: list[int | None] = list(range(len(orders)))  # of the calls among the orders
    if twice:
        # Soon, so that a drill that is ended early has looked at it, too.
        calls.insert(1, (replace(orders[0], recording=None), True))
        places.insert(1, None)
    first: list[_Made] = []
    with closing(in_processes(_make, calls, jobs)) as drives:
        for ended in drives:
            order, facts = calls[ended.index]
            try:
                made = ended.result
            except (Exception, SystemExit) as error:
                raise DriveFailed(f"drive {order.scenario.name}: {_why(error)}") from error
            if facts:
                first.append(made)
                if len(first) == 2 and differs is not None:
                    said = difference(order.scenario.name, first[0].facts, first[1].facts)
                    differs(said)
            place = places[ended.index]
            if place is not None:
                yield place, made.result


def _why(error: BaseException) -> str:
    """What came out of a process of ours, for people: it may say anything."""
    if isinstance(error, SystemExit):
        # Not ours to pass on: a drill that ends with the recipe's 0 counts as passed.
        return f"the recipe, or a function of it, calls sys.exit({error.code!r}); leave that out"
    if isinstance(error, ProcessEnded):
        return f"its process {_ended(error.code)}"
    text = printable(str(error))
    return text if isinstance(error, ValueError) else f"{type(error).__name__}: {text}"


def _ended(code: int | None) -> str:
    """With what, and where to look."""
    if code is None:
        return "ended; look whether memory ran out, and whether the recipe ends it (os._exit)"
    if code >= 0:
        return f"ended with code {code}; look whether the recipe ends it (os._exit)"
    if -code == signal.SIGKILL:
        return "was killed (SIGKILL); look whether memory ran out (kernel's log), or who did it"
    if -code in (signal.SIGSEGV, signal.SIGBUS, signal.SIGABRT, signal.SIGFPE, signal.SIGILL):
        return (
            f"ended by {signal.Signals(-code).name}, an error in compiled code; set "
            "PYTHONFAULTHANDLER=1 to see which line of the recipe, or of a function, calls it"
        )
    return f"was ended by {_name(-code)}; look who sent it"


def _name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _make(order: Order, facts: bool) -> _Made:
    """In a process of its own."""
    from kompass.drills.runner.run import run_drive
    from kompass.virtual.action_clients import action_clients_on_any_node

    os.nice(NICENESS)
    # Chance that a recipe asks for without a seed of its own.
    random.seed(order.scenario.seed)
    np.random.seed(order.scenario.seed % 2**32)  # noqa: NPY002 - what a recipe may use
    with (
        tempfile.TemporaryDirectory(prefix="kompass-drill-") as folder,
        silence(),
        action_clients_on_any_node(),
    ):
        os.environ["KOMPASS_DATA_DIR"] = folder
        stack = stack_of(order.recipe)
        made = run_drive(stack, order.scenario, order.table, order.recording)
    return _Made(made.result.model_dump_json(), tuple(map(repr, made.facts)) if facts else ())


def stack_of(recipe: Path) -> Stack:
    """What a recipe brings up.

    Raises
    ------
    ValueError
        When it does not do so once.
    """
    sys.argv = [str(recipe)]
    sys.path.insert(0, str(recipe.resolve().parent))
    return stack_by(lambda: runpy.run_path(str(recipe), run_name="__main__"), recipe.name)


def stack_by(run: Callable[[], object], name: str) -> Stack:
    """What is brought up by calling ``run``, which is called ``name``.

    Raises
    ------
    ValueError
        When it does not do so once.
    """
    from kompass.launch.stack import stacks_go_to
    from kompass.virtual.waiting import in_virtual_time

    stacks: list[Stack] = []
    # What it imports of the module time goes by virtual time where its functions wait.
    with stacks_go_to(stacks.append), in_virtual_time():
        try:
            run()
        except SystemExit:
            if not stacks:  # with one it is the end of a script, as in sys.exit(main())
                raise
    if len(stacks) != 1:
        raise ValueError(
            f"{name} calls launcher.bringup() {len(stacks)} times; a drill needs a recipe "
            "that calls it once"
        )
    return stacks[0]


@contextmanager
def silence() -> Iterator[None]:
    """What a recipe prints is no part of a drill's output."""
    kept = sys.stdout
    with Path(os.devnull).open("w") as nowhere:
        sys.stdout = nowhere
        try:
            yield
        finally:
            sys.stdout = kept


@dataclass(frozen=True)
class Looked:
    """What there is to know of a recipe before it drives."""

    table: str  # of the recipe, as JSON
    planner: str
    nodes: tuple[str, ...]  # of its components
    targets: tuple[str, ...]  # processes and nodes that something can happen to
    model_type: str  # of the robot that the recipe describes; empty where it describes none
    half_width: float  # m from the middle of its body to its nearest side
    radius: float  # m, of the circle around it
    heard: tuple[str, ...]  # topics that components listen to

    @property
    def robot(self) -> str:
        """The embedded one that moves as the recipe describes its own, and sees what it hears."""
        return robot_like(self.model_type, self.heard).name

    def unlike(self, robots: Iterable[str]) -> list[str]:
        """What embedded robots have not in common with the one that is described, in sentences."""
        said = []
        for model in map(robot_model, sorted(set(robots))):
            if missing := sorted((SENSORS & set(self.heard)) - model.sensors):
                said.append(
                    f"The recipe listens to {' and '.join(missing)}, which {model.name} does not "
                    "have: what waits for it is never well."
                )
            if self.model_type and model.model_type != self.model_type:
                said.append(
                    f"The recipe describes a robot that moves as {self.model_type}, and "
                    f"{model.name} moves as {model.model_type}: it cannot carry out what it is "
                    "told, and these drives tell little."
                )
            elif self.radius and model.radius > self.radius + _ALIKE:
                said.append(
                    f"{model.name} reaches {model.radius:.2f} m from its middle, and the recipe "
                    f"describes {self.radius:.2f} m: it touches what the recipe takes to be far "
                    "enough away."
                )
        return said

    def faults(self, names: Iterable[str], robot: str) -> tuple[str, ...]:
        """Names of faults as after ``--faults``, written out for this recipe and an embedded robot.

        Raises
        ------
        UnknownFault
            There is no such fault, or nobody of that name that it could strike.
        """
        found = expand_faults(names, self.nodes, robot)
        check_targets(found, self.targets)
        return found


def look_at(recipe: Path, table: Table | None = None) -> Looked:
    """Read a recipe in a process of its own, and check a table against it.

    Raises
    ------
    DriveFailed
        When it cannot be drilled, or the table is not for it.
    """
    with closing(in_processes(_look, [(recipe, table)], 1)) as looking:
        try:
            return next(looking).result
        except (Exception, SystemExit) as error:
            raise DriveFailed(f"{recipe.name}: {_why(error)}") from error


def _half_width(robot: RobotConfig | None) -> float:
    if robot is None:
        return 0.0
    body = Footprint(robot.footprint - (robot.geometry_offset, 0.0))
    return round(body.radius if body.is_round else body.inscribed_radius, 3)


def _look(recipe: Path, table: Table | None) -> Looked:
    from kompass.drills.runner.operator import planner_node
    from kompass.launch.virtual_stack import process_names
    from kompass.monitor.tables.recipe_check import check_recipe

    with tempfile.TemporaryDirectory(prefix="kompass-drill-") as folder, silence():
        os.environ["KOMPASS_DATA_DIR"] = folder
        stack = stack_of(recipe)
    if stack.monitored is None:
        raise ValueError("the recipe runs without a monitor (enable_monitoring); nothing can heal")
    if table is not None:
        check_recipe(table, stack.monitored.catalog)
    own = stack.monitored.rules.table
    nodes = tuple(component.node_name for component in stack.components)
    robot = stack.robot
    return Looked(
        table=own.model_dump_json(),
        planner=planner_node(stack.components),
        nodes=nodes,
        targets=process_names(stack),
        model_type=stack.model_type,
        half_width=_half_width(stack.robot),
        radius=0.0 if robot is None else round(robot.radius, 3),
        heard=tuple(sorted(stack.heard)),
    )
