"""A drill as a program of its own: told on its input what to try, tells on its output how it goes.

``python -m kompass.drills.runner.program`` reads one :class:`DrillOrder` as JSON and writes one
:class:`DrillLine` per line. Nothing else is written there, whatever the recipe prints. It has the
lowest priority of the machine, and does not outlive who started it, however that one ends.
"""

from __future__ import annotations

import ctypes
import os
import platform
import resource
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, TypeAdapter

from kompass.drills.draw import DrawOptions, check_targets, draw, repeated
from kompass.drills.drive import DriveResult
from kompass.drills.report_json import Report, TableName, make_report
from kompass.drills.runner.lifeline import end_with
from kompass.drills.runner.worker import DriveFailed, Looked, Order, look_at, make_drives
from kompass.drills.scenario import USUAL_ROBOT, Scenario
from kompass.rules.schema.model import Model
from kompass.rules.schema.table import Table

LOWEST = 19  # of nice
# ioprio_set(2) has no name in libc; class 3 is idle: it reads and writes when nobody else does.
_IOPRIO_SET = {"x86_64": 251, "aarch64": 30}
_THIS_PROCESS, _IDLE = 1, 3 << 13


class DrillOrder(Model):
    """What to try.

    Attributes
    ----------
    recipe
        Path of its file.
    proposed, in_force
        The tables, by name.
    scenario
        What is driven again and again, with other noise each time; None for drawn ones.
    worlds, faults
        To draw from; faults as after ``--faults``.
    robot
        Which embedded one drives what is drawn.
    faults_per_drive
        How many break in each.
    lasting
        Share of the drawn faults that never end.
    drives
        Under each table.
    jobs
        Drives at a time.
    memory
        Bytes of address space that one process may take.
    starter
        Process id of who started it, with whom it ends.
    """

    recipe: str
    proposed: Table
    proposed_name: str
    in_force: Table
    in_force_name: str
    scenario: Scenario | None = None
    worlds: tuple[str, ...] = ()
    robot: str = USUAL_ROBOT
    faults: tuple[str, ...] = ()
    faults_per_drive: Annotated[int, Field(ge=1)] = 1
    lasting: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    seed: Annotated[int, Field(ge=0)]
    drives: Annotated[int, Field(ge=1)]
    jobs: Annotated[int, Field(ge=1)]
    memory: Annotated[int, Field(gt=0)]
    starter: int


class Progress(Model):
    """So many drives, of both tables together, are over."""

    kind: Literal["progress"] = "progress"
    done: int
    total: int


class Failed(Model):
    """There will be no report, for this reason."""

    kind: Literal["failed"] = "failed"
    text: str


class Finished(Model):
    """The report."""

    kind: Literal["finished"] = "finished"
    report: Report


DrillLine: TypeAlias = Annotated[Progress | Failed | Finished, Field(discriminator="kind")]
DRILL_LINE: TypeAdapter[Progress | Failed | Finished] = TypeAdapter(DrillLine)


def main() -> None:
    """Read the order, make the drives, and write what came of them."""
    order = DrillOrder.model_validate_json(sys.stdin.buffer.read())
    end_with(order.starter)
    # Lines go where output went; what a recipe or a library prints goes where errors go.
    lines = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    _give_way()
    resource.setrlimit(resource.RLIMIT_AS, (order.memory, order.memory))

    def tell(line: Progress | Failed | Finished) -> None:
        lines.write(line.model_dump_json(by_alias=True) + "\n")
        lines.flush()

    try:
        tell(Finished(report=drill(order, lambda done, total: tell(_progress(done, total)))))
    except (DriveFailed, ValueError) as error:
        tell(Failed(text=str(error)))


def drill(order: DrillOrder, progress: Callable[[int, int], None]) -> Report:
    """Make the drives of an order under both tables, and compare them.

    Parameters
    ----------
    progress
        Told of how many drives are over, of how many.

    Raises
    ------
    DriveFailed
        When the recipe cannot be drilled, a table is not for it, or a drive cannot be made.
    ValueError
        When there is no such world or fault, or nothing can be drawn.
    """
    recipe = Path(order.recipe)
    looked = look_at(recipe, order.proposed)
    look_at(recipe, order.in_force)
    scenarios, options = _scenarios(order, looked)
    # Both tables of a scenario one after the other, so that both are as far at any time.
    tables = (order.proposed, order.in_force)
    orders = [Order(recipe, scenario, table) for scenario in scenarios for table in tables]
    made: dict[int, DriveResult] = {}
    progress(0, len(orders))
    for index, text in make_drives(orders, order.jobs):
        made[index] = DriveResult.model_validate_json(text)
        progress(len(made), len(orders))
    return make_report(
        recipe=recipe.name,
        table=TableName.of(order.proposed_name, order.proposed),
        drives=[made[index] for index in range(0, len(orders), 2)],
        against=TableName.of(order.in_force_name, order.in_force),
        drives_against=[made[index] for index in range(1, len(orders), 2)],
        seed=order.seed,
        options=options,
        notes=looked.unlike(scenario.robot for scenario in scenarios),
        names={rule.id: rule.name for table in tables[::-1] for rule in table.rules},
    )


def _scenarios(order: DrillOrder, looked: Looked) -> tuple[Sequence[Scenario], DrawOptions | None]:
    """What is driven, and what it was drawn from."""
    if order.scenario is not None:
        check_targets([fault.name for fault in order.scenario.faults], looked.targets)
        return repeated(order.scenario, order.seed, order.drives), None
    options = DrawOptions(
        worlds=order.worlds,
        robot=order.robot,
        faults=looked.faults(order.faults, order.robot),
        half_width=looked.half_width,
        radius=looked.radius,
        faults_per_drive=order.faults_per_drive,
        lasting=order.lasting,
    )
    return [draw(order.seed, number, options) for number in range(order.drives)], options


def _progress(done: int, total: int) -> Progress:
    return Progress(done=done, total=total)


def _give_way() -> None:
    """Whatever else runs on the machine computes, reads and writes first: it may be a robot."""
    os.nice(LOWEST)
    # Niceness alone lets whoever wakes up wait for the end of a slice; this class never does.
    # The kernel compares so within a session only (sched(7), autogroup), and so it is the robot's.
    os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
    # Where memory runs out it is the drill that goes, and no process of the robot.
    Path("/proc/self/oom_score_adj").write_text("1000", encoding="ascii")
    number = _IOPRIO_SET.get(platform.machine())
    # Elsewhere the kernel gives what is as nice as this the least of the usual class.
    if number is not None:
        ctypes.CDLL(None).syscall(number, _THIS_PROCESS, 0, _IDLE)


if __name__ == "__main__":
    main()
