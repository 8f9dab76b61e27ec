"""Ways that close while the robot drives them, in virtual time: round it, or why not; contacts.

.venv/bin/python benchmarks/closed_ways.py [DRIVES] [SEED] [FOLLOWER]

In turn a wall is put up 15 cm ahead of the robot at full speed, in a room with a way round it, and
a door closes before it is reached. What closes stays closed.
"""

from __future__ import annotations

import json
import os
import random
import sys
import tempfile
from collections import Counter
from multiprocessing import get_context
from multiprocessing.connection import Connection

from kompass.drills.runner.worker import ENVIRONMENT
from kompass.drills.scenario import Goal, Scenario, ScheduledFault

# A goal in each room of the apartment, and the door that leads there from the hall.
ROOMS = {
    "living": (2.45, 1.9),
    "kitchen": (6.85, 1.9),
    "bedroom": (1.65, 5.3),
    "study": (6.05, 5.3),
}
GOALS = ((1.7, 0.4), (-1.6, 0.6), (0.5, -1.7), (1.5, -1.0))  # in the hexagon
ROBOT = "turtlebot3"
LIMIT = 150.0  # s


def main() -> None:
    given = sys.argv[1:]
    drives = int(given[0]) if given else 20
    seed = int(given[1]) if len(given) > 1 else 1
    follower = given[2] if len(given) > 2 else "MPPI"
    context = get_context("spawn")
    os.environ |= ENVIRONMENT
    ends: Counter[str] = Counter()
    for number in range(seed, seed + drives):
        ours, theirs = context.Pipe()
        process = context.Process(target=drive, args=(number, follower, theirs))
        process.start()
        theirs.close()
        found = json.loads(ours.recv())
        process.join()
        ends[f"{found['closed']} {found['outcome']}"] += 1
        ends["contacts"] += found["contacts"]
        ends["without a reason"] += not (found["outcome"] == "arrived" or found["why"])
        print(
            f"seed {number}: {found['closed']}, {found['outcome']} after {found['took']:.0f} s, "
            f"{found['contacts']} contacts: {found['why']}",
            flush=True,
        )
    told = ", ".join(f"{count} {what}" for what, count in sorted(ends.items()))
    print(f"\n{follower}, {drives} drives: {told}")


def scenario_of(seed: int) -> tuple[Scenario, str]:
    """One drive, and what closes in it."""
    chance = random.Random(seed)
    if seed % 2:
        x, y = chance.choice(GOALS)
        world, fault, closed = "hexagon", "way_blocked", "a wall"
        at = chance.uniform(2.0, 5.0)
    else:
        room, (x, y) = chance.choice(list(ROOMS.items()))
        world, fault, closed = "apartment", f"door_closed:{room}", "a door"
        at = chance.uniform(1.0, 8.0)
    scenario = Scenario(
        name=f"closed-{seed}",
        world=world,
        seed=seed,
        goals=(Goal(x=x, y=y, tolerance=0.1),),
        faults=(ScheduledFault(name=fault, at=at),),
        limit=LIMIT,
    )
    return scenario, closed


def drive(seed: int, follower: str, answer: Connection) -> None:
    """Make one drive, in a process of its own."""
    from kompass.bench.stack import bring_up
    from kompass.drills.runner.run import run_drive
    from kompass.drills.runner.worker import silence, stack_by
    from kompass.launch.virtual_stack import Embedded
    from kompass.simulation.physics.robot_model import robot_model
    from kompass.virtual.action_clients import action_clients_on_any_node

    kind = robot_model(ROBOT)
    scenario, closed = scenario_of(seed)
    with (
        tempfile.TemporaryDirectory(prefix="kompass-bench-") as folder,
        silence(),
        action_clients_on_any_node(),
    ):
        os.environ["KOMPASS_DATA_DIR"] = folder
        stack = stack_by(lambda: bring_up(kind, follower), "the benchmark's stack")
        found = run_drive(stack, scenario, embedded=Embedded(kind)).result
    (goal,) = found.goals
    answer.send(
        json.dumps(
            {
                "closed": closed,
                "contacts": len(found.contacts),
                "outcome": goal.outcome,
                "took": goal.ended or found.duration,
                "why": goal.message,
            }
        )
    )


if __name__ == "__main__":
    main()
