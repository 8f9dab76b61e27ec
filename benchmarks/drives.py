"""Drives of one robot in virtual time, each in a process of its own, one on each core at a time."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Iterator

from kompass.drills.drive import DriveResult
from kompass.drills.runner.pool import in_processes
from kompass.drills.runner.worker import silence, stack_by
from kompass.drills.scenario import Scenario


def driven(scenarios: Iterable[Scenario], robot: str, follower: str) -> Iterator[DriveResult]:
    """Drive scenarios by the recipe of ``bench-nav``; their results, in the same order.

    Parameters
    ----------
    robot
        Name of an embedded one.
    follower
        Of the controller.
    """
    calls = [(robot, follower, scenario) for scenario in scenarios]
    made: dict[int, str] = {}
    following = 0
    for ended in in_processes(_drive, calls, os.cpu_count() or 1):
        made[ended.index] = ended.result
        while following in made:
            yield DriveResult.model_validate_json(made.pop(following))
            following += 1


def _drive(robot: str, follower: str, scenario: Scenario) -> str:
    from kompass.bench.stack import bring_up
    from kompass.drills.runner.run import run_drive
    from kompass.launch.virtual_stack import Embedded
    from kompass.simulation.physics.robot_model import robot_model
    from kompass.virtual.action_clients import action_clients_on_any_node

    kind = robot_model(robot)
    with (
        tempfile.TemporaryDirectory(prefix="kompass-bench-") as folder,
        silence(),
        action_clients_on_any_node(),
    ):
        os.environ["KOMPASS_DATA_DIR"] = folder
        stack = stack_by(lambda: bring_up(kind, follower), "the benchmark's stack")
        found = run_drive(stack, scenario, embedded=Embedded(kind))
    return found.result.model_dump_json()
