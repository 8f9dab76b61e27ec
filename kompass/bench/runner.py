"""Makes the drives of a benchmark in virtual time, in processes of their own."""

from __future__ import annotations

import os
import random
import tempfile
from collections.abc import Generator, Sequence
from contextlib import closing
from pathlib import Path

import numpy as np

from kompass.bench.barn_file import BarnWorld
from kompass.bench.drive import BenchDrive, BenchOutcome, MapKnown
from kompass.bench.score import arrival, least_gap, score, time_limit
from kompass.bench.stack import bring_up, described
from kompass.drills.facts import Motion
from kompass.drills.runner.pool import in_processes
from kompass.drills.runner.run import Observed, run_drive
from kompass.drills.runner.worker import NICENESS, DriveFailed, silence, stack_by
from kompass.drills.scenario import LONGEST, Goal, Scenario
from kompass.launch.virtual_stack import Embedded
from kompass.rules.schema.model import Model
from kompass.simulation.physics.robot_model import robot_model
from kompass.simulation.worlds.rasterize import rasterize
from kompass.simulation.worlds.registry import add_world

GOAL_TOLERANCE = 0.1  # m
RESOLUTION = 0.05  # m, of the map that is given


class BenchOrder(Model):
    """One drive to be made.

    Attributes
    ----------
    world
        Through which.
    start, goal
        (x, y, yaw) and (x, y) [m], [rad].
    robot
        Name of an embedded one.
    follower
        Algorithm of the controller.
    map
        What the stack is given: floor, walls and obstacles; floor and outer wall; nothing.
    seed
        Of all chance in it.
    """

    world: BarnWorld
    start: tuple[float, float, float]
    goal: tuple[float, float]
    robot: str
    follower: str
    map: MapKnown
    seed: int


def make_bench_drives(
    orders: Sequence[BenchOrder], jobs: int
) -> Generator[tuple[int, BenchDrive], None, None]:
    """Make drives, ``jobs`` at a time.

    Yields
    ------
    index : int
        Of the order.
    drive : BenchDrive
        In the order in which they end.

    Raises
    ------
    DriveFailed
        When one cannot be made; the others are not waited for.
    """
    with closing(in_processes(_make, [(order,) for order in orders], jobs)) as drives:
        for ended in drives:
            try:
                made = ended.result
            except Exception as error:
                order = orders[ended.index]
                raise DriveFailed(
                    f"drive through {order.world.name} with seed {order.seed}: "
                    f"{type(error).__name__}: {error}"
                ) from error
            yield ended.index, BenchDrive.model_validate_json(made)


def _make(order: BenchOrder) -> str:
    """In a process of its own."""
    from kompass.virtual.action_clients import action_clients_on_any_node

    os.nice(NICENESS)
    random.seed(order.seed)
    np.random.seed(order.seed % 2**32)  # noqa: NPY002 - what a component may use
    with (
        tempfile.TemporaryDirectory(prefix="kompass-bench-") as folder,
        silence(),
        action_clients_on_any_node(),
    ):
        os.environ["KOMPASS_DATA_DIR"] = folder
        made = drive(order, Path(folder))
    return made.model_dump_json()


def drive(order: BenchOrder, folder: Path) -> BenchDrive:
    """Make one drive, in this process; ``folder`` is for what it needs meanwhile."""
    robot = robot_model(order.robot)
    add_world(order.world.place(order.start, order.goal))
    stack = stack_by(lambda: bring_up(robot, order.follower), "the benchmark's stack")
    embedded = Embedded(map_file=map_file(order, folder), has_map=order.map != "none")
    observed = run_drive(stack, scenario_of(order), embedded=embedded)
    return measured(order, observed)


def map_file(order: BenchOrder, folder: Path) -> Path | None:
    """Write the map that the stack is given; None for none."""
    from kompass.algorithms.map_file import save_map

    if order.map == "none":
        return None
    known = order.world.place(order.start, order.goal, obstacles=order.map == "known")
    file = folder / "map.yaml"
    save_map(rasterize(known, RESOLUTION), file)
    return file


def scenario_of(order: BenchOrder) -> Scenario:
    """The drive as it is to be; its world must be known by its name."""
    x, y = order.goal
    top = described(robot_model(order.robot)).ctrl_vx_limits.max_vel
    return Scenario(
        name=f"{order.world.name}-{order.seed}",
        world=order.world.name,
        robot=order.robot,
        seed=order.seed,
        goals=(Goal(x=x, y=y, tolerance=GOAL_TOLERANCE),),
        limit=min(time_limit(top), LONGEST),
    )


def measured(order: BenchOrder, observed: Observed) -> BenchDrive:
    """What a drive was worth."""
    robot, result = robot_model(order.robot), observed.result
    top = described(robot).ctrl_vx_limits.max_vel
    motion = [fact for fact in observed.facts if isinstance(fact, Motion)]
    times = [fact.at for fact in motion]
    poses = np.array([(fact.x, fact.y, fact.yaw) for fact in motion])
    time = arrival(times, poses, order.goal)
    outcome: BenchOutcome
    if result.contacts:
        outcome = "contact"
    elif time is not None and time <= time_limit(top):
        outcome = "arrived"
    elif result.goals and result.goals[0].ended is not None:
        outcome = "gave_up"
    else:
        outcome = "too_late"
    gap, gap_at = least_gap(robot, poses, np.array(order.world.cylinders))
    worth = score(order.world.optimal_length, top, time if outcome == "arrived" else None)
    ways = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    return BenchDrive(
        world=order.world.name,
        seed=order.seed,
        robot=order.robot,
        follower=order.follower,
        map=order.map,
        outcome=outcome,
        reason=result.why,
        time=None if time is None else round(time, 2),
        score=round(worth, 4),
        contacts=len(result.contacts),
        clearance=round(gap, 3),
        clearance_at=(round(gap_at[0], 3), round(gap_at[1], 3)),
        end_distance=round(float(np.hypot(*(poses[-1, :2] - order.goal))), 3),
        driven=round(float(ways[ways > 1e-3].sum()), 2),
        duration=result.duration,
        contact_places=tuple(
            (each.x, each.y)
            for each in result.contacts
            if each.x is not None and each.y is not None
        ),
        track=result.track,
    )
