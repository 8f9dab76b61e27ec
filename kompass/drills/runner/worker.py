"""Drives in processes of their own, several at a time."""

from __future__ import annotations

import os
import runpy
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING

from kompass.drills.scenario import Scenario
from kompass.rules.schema.table import Table

if TYPE_CHECKING:
    from kompass.launch.stack import Stack

NICENESS = 19  # whatever else runs on the machine goes first
# In every process of a drill: what would make two runs of one seed differ, or one slower.
ENVIRONMENT = {
    "PYTHONHASHSEED": "0",
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "KOMPASS_ROBOT_NAME": "drill",
    "KOMPASS_ROS_CONTROL": "read",
}


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
    """

    recipe: Path
    scenario: Scenario
    table: Table | None = None


class DriveFailed(RuntimeError):
    """A drive could not be made; the message says which, and why."""


def make_drives(orders: Sequence[Order], jobs: int) -> Iterator[tuple[int, str]]:
    """Make drives, each in a process of its own.

    Parameters
    ----------
    orders
        The drives.
    jobs
        How many at a time.

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
    os.environ |= ENVIRONMENT  # taken over by the process that all others are forked from
    context = get_context("forkserver")
    context.set_forkserver_preload(["kompass.drills.runner.preloaded"])
    with ProcessPoolExecutor(jobs, mp_context=context, max_tasks_per_child=1) as pool:
        futures = {pool.submit(_make, order): index for index, order in enumerate(orders)}
        try:
            for future in as_completed(futures):
                index = futures[future]
                try:
                    yield index, future.result()
                except Exception as error:
                    name = orders[index].scenario.name
                    text = f"drive {name}: {type(error).__name__}: {error}"
                    raise DriveFailed(text) from error
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _make(order: Order) -> str:
    """In a process of its own."""
    from kompass.drills.runner.run import run_drive

    os.nice(NICENESS)
    with tempfile.TemporaryDirectory(prefix="kompass-drill-") as folder, _silence():
        os.environ["KOMPASS_DATA_DIR"] = folder
        stack = stack_of(order.recipe)
        return run_drive(stack, order.scenario, order.table).result.model_dump_json()


def stack_of(recipe: Path) -> Stack:
    """What a recipe brings up.

    Raises
    ------
    ValueError
        When it does not do so once.
    """
    from kompass.launch.stack import stacks_go_to

    sys.argv = [str(recipe)]
    sys.path.insert(0, str(recipe.resolve().parent))
    stacks: list[Stack] = []
    with stacks_go_to(stacks.append):
        runpy.run_path(str(recipe), run_name="__main__")
    if len(stacks) != 1:
        raise ValueError(
            f"{recipe.name} calls launcher.bringup() {len(stacks)} times; a drill needs a recipe "
            "that calls it once"
        )
    return stacks[0]


@contextmanager
def _silence() -> Iterator[None]:
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


def look_at(recipe: Path, table: Table | None = None) -> Looked:
    """Read a recipe in a process of its own, and check a table against it.

    Raises
    ------
    DriveFailed
        When it cannot be drilled, or the table is not for it.
    """
    os.environ |= ENVIRONMENT
    context = get_context("forkserver")
    context.set_forkserver_preload(["kompass.drills.runner.preloaded"])
    with ProcessPoolExecutor(1, mp_context=context, max_tasks_per_child=1) as pool:
        try:
            return pool.submit(_look, recipe, table).result()
        except Exception as error:
            raise DriveFailed(f"{recipe.name}: {error}") from error


def _look(recipe: Path, table: Table | None) -> Looked:
    from kompass.drills.runner.operator import planner_node
    from kompass.monitor.tables.recipe_check import check_recipe

    with tempfile.TemporaryDirectory(prefix="kompass-drill-") as folder, _silence():
        os.environ["KOMPASS_DATA_DIR"] = folder
        stack = stack_of(recipe)
    if stack.monitored is None:
        raise ValueError("the recipe runs without a monitor (enable_monitoring); nothing can heal")
    if table is not None:
        check_recipe(table, stack.monitored.catalog)
    own = stack.monitored.rules.table
    return Looked(own.model_dump_json(), planner_node(stack.components))
