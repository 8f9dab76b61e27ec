"""People who cross the robot's way, in virtual time: contacts, arrivals, and how long it took.

.venv/bin/python benchmarks/people_crossing.py [DRIVES] [SEED] [FOLLOWER] [ROBOT]

Each drive has three goals in the hexagon and somebody crossing the way ahead every four seconds.
Nobody walks into the robot: whoever comes too near to it waits, so a contact is the robot's doing.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from multiprocessing import get_context
from multiprocessing.connection import Connection

from kompass.drills.runner.worker import ENVIRONMENT
from kompass.drills.scenario import Goal, Scenario, ScheduledFault

GOALS = ((1.7, 0.4), (-1.6, 0.6), (0.5, -1.7))
EVERY, UNTIL = 4.0, 60.0  # s
LIMIT = 150.0  # s


def main() -> None:
    given = sys.argv[1:]
    drives = int(given[0]) if given else 20
    seed = int(given[1]) if len(given) > 1 else 1
    follower = given[2] if len(given) > 2 else "MPPI"
    robot = given[3] if len(given) > 3 else "turtlebot3"
    context = get_context("spawn")
    os.environ |= ENVIRONMENT
    encounters = contacts = arrived = goals = 0
    for number in range(seed, seed + drives):
        ours, theirs = context.Pipe()
        process = context.Process(target=drive, args=(number, follower, robot, theirs))
        process.start()
        theirs.close()
        found = json.loads(ours.recv())
        process.join()
        encounters += found["met"]
        contacts += found["contacts"]
        arrived += found["arrived"]
        goals += len(GOALS)
        print(
            f"seed {number}: {found['met']} people, {found['contacts']} contacts, "
            f"{found['arrived']} of {len(GOALS)} goals in {found['took']:.0f} s: {found['why']}",
            flush=True,
        )
    print(
        f"\n{robot}, {follower}: {encounters} people crossed; {contacts} contacts; "
        f"{arrived} of {goals} goals reached"
    )


def drive(seed: int, follower: str, robot: str, answer: Connection) -> None:
    """Make one drive, in a process of its own."""
    from kompass.bench.stack import bring_up
    from kompass.drills.runner.run import run_drive
    from kompass.drills.runner.worker import silence, stack_by
    from kompass.launch.virtual_stack import Embedded
    from kompass.simulation.physics.robot_model import robot_model
    from kompass.virtual.action_clients import action_clients_on_any_node

    kind = robot_model(robot)
    crossing = tuple(
        ScheduledFault(name="person_crossing", at=3.0 + EVERY * index, duration=EVERY - 0.1)
        for index in range(int(UNTIL / EVERY))
    )
    scenario = Scenario(
        name=f"people-{seed}",
        world="hexagon",
        seed=seed,
        goals=tuple(Goal(x=x, y=y, tolerance=0.1) for x, y in GOALS),
        faults=crossing,
        limit=LIMIT,
    )
    with (
        tempfile.TemporaryDirectory(prefix="kompass-bench-") as folder,
        silence(),
        action_clients_on_any_node(),
    ):
        os.environ["KOMPASS_DATA_DIR"] = folder
        stack = stack_by(lambda: bring_up(kind, follower), "the benchmark's stack")
        found = run_drive(stack, scenario, embedded=Embedded(kind)).result
    answer.send(
        json.dumps(
            {
                "met": len(found.faults),
                "contacts": len(found.contacts),
                "arrived": sum(goal.outcome == "arrived" for goal in found.goals),
                "took": max((goal.ended or found.duration for goal in found.goals), default=0.0),
                "why": found.why,
            }
        )
    )


if __name__ == "__main__":
    main()
