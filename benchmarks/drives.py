"""Drives of one robot in virtual time, each in a process of its own."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Iterator
from multiprocessing import get_context
from multiprocessing.connection import Connection

from kompass.drills.drive import DriveResult
from kompass.drills.runner.worker import ENVIRONMENT
from kompass.drills.scenario import Scenario


def driven(scenarios: Iterable[Scenario], robot: str, follower: str) -> Iterator[DriveResult]:
    """Drive scenarios one after the other, by the recipe of ``bench-nav``.

    Parameters
    ----------
    robot
        Name of an embedded one.
    follower
        Of the controller.
    """
    context = get_context("spawn")
    os.environ |= ENVIRONMENT
    for scenario in scenarios:
        ours, theirs = context.Pipe()
        process = context.Process(
            target=_drive, args=(scenario.model_dump_json(), robot, follower, theirs)
        )
        process.start()
        theirs.close()
        found = DriveResult.model_validate_json(ours.recv())
        process.join()
        yield found


def _drive(scenario: str, robot: str, follower: str, answer: Connection) -> None:
    from kompass.bench.stack import bring_up
    from kompass.drills.runner.run import run_drive
    from kompass.drills.runner.worker import silence, stack_by
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
        found = run_drive(stack, Scenario.model_validate_json(scenario), embedded=Embedded(kind))
    answer.send(found.result.model_dump_json())
